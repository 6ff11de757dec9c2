#!/usr/bin/env python3
"""Tests of compare.py: what it prints and how it exits."""
import json
import pathlib
import subprocess
import sys
import tempfile
import unittest

PROGRAM = pathlib.Path(__file__).resolve().with_name("compare.py")


def pointskin_report(*totals):
    """A report with one run whose total took these milliseconds."""
    ms = {"median": sorted(totals)[len(totals) // 2], "min": min(totals), "max": max(totals)}
    run = {"cloud": "knot", "depth": 8, "device": "cpu", "ms": {"total": ms}}
    return {"version": 1, "command": "bench", "runs": [run], "file_runs": []}


def google_report(*times, unit="ms", name="sort/1024"):
    runs = [{"name": name, "run_name": name, "run_type": "iteration", "real_time": t, "time_unit": unit} for t in times]
    runs.append({"name": name + "_mean", "run_name": name, "run_type": "aggregate", "aggregate_name": "mean",
                 "real_time": 1e9, "time_unit": unit})
    return {"context": {}, "benchmarks": runs}


class Compare(unittest.TestCase):
    def compare(self, old, new, *options):
        with tempfile.TemporaryDirectory() as folder:
            paths = []
            for name, content in (("old.json", old), ("new.json", new)):
                path = pathlib.Path(folder) / name
                path.write_text(content if isinstance(content, str) else json.dumps(content), encoding="utf-8")
                paths.append(str(path))
            return subprocess.run([sys.executable, str(PROGRAM), *paths, *options], capture_output=True, text=True,
                                  check=False)

    def test_prints_old_new_and_ratio(self):
        result = self.compare(pointskin_report(10, 10, 10), pointskin_report(15, 15, 15))
        self.assertEqual(result.returncode, 0, result.stderr)
        row = result.stdout.splitlines()[1]
        self.assertEqual(row.split()[-4:], ["10", "15", "1.500", "slower"])
        self.assertIn("knot/depth 8/cpu/total", row)

    def test_fails_above_the_limit_only(self):
        old, new = pointskin_report(10, 10, 10), pointskin_report(12, 12, 12)
        self.assertEqual(self.compare(old, new, "--fail-above", "1.10").returncode, 1)
        self.assertEqual(self.compare(old, new, "--fail-above", "1.25").returncode, 0)
        self.assertEqual(self.compare(new, old, "--fail-above", "1.10").returncode, 0)

    def test_a_change_within_the_range_of_either_side_is_noise(self):
        noisy, steady = pointskin_report(8, 10, 14), pointskin_report(12, 12, 12)
        for old, new in ((noisy, steady), (steady, noisy)):
            result = self.compare(old, new, "--fail-above", "1.10")
            self.assertEqual(result.returncode, 0, result.stdout)
            self.assertNotIn("slower", result.stdout)
            self.assertNotIn("faster", result.stdout)

    def test_reads_google_benchmark_in_any_unit_and_leaves_out_its_means(self):
        result = self.compare(google_report(2, 3, 4), google_report(1000, 1500, 1100, unit="us"))
        self.assertEqual(result.returncode, 0, result.stderr)
        self.assertEqual(result.stdout.splitlines()[1].split(), ["sort/1024", "3", "1.1", "0.367", "faster"])
        self.assertEqual(len(result.stdout.splitlines()), 2)

    def test_names_what_only_one_file_has(self):
        new = google_report(1)
        new["benchmarks"] += google_report(1, name="scan/1024")["benchmarks"]
        result = self.compare(google_report(1), new)
        self.assertIn("scan/1024  only in the new file", result.stdout)

    def test_files_that_cannot_be_compared_are_a_usage_error(self):
        good = pointskin_report(1)
        bad = ["no json", "[]", "3", {"runs": []}, {"version": 2, "command": "bench"},
               {"version": 1, "command": "bench"}, google_report(1),
               {"version": 1, "command": "bench", "runs": [], "file_runs": []}]
        for other in bad:
            result = self.compare(good, other)
            self.assertEqual(result.returncode, 2, other)
            self.assertRegex(result.stderr, r"^compare\.py: .*\n$")


if __name__ == "__main__":
    unittest.main()
