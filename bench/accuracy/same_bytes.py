#!/usr/bin/env python3
"""Whether two builds of the program make the same meshes, byte for byte, of all cases of the accuracy benchmark.

    bench/accuracy/same_bytes.py OLD/bin/pointskin --depths 6,7,8,9,10

Then what docs/accuracy.md says of one of them holds for the other. Prints a line for each mesh that differs and one for each
depth. The exit code is 1 if a mesh differs, or a run fails with one of them alone or in another way.
"""
import argparse
import concurrent.futures
import os
import pathlib
import sys
import tempfile

import cases
import programs
from accuracy import ROOT, whole_numbers


def parse(words):
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0], formatter_class=argparse.ArgumentDefaultsHelpFormatter)
    add = parser.add_argument
    add("old", metavar="PROGRAM", type=pathlib.Path, help="pointskin of the other build")
    add("--bin", type=pathlib.Path, default=ROOT / "build/bin", help="folder of the programs of this build")
    add("--cases", metavar="PATTERN,...", default="*", help="run only cases with such a name, as in 'gyroid-*,srb_*'")
    add("--data", metavar="FOLDER", type=pathlib.Path, help="as of accuracy.py")
    add("--depths", metavar="D,...", type=whole_numbers, default=[8], help="octree depths")
    add("--points", type=int, help="points of every generated cloud, instead of the usual number")
    add("--seed", type=int, default=1, help="of the generated clouds")
    add("--device", default="cpu", help="of both programs")
    add("--jobs", type=int, default=len(os.sched_getaffinity(0)), help="cases at a time; each has one thread")
    add("--timeout", metavar="SECONDS", type=float, default=1800, help="of one run of a program")
    options = parser.parse_args(words)
    if options.data and not options.data.is_dir():
        parser.error(f"--data: {options.data} is no folder")
    return options


def outcome(program, cloud, mesh, depth, options):
    """The digest of the mesh that a program makes, or how it failed."""
    words = [str(program), "reconstruct", str(cloud), "-o", str(mesh), "--depth", str(depth), "--device", options.device,
             "--threads", "1", "-q"]
    try:
        programs.run(words, options.timeout)
        return programs.digest(mesh)
    except programs.Failed as failure:
        return str(failure).removeprefix(f"{program}: ").split(":")[0]
    finally:
        mesh.unlink(missing_ok=True)


def compare(case, options):
    """(depth, whether both made the same) for each depth; prints what differs."""
    with tempfile.TemporaryDirectory() as folder:
        bench = programs.Bench(pathlib.Path(folder), [], 1, options.timeout)
        cloud = bench.cloud(case, reuse=False)
        results = []
        for depth in options.depths:
            found = [outcome(program, cloud, bench.folder / "mesh.ply", depth, options)
                     for program in (options.old, options.bin / "pointskin")]
            if found[0] != found[1]:
                print(f"{case.name}, depth {depth}: {found[0][:16]}, now {found[1][:16]}", flush=True)
            results.append((depth, found[0] == found[1]))
        return results


def main(words):
    options = parse(words)
    chosen = cases.choose(cases.known_cases(options.bin, options.points, options.seed, options.data), options.cases)
    if not chosen:
        print(f"same_bytes.py: no case matches {options.cases}", file=sys.stderr)
        return 2
    same = dict.fromkeys(options.depths, 0)
    with concurrent.futures.ThreadPoolExecutor(options.jobs) as pool:
        try:
            for results in pool.map(lambda case: compare(case, options), chosen):
                for depth, is_same in results:
                    same[depth] += is_same
        except (programs.Failed, OSError, ValueError) as failure:
            print(f"same_bytes.py: {failure}", file=sys.stderr)
            return 1
    for depth, count in same.items():
        print(f"depth {depth}: {count} of {len(chosen)} are the same")
    return 0 if all(count == len(chosen) for count in same.values()) else 1


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
