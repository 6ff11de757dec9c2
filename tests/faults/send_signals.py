#!/usr/bin/env python3
"""Sends SIGINT, SIGTERM and SIGKILL at random moments of runs of every command, and looks at what is left.

    send_signals.py PROGRAM SHIM [--runs N] [--seed N] [--commands NAME...]

After SIGINT and SIGTERM the program has ended with 0 or 130, files are old or whole, and nothing else is there. Only before
it handles signals, which the preloaded library sees, may they kill it. A second signal may always. After SIGKILL one
temporary file, .NAME.PROCESS-NUMBER.tmp, may be left beside an output. Exit 1, and a line per finding.
"""
import argparse
import collections
import random
import signal
import sys
import tempfile
import time

import runs

SIGNALS = {"SIGINT": [signal.SIGINT], "SIGTERM": [signal.SIGTERM], "SIGKILL": [signal.SIGKILL],
           "SIGINT twice": [signal.SIGINT, signal.SIGINT]}


def sender(signals, delays):
    def send(process, _):
        for one, delay in zip(signals, delays):
            time.sleep(delay)
            process.send_signal(one)
    return send


def judge(bench, one, result, good, signals):
    killed = isinstance(result.code, int) and result.code < 0
    may_kill = signals[-1] == signal.SIGKILL or len(signals) > 1 or not result.has_handler
    if killed and -result.code in [int(s) for s in signals] and may_kill:
        return bench.judge(one, result, good, killed=True)
    wrong = bench.judge(one, result, good)
    if result.code not in (0, 130):
        wrong.append(f"exit code {result.code} after a signal")
    return wrong


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("shim")
    parser.add_argument("--runs", type=int, default=8, help="of every command, of each signal")
    parser.add_argument("--seed", type=int, default=1)
    parser.add_argument("--commands", nargs="*")
    args = parser.parse_args()
    print(f"seed {args.seed}")
    generator = random.Random(args.seed)
    findings = collections.defaultdict(list)
    sent = 0
    with tempfile.TemporaryDirectory(prefix="pointskin-signals-") as root:
        bench = runs.Bench(args.program, args.shim, root)
        for name, one in runs.chosen(args.commands).items():
            good = bench.run(one)
            if good.code != 0:
                raise SystemExit(f"{name}: exit code {good.code}: {good.err}")
            jobs = [(label, signals, [generator.uniform(0, 1.2 * good.seconds), generator.uniform(0, 0.3 * good.seconds)])
                    for label, signals in SIGNALS.items() for _ in range(args.runs)]
            results = runs.in_parallel(jobs, lambda job: bench.run(one, signal=sender(job[1], job[2])))
            codes = collections.Counter((job[0], result.code) for job, result in zip(jobs, results))
            for (label, signals, delays), result in zip(jobs, results):
                sent += 1
                for wrong in judge(bench, one, result, good, signals):
                    findings[f"{name}: {label}: {wrong}"].append(f"after {delays[0] * 1000:.1f} ms of {good.seconds * 1000:.1f}")
            ends = ", ".join(f"{label} -> {code}: {number}" for (label, code), number in sorted(codes.items(), key=str))
            print(f"{name}: {len(jobs)} signalled runs: {ends}", flush=True)
    for finding, examples in findings.items():
        print(f"WRONG ({len(examples)} times) {finding}, {examples[0]}")
    print(f"{sent} runs with signals, {len(findings)} findings")
    return 1 if findings else 0


if __name__ == "__main__":
    sys.exit(main())
