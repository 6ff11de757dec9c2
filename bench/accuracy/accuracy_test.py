#!/usr/bin/env python3
"""Tests of accuracy.py: accuracy_test.py [FOLDER WITH THE PROGRAMS]. Most run programs made up for the purpose."""
import json
import math
import pathlib
import subprocess
import sys
import tempfile
import unittest

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE))
import cases  # noqa: E402
import verdict  # noqa: E402

PROGRAMS = pathlib.Path(sys.argv[1]) if len(sys.argv) > 1 else None

# A mesh of these programs is its own measures: errors fall with the depth, by a factor that stands in the command.
FAKE_RECONSTRUCTION = """
def reconstruct(cloud, out, depth, factor, genus=0, fails=False):
    import json, pathlib, sys
    log = pathlib.Path(out).parent / "runs.log"
    with open(log, "a") as file:
        file.write(pathlib.Path(out).name + "\\n")
    if fails:
        sys.exit("no luck")
    error = factor * 0.5 ** depth
    numbers = {"mean": error, "rms": 1.5 * error, "p95": 2 * error, "max": 4 * error}
    topology = {"closed": True, "components": 1, "euler": 2 - 2 * genus, "genus": genus}
    metrics = {"version": 1, "two_sided": {**numbers, "percent": numbers, "spacings": numbers},
               "normal_consistency": 1 - error, "f_score": 1 - error,
               "result": {**topology, "triangles": int(1000 * 4 ** depth / factor), "watertight": True},
               "truth": {"closed": True, "components": 1, "euler": 2, "genus": 0}}
    pathlib.Path(out).write_text(json.dumps(metrics))
"""
FAKE_POINTSKIN = FAKE_RECONSTRUCTION + """
import sys
words = sys.argv[2:]
value = lambda name, default: float(words[words.index(name) + 1]) if name in words else default
reconstruct(words[0], words[words.index("-o") + 1], int(value("--depth", 8)), value("--factor", 1.0),
            int(value("--genus", 0)), "--fail" in words)
"""
FAKE_PEER = FAKE_RECONSTRUCTION + """
import sys
if sys.argv[-1] == "shallow":
    sys.argv[3:] = [str(min(int(sys.argv[3]), 8)), *sys.argv[4:-1]]
reconstruct(sys.argv[1], sys.argv[2], int(sys.argv[3]), float(sys.argv[4]), int(sys.argv[5]), len(sys.argv) > 6)
"""
FAKE_GENERATOR = """
import pathlib, sys
words = sys.argv[1:]
pathlib.Path(words[words.index("-o") + 1]).write_text("ply\\nformat ascii 1.0\\nelement vertex 7\\nend_header\\n")
"""
FAKE_METRICS = """
import sys
print(open(sys.argv[1]).read())
"""


def row(**changes):
    return {"mean": 1.0, "rms": 2.0, "p95": 3.0, "max": 4.0, "spacings": 0.1, "normals": 0.01, "f_score": 0.9,
            "triangles": 1000, "components": 1, "genus": 0, "true_components": 1, "true_genus": 0, **changes}


class Brief(unittest.TestCase):
    def test_has_losses_first_and_geometric_means_last(self):
        def entry(case, **changes):
            return {"case": case, "depth": 8, "row": row(**changes)}
        lines = verdict.brief_table([(entry("won", mean=0.5), entry("won")),
                                     (entry("lost", mean=2.0, genus=3), entry("lost", components=2))])
        self.assertEqual([line.split(" | ")[0] for line in lines[2:]], ["| lost", "| won", "| geometric mean"])
        self.assertEqual(lines[2], "| lost | 8 | 2 | 2.000 | 1.000 | 1.000 | 1 | 3 (true: 0) | 2 (true: 1), 0 |")
        self.assertEqual(lines[-1], "| geometric mean | | | 1.000 | 1.000 | 1.000 | | | |")


    def test_has_a_column_of_signs_where_normals_were_found(self):
        ours = {"case": "c", "depth": 8, "row": row(), "right_signs": 0.987}
        lines = verdict.brief_table([(ours, {"case": "c", "depth": 8, "row": row()})])
        self.assertTrue(lines[0].endswith("| right signs % |"))
        self.assertTrue(lines[2].endswith("| 98.70 |"))
        self.assertEqual({line.count("|") for line in lines}, {lines[0].count("|")})


class Verdict(unittest.TestCase):
    def judge(self, ours, peer):
        return verdict.verdict_text(verdict.compare(row(**ours), row(**peer), 0.005))

    def test_equal_rows_are_not_worse_and_not_better(self):
        self.assertEqual(self.judge({}, {}), "not worse")

    def test_names_every_measure_that_is_worse(self):
        self.assertEqual(self.judge({"mean": 1.1, "normals": 0.02}, {}), "worse: mean, normals")
        self.assertEqual(self.judge({"rms": 2.1, "mean": 0.1}, {}), "worse: rms")

    def test_allows_the_tolerance_and_no_more(self):
        self.assertEqual(self.judge({"mean": 1.004}, {}), "not worse")
        self.assertEqual(self.judge({"mean": 1.006}, {}), "worse: mean")
        self.assertEqual(self.judge({"mean": 0.996}, {}), "not worse")
        self.assertEqual(self.judge({"mean": 0.994}, {}), "better")

    def test_p95_and_max_do_not_decide(self):
        self.assertEqual(self.judge({"p95": 30.0, "max": 40.0}, {}), "not worse")

    def test_wrong_topology_is_worse_unless_the_peer_is_as_wrong(self):
        self.assertEqual(self.judge({"genus": 2}, {}), "worse: topology")
        self.assertEqual(self.judge({"components": 3}, {"genus": 1}), "worse: topology")
        self.assertEqual(self.judge({"genus": 1}, {"genus": 1}), "not worse")
        self.assertEqual(self.judge({"genus": None}, {}), "worse: topology")
        self.assertEqual(self.judge({"genus": 5, "true_genus": None}, {"true_genus": None}), "not worse")

    def test_interpolates_in_the_logarithms(self):
        low, high = row(triangles=100, mean=8.0, genus=1), row(triangles=10_000, mean=2.0, genus=2)
        between = verdict.interpolate(low, high, 1000)
        self.assertAlmostEqual(between["mean"], 4.0)
        self.assertEqual(between["triangles"], 1000)
        self.assertEqual(verdict.interpolate(low, high, 200)["genus"], 1)
        self.assertEqual(verdict.interpolate(low, high, 5000)["genus"], 2)
        for at, whole in ((100, low), (10_000, high)):
            self.assertAlmostEqual(verdict.interpolate(low, high, at)["mean"], whole["mean"])


class Cases(unittest.TestCase):
    def test_pairs_clouds_with_their_truth(self):
        with tempfile.TemporaryDirectory() as folder:
            folder = pathlib.Path(folder)
            head = "ply\nformat ascii 1.0\nelement vertex 3\nproperty float x\n"
            for name, text in (("a.ply", head + "property float nx\nend_header\n"), ("a_gt.ply", head + "end_header\n"),
                               ("b.ply", head + "end_header\n"), ("b_gt.ply", head), ("c.ply", head)):
                (folder / name).write_text(text, encoding="latin-1")
            names = [case.name for case in cases.file_cases(pathlib.Path("bin"), folder, 1)]
            scans = [f"@{turned}-{scan}" for turned in (1, 2) for scan in ("scan", "roughscan", "misregistered")]
            spoilt = [f"@1-{fault}" for fault in cases.SPOILED_MESHES]
            self.assertEqual(names, ["a", *("a" + name for name in scans + spoilt), *("b" + name for name in scans + spoilt)])
            self.assertEqual(cases.point_count(folder / "a.ply"), 3)

    def test_are_chosen_by_patterns(self):
        known = list(cases.shape_cases(pathlib.Path("bin"), None, 1))
        names = [case.name for case in cases.choose(known, "gyroid-*,s*-noisy")]
        self.assertEqual(names, ["gyroid-clean", "gyroid-noisy", "sphere-noisy", "slab@1-noisy", "slab@2-noisy"])


class Accuracy(unittest.TestCase):
    """The command, with made up programs."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        (self.folder / "bin").mkdir()
        for name, text in (("pointskin", FAKE_POINTSKIN), ("pointskin_generate", FAKE_GENERATOR),
                           ("pointskin_scan", FAKE_GENERATOR), ("pointskin_metrics", FAKE_METRICS),
                           ("peer", FAKE_PEER)):
            path = self.folder / "bin" / name
            path.write_text(f"#!{sys.executable}\n{text}", encoding="utf-8")
            path.chmod(0o755)
        self.keep = self.folder / "keep"

    def peer(self, words):
        return ["--peer", f"{self.folder}/bin/peer {{in}} {{out}} {{depth}} {words}"]

    def run_it(self, *words):
        return subprocess.run([sys.executable, str(HERE / "accuracy.py"), "--bin", str(self.folder / "bin"), "--keep",
                               str(self.keep), *words], capture_output=True, text=True, check=False)

    def table(self, *words):
        result = self.run_it(*words)
        self.assertEqual(result.returncode, 0, result.stderr)
        lines = [[cell.strip() for cell in line.strip("|").split("|")] for line in result.stdout.splitlines()
                 if line.startswith("|")]
        return [dict(zip(lines[0], line)) for line in lines[2:]], result.stdout

    def runs(self):
        """Names of the meshes that were made since the last call."""
        log = self.keep / "runs.log"
        names = log.read_text().split() if log.exists() else []
        log.unlink(missing_ok=True)
        return names

    def test_judges_every_case_and_depth_and_sums_up(self):
        rows, text = self.table("--cases", "sphere-*", "--depths", "2,3", *self.peer("2.0 0"))
        self.assertEqual(len(rows), 2 * 2 * 2 + 3 * 2 * 2)  # clean, noisy; three scans; two depths; two programs
        self.assertEqual(rows[0]["mean %"], "0.25")
        self.assertEqual(rows[1]["mean %"], "0.5")
        self.assertEqual({r["verdict"] for r in rows if r["program"] == "pointskin"}, {"better"})
        self.assertIn("at equal depth: not worse on 10 of 10, better on 10 of 10", text)

    def test_says_where_we_are_worse(self):
        rows, text = self.table("--cases", "torus-clean", "--options", "--genus 1", *self.peer("0.5 0"))
        self.assertEqual(rows[0]["verdict"], "worse: mean, rms, normals, topology")
        self.assertEqual(rows[0]["genus"], "1 (true: 0)")
        self.assertIn("not worse on 0 of 1, better on 0 of 1", text)

    def test_works_without_a_peer(self):
        rows, text = self.table("--cases", "knot-clean")
        self.assertEqual([r["program"] for r in rows], ["pointskin"])
        self.assertNotIn("not worse on", text)

    def test_reuses_the_peer_even_from_a_copied_folder(self):
        words = ["--cases", "sphere-clean", *self.peer("2.0 0"), "--reuse-peer"]
        self.table(*words)
        self.assertEqual(self.runs(), ["sphere-clean-pointskin-8.ply", "sphere-clean-peer-8.ply"])
        self.keep = self.keep.rename(self.folder / "copy")
        first = self.table(*words)[0]
        self.assertEqual(self.runs(), ["sphere-clean-pointskin-8.ply"])
        self.assertEqual(first[1]["mean %"], f"{2 * 0.5 ** 8:.4g}")

    def test_runs_the_peer_again_if_its_command_or_the_cloud_changed(self):
        self.table("--cases", "sphere-clean", *self.peer("2.0 0"), "--reuse-peer")
        self.runs()
        rows = self.table("--cases", "sphere-clean", *self.peer("4.0 0"), "--reuse-peer")[0]
        self.assertIn("sphere-clean-peer-8.ply", self.runs())
        self.assertEqual(rows[1]["mean %"], f"{4 * 0.5 ** 8:.4g}")
        with open(self.keep / "sphere-clean.ply", "a", encoding="utf-8") as cloud:
            cloud.write("changed\n")
        self.table("--cases", "sphere-clean", *self.peer("4.0 0"), "--reuse-peer")
        self.assertIn("sphere-clean-peer-8.ply", self.runs())

    def test_compares_at_equal_numbers_of_triangles_between_depths(self):
        # Both follow error = 31.6 / sqrt(triangles * factor): with twice the factor the peer has half the triangles.
        rows, text = self.table("--cases", "sphere-clean", "--equal-triangles", *self.peer("2.0 0"))
        self.assertEqual(rows[2]["depth"], "8..9")
        self.assertEqual(rows[2]["triangles"], rows[0]["triangles"])
        self.assertAlmostEqual(float(rows[2]["mean %"]), 2 * 0.5 ** 8 / math.sqrt(2), delta=1e-5)
        self.assertIn("at equal numbers of triangles: not worse on 1 of 1", text)
        rows = self.table("--cases", "sphere-clean", "--equal-triangles", *self.peer("0.5 0"))[0]
        self.assertEqual(rows[2]["depth"], "7..8")

    def test_compares_at_the_peers_number_of_triangles_where_it_has_no_depth_with_ours(self):
        rows, text = self.table("--cases", "sphere-clean", "--equal-triangles", *self.peer("2.0 0 shallow"))
        self.assertEqual((rows[2]["program"], rows[2]["depth"]), ("pointskin", "7..8"))
        self.assertEqual(rows[2]["triangles"], rows[1]["triangles"])
        self.assertAlmostEqual(float(rows[2]["mean %"]), 0.5 ** 7 / math.sqrt(2), delta=1e-5)
        self.assertIn("at equal numbers of triangles: not worse on 1 of 1", text)

    def test_a_peer_that_fails_is_no_verdict_and_ours_that_fails_is_an_error(self):
        rows, text = self.table("--cases", "sphere-clean", *self.peer("2.0 0 fail"))
        self.assertEqual(rows[0]["verdict"], "alone")
        self.assertIn("no luck", text)
        result = self.run_it("--cases", "sphere-clean", "--options=--fail", *self.peer("2.0 0"))
        self.assertEqual(result.returncode, 1)
        self.assertIn("worse: failed", result.stdout)
        self.assertIn("failed: 1", result.stdout)

    def test_writes_json(self):
        path = self.folder / "out.json"
        self.table("--cases", "sphere-clean", "--json", str(path), *self.peer("2.0 0"))
        report = json.loads(path.read_text())
        self.assertEqual(report["version"], 1)
        self.assertEqual([e["program"] for e in report["entries"]], ["pointskin", "peer"])
        self.assertEqual(report["entries"][0]["metrics"]["truth"]["genus"], 0)
        self.assertTrue(report["entries"][0]["verdict"]["better"])

    def test_puts_the_table_between_the_marks_of_a_text(self):
        path = self.folder / "text.md"
        path.write_text("before <!-- results: begin -->\nold\n<!-- results: end --> after\n", encoding="utf-8")
        for _ in range(2):
            _, text = self.table("--cases", "sphere-clean", "--update", str(path), *self.peer("2.0 0"))
            updated = path.read_text(encoding="utf-8")
            self.assertTrue(updated.startswith("before <!-- results: begin -->\n\n| case |"))
            self.assertTrue(updated.endswith("better on 1 of 1.\n\n<!-- results: end --> after\n"))
            self.assertNotIn("old", updated)
            self.assertEqual(len(updated.splitlines()), 10)
        path.write_text("no marks", encoding="utf-8")
        self.assertEqual(self.run_it("--cases", "sphere-clean", "--update", str(path)).returncode, 2)

    def test_refuses_what_it_cannot_do(self):
        for words in (["--cases", "no-such"], ["--peer", "cp {in} mesh.ply"], ["--data", "/no/such/folder"],
                      ["--equal-triangles"], ["--depths", "eight"]):
            result = self.run_it(*words)
            self.assertEqual(result.returncode, 2, words)
            self.assertIn("accuracy.py: ", result.stderr)


class SameBytes(unittest.TestCase):
    """The command, with made up programs: what they write depends on the depth, and on a word in them."""

    def setUp(self):
        temporary = tempfile.TemporaryDirectory()
        self.addCleanup(temporary.cleanup)
        self.folder = pathlib.Path(temporary.name)
        self.program("pointskin_generate", FAKE_GENERATOR)

    def program(self, name, text):
        path = self.folder / name
        path.write_text(f"#!{sys.executable}\n{text}", encoding="utf-8")
        path.chmod(0o755)
        return path

    def compare(self, old, new):
        head = "import pathlib, sys\nwords = sys.argv[1:]\nmesh = pathlib.Path(words[words.index('-o') + 1])\n"
        head += "depth = int(words[words.index('--depth') + 1])\n"
        self.program("pointskin", head + new)
        return subprocess.run([sys.executable, str(HERE / "same_bytes.py"), str(self.program("old", head + old)), "--bin",
                               str(self.folder), "--cases", "sphere-clean,torus-clean", "--depths", "4,5"],
                              capture_output=True, text=True, check=False)

    def test_the_same_meshes_and_the_same_failures_are_the_same(self):
        either = "mesh.write_text(f'{depth}') if depth < 5 else sys.exit(5)"
        result = self.compare(either, either)
        self.assertEqual((result.returncode, result.stdout), (0, "depth 4: 2 of 2 are the same\ndepth 5: 2 of 2 are the same\n"))

    def test_what_differs_is_named(self):
        result = self.compare("mesh.write_text('a')", "mesh.write_text('a' if depth < 5 else 'b')")
        self.assertEqual(result.returncode, 1)
        self.assertEqual([line.split(":")[0] for line in sorted(result.stdout.splitlines())],
                         ["depth 4", "depth 5", "sphere-clean, depth 5", "torus-clean, depth 5"])
        self.assertIn("depth 5: 0 of 2 are the same", result.stdout)

    def test_a_failure_is_no_mesh(self):
        for old, new in (("sys.exit(5)", "mesh.write_text('a')"), ("sys.exit(5)", "sys.exit(6)")):
            result = self.compare(old, new)
            self.assertEqual(result.returncode, 1)
            self.assertIn("torus-clean, depth 4: exit code 5, now ", result.stdout)


@unittest.skipUnless(PROGRAMS and (PROGRAMS / "pointskin").exists(), "the program pointskin is not built")
class WithTheProgramsThemselves(unittest.TestCase):
    def test_measures_generated_and_scanned_shapes(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "out.json"
            peer = f"{PROGRAMS / 'pointskin'} reconstruct {{in}} -o {{out}} --depth {{depth}} --screening 0 -q"
            words = ["--bin", str(PROGRAMS), "--cases", "sphere-clean,torus-scan,nested-noisy", "--depths", "6",
                     "--points", "20000", "--samples", "20000", "--peer", peer, "--json", str(path)]
            result = subprocess.run([sys.executable, str(HERE / "accuracy.py"), *words], capture_output=True, text=True,
                                    check=False)
            self.assertEqual(result.returncode, 0, result.stderr)
            report = json.loads(path.read_text())
        rows = {(e["case"], i % 2): e["row"] for i, e in enumerate(report["entries"])}
        self.assertEqual(len(rows), 6)
        for (case, program), found in rows.items():
            self.assertLess(found["mean"], 0.5 if program == 0 else 5, case)
            self.assertEqual((found["components"], found["genus"]), (found["true_components"], found["true_genus"]))
            self.assertTrue(found["watertight"])
        self.assertEqual(rows["nested-noisy", 0]["components"], 3)
        self.assertEqual(rows["torus-scan", 0]["genus"], 1)
        self.assertLess(rows["sphere-clean", 0]["mean"], rows["sphere-clean", 1]["mean"])  # screening helps

    def test_measures_spoilt_shapes(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "out.json"
            words = ["--bin", str(PROGRAMS), "--cases", "torus-1000,torus-lines,slab@2-flipped1", "--depths", "5",
                     "--samples", "20000", "--json", str(path)]
            result = subprocess.run([sys.executable, str(HERE / "accuracy.py"), *words], capture_output=True, text=True,
                                    check=False)
            self.assertEqual(result.returncode, 0, result.stderr)
            rows = {entry["case"]: entry["row"] for entry in json.loads(path.read_text())["entries"]}
        self.assertEqual(sorted(rows), ["slab@2-flipped1", "torus-1000", "torus-lines"])
        for case, found in rows.items():
            self.assertLess(found["mean"], 2, case)

    def test_finds_the_normals_that_it_took_away(self):
        with tempfile.TemporaryDirectory() as folder:
            path = pathlib.Path(folder) / "out.json"
            words = ["--bin", str(PROGRAMS), "--cases", "torus-1000,torus-outliers5", "--depths", "5", "--points", "20000",
                     "--samples", "20000", "--without-normals", "--keep", folder, "--json", str(path)]
            result = subprocess.run([sys.executable, str(HERE / "accuracy.py"), *words], capture_output=True, text=True,
                                    check=False)
            self.assertEqual(result.returncode, 0, result.stderr)
            signs = {entry["case"]: entry["right_signs"] for entry in json.loads(path.read_text())["entries"]}
            self.assertFalse(cases.has_normals(pathlib.Path(folder) / "torus-1000-bare.ply"))
        self.assertEqual(signs["torus-1000"], 1)
        self.assertGreater(signs["torus-outliers5"], 0.95)
        self.assertLess(signs["torus-outliers5"], 1)  # half of the outliers' normals, which are random


if __name__ == "__main__":
    unittest.main(argv=sys.argv[:1])
