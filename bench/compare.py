#!/usr/bin/env python3
"""Compares two results of the same benchmarks, an old one and a new one.

    bench/compare.py OLD.json NEW.json [--fail-above 1.10]

Reads reports of `pointskin bench --report` and of Google Benchmark (--benchmark_out=FILE --benchmark_out_format=json),
both files of the same kind. Prints old and new medians in milliseconds and their ratio, new / old. A change is marked
only where it is beyond the noise: each median lies outside of the range of the other's runs. Benchmarks of Google
Benchmark have a range with --benchmark_repetitions=N.

exit code 0: compared; 1: with --fail-above R, something got slower beyond the noise by more than the factor R;
2: usage, a file that cannot be read, or nothing in common
"""
import argparse
import json
import statistics
import sys

TO_MS = {"ns": 1e-6, "us": 1e-3, "ms": 1.0, "s": 1e3}


class Timing:
    """Median, least and largest time in milliseconds."""

    def __init__(self, median, least, most):
        self.median, self.least, self.most = median, least, most

    def holds(self, ms):
        return self.least <= ms <= self.most


def timings_of_pointskin(report):
    """One timing per cloud, device, depth and phase, and one per whole program."""
    timings = {}
    for run in report["runs"]:
        for phase, ms in run["ms"].items():
            name = f"{run['cloud']}/depth {run['depth']}/{run['device']}/{phase}"
            timings[name] = Timing(ms["median"], ms["min"], ms["max"])
    for run in report["file_runs"]:
        if "seconds" in run:
            s = run["seconds"]
            name = f"{run['cloud']}/depth {run['depth']}/{run['program']}/file to file"
            timings[name] = Timing(1e3 * s["median"], 1e3 * s["min"], 1e3 * s["max"])
    return timings


def timings_of_google(report):
    """One timing per benchmark, over its repetitions; means of repetitions alone have no range."""
    times = {}
    for run in report["benchmarks"]:
        if run.get("error_occurred"):
            continue
        if run.get("run_type", "iteration") == "iteration":
            times.setdefault(run.get("run_name", run["name"]), []).append(run["real_time"] * TO_MS[run["time_unit"]])
    if times:
        return {name: Timing(statistics.median(ms), min(ms), max(ms)) for name, ms in times.items()}
    medians = [run for run in report["benchmarks"] if run.get("aggregate_name") == "median"]
    return {run["run_name"]: Timing(*3 * [run["real_time"] * TO_MS[run["time_unit"]]]) for run in medians}


def read(path):
    """@returns the kind of the file and its timings"""
    with open(path, encoding="utf-8") as file:
        report = json.load(file)
    if isinstance(report, dict) and report.get("command") == "bench":
        if report.get("version") != 1:
            raise ValueError(f"version {report.get('version')} is not known")
        return "pointskin", timings_of_pointskin(report)
    if isinstance(report, dict) and "benchmarks" in report:
        return "Google Benchmark", timings_of_google(report)
    raise ValueError("neither a report of pointskin bench nor of Google Benchmark")


def is_beyond_noise(old, new):
    return not old.holds(new.median) and not new.holds(old.median)


def verdict(old, new):
    if not is_beyond_noise(old, new):
        return ""
    return "slower" if new.median > old.median else "faster"


def ratio(old, new):
    if old.median > 0:
        return new.median / old.median
    return 1.0 if new.median == old.median else float("inf")


def table(old, new):
    """Lines of the table, benchmarks in the order of the new file."""
    names = [name for name in new if name in old]
    width = max(len(name) for name in names)
    yield f"{'benchmark':<{width}}  {'old ms':>11}  {'new ms':>11}  {'ratio':>6}"
    for name in names:
        row = f"{name:<{width}}  {old[name].median:>11.4g}  {new[name].median:>11.4g}  {ratio(old[name], new[name]):>6.3f}"
        yield f"{row}  {verdict(old[name], new[name])}".rstrip()
    for path, here, there in (("old", old, new), ("new", new, old)):
        yield from (f"{name:<{width}}  only in the {path} file" for name in here if name not in there)


def slower_than(old, new, limit):
    return [name for name in new
            if name in old and verdict(old[name], new[name]) == "slower" and ratio(old[name], new[name]) > limit]


def parse(words):
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("old", metavar="OLD.json")
    parser.add_argument("new", metavar="NEW.json")
    parser.add_argument("--fail-above", type=float, metavar="R", help="largest ratio that passes, e.g. 1.10")
    return parser.parse_args(words)


def stop(story):
    print(f"compare.py: {story}", file=sys.stderr)
    return 2


def main(words):
    args = parse(words)
    files = []
    for path in (args.old, args.new):
        try:
            files.append(read(path))
        except (OSError, ValueError, KeyError, TypeError, AttributeError) as error:
            return stop(f"{path}: {error}")
    (old_kind, old), (new_kind, new) = files
    if old_kind != new_kind:
        return stop(f"{args.old} is of {old_kind}, {args.new} of {new_kind}")
    if not set(old) & set(new):
        return stop("the files have no benchmark in common")
    print("\n".join(table(old, new)))
    failed = slower_than(old, new, args.fail_above) if args.fail_above is not None else []
    if failed:
        print(f"slower by more than {args.fail_above}: {', '.join(failed)}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main(sys.argv[1:]))
