#!/usr/bin/env python3
"""Lets single calls of the program into the C library fail, one run a call, and looks at what is left.

    inject_faults.py PROGRAM SHIM [--long] [--commands NAME...] [--kinds KIND...] [--device cuda]

Counts the calls of a run first. Then the n-th fails alone, and from the n-th on all fail; reads and writes are cut short
as well. --long takes every n, but of a command that takes long some hundreds. Of allocations, of which each run makes
tens of thousands, these are all of one command that does little more than read its arguments, and of every other command
all that it makes beyond so many. Exit 1, and a line per finding. With --device cuda, which exits 77 where no GPU answers,
the calls are those into its driver.
"""
import argparse
import collections
import shlex
import sys
import tempfile

import runs

FEW = {"once": 14, "from": 8}  # calls chosen of each command and kind where not all are taken
FEW_OF_SLOW = {"once": 4, "from": 2}
MANY_FROM = 200
MOST_OF_SLOW = 500  # of each kind
ARGUMENTS_ONLY = "formats"
SKIPPED = 77


def chosen_calls(count, mode, everything, first, few, most):
    """@param first  calls before it are tried with another command; @param most  evenly spread, where everything is asked for"""
    if not everything:
        return runs.spread(count, few[mode])
    if mode == "from":
        return runs.spread(count, MANY_FROM)
    after = runs.spread(count + 1 - first, most) if count >= first else []
    return sorted({*runs.spread(min(first, count), FEW[mode]), *(first - 1 + call for call in after)})


def faults_of(counts, kinds, everything, first_allocation, few, most):
    for kind in kinds:
        first = first_allocation if kind == "alloc" else 1
        calls = [(mode, call) for mode in FEW for call in chosen_calls(counts[kind], mode, everything, first, few, most)]
        if kind in ("read", "write") and counts[kind] > 0:
            calls.append(("short", 1))
        for mode, call in calls:
            yield {"FAULT_KIND": kind, "FAULT_AT": str(call), "FAULT_MODE": mode}


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("shim")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--commands", nargs="*")
    parser.add_argument("--kinds", nargs="*", choices=runs.ALL_KINDS)
    parser.add_argument("--device")
    args = parser.parse_args()
    commands = runs.chosen(args.commands)
    if args.device:
        commands = runs.on_device(commands, args.device)
    kinds = args.kinds or (runs.DRIVER_KINDS if args.device else runs.KINDS)
    findings = injected = 0
    with tempfile.TemporaryDirectory(prefix="pointskin-faults-") as root:
        bench = runs.Bench(args.program, args.shim, root)
        if args.device and bench.run(commands[next(iter(commands))]).code == runs.NO_DEVICE:
            print(f"no device {args.device} answers")
            return SKIPPED
        of_arguments = bench.run(runs.COMMANDS[ARGUMENTS_ONLY]).counts["alloc"]
        for name, one in commands.items():
            good = bench.run(one)
            problems = bench.judge(one, good, good)
            if good.code != 0 or problems:
                raise SystemExit(f"{name}: without a fault: exit code {good.code}: {good.err} {problems}")
            first = 1 if name == ARGUMENTS_ONLY else of_arguments
            few, most = (FEW_OF_SLOW, MOST_OF_SLOW) if one.slow else (FEW, sys.maxsize)
            faults = list(faults_of(good.counts, kinds, args.long, first, few, most))
            results = runs.in_parallel(faults, lambda fault: bench.run(one, fault))
            codes, wrongs = collections.Counter(), collections.defaultdict(list)
            for fault, result in zip(faults, results):
                injected += result.failed > 0
                codes[result.code] += 1
                for wrong in bench.judge(one, result, good):
                    variables = " ".join(f"{key}={value}" for key, value in fault.items())
                    wrongs[wrong].append(f"{variables} {shlex.join(one.words)}")
            told = " ".join(f"{kind}:{good.counts[kind]}" for kind in kinds)
            ends = ", ".join(f"{code}: {number}" for code, number in sorted(codes.items(), key=str))
            print(f"{name}: {len(faults)} runs with a fault; calls {told}; exit codes {ends}; {len(wrongs)} findings", flush=True)
            for wrong, examples in wrongs.items():
                print(f"WRONG ({len(examples)} times) {name}: {wrong}\n    first: {examples[0]}\n    last: {examples[-1]}", flush=True)
            findings += len(wrongs)
    print(f"{injected} faults injected, {findings} findings")
    return 1 if findings or injected == 0 else 0


if __name__ == "__main__":
    sys.exit(main())
