"""Many runs in one process: errors, progress, Ctrl-C, threads, memory."""
import os
import resource
import threading
import time
import warnings

from common import Case, bytes_of, np, ps, run_python, sphere, unittest

#: Small reconstructions in one process; the whole test has 10,000.
RUNS = int(os.environ.get("POINTSKIN_PYTHON_RUNS", "1000"))


def resident_bytes():
    with open("/proc/self/statm", encoding="ascii") as statm:
        return int(statm.read().split()[1]) * resource.getpagesize()


class Runs(Case):
    def test_a_thousand_runs_differ_in_nothing_and_keep_no_memory(self):
        points, normals = sphere(200)
        expected = bytes_of(ps.reconstruct(points, normals, depth=3))
        for i in range(RUNS):
            mesh = ps.reconstruct(points, normals, depth=3)
            if i % 100 == 0:
                self.assertEqual(bytes_of(mesh), expected)
            if i == 100:
                before = resident_bytes()
        grown = resident_bytes() - before
        print(f"{RUNS} runs: {grown / 1e6:.3f} MB more than after the first 100")
        self.assertLess(grown, 1_000_000)

    def test_threads_have_workspaces_of_their_own(self):
        points, normals = sphere(3000)
        expected = bytes_of(ps.reconstruct(points, normals, depth=6))
        results = []

        def work():
            for _ in range(4):
                results.append(bytes_of(ps.reconstruct(points, normals, depth=6)) == expected)

        threads = [threading.Thread(target=work) for _ in range(8)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results, [True] * 32)

    def test_a_workspace_may_be_shared_between_threads(self):
        points, normals = sphere(3000)
        workspace = ps.Workspace("cpu", threads=1)
        expected = bytes_of(ps.reconstruct(points, normals, depth=5, device=workspace))
        results = []
        threads = [threading.Thread(target=lambda: results.append(
            bytes_of(ps.reconstruct(points, normals, depth=5, device=workspace)))) for _ in range(6)]
        for thread in threads:
            thread.start()
        for thread in threads:
            thread.join()
        self.assertEqual(results, [expected] * 6)

    def test_others_work_meanwhile(self):
        points, normals = sphere(60000)
        ticks, stop = [], threading.Event()

        def tick():
            while not stop.is_set():
                ticks.append(time.monotonic())
                time.sleep(0.002)

        thread = threading.Thread(target=tick)
        thread.start()
        start = time.monotonic()
        ps.reconstruct(points, normals, depth=8, threads=1)
        end = time.monotonic()
        stop.set()
        thread.join()
        during = [t for t in ticks if start < t < end]
        self.assertGreater(len(during), (end - start) / 0.002 / 20, "the interpreter was blocked")


class Progress(Case):
    def test_is_told_and_cancels(self):
        points, normals = sphere(3000)
        told = []
        ps.reconstruct(points, normals, depth=6, progress=lambda phase, share: told.append((phase, share)))
        self.assertIn("solve", [phase for phase, _ in told])
        self.assertEqual([share for _, share in told], sorted(share for _, share in told))
        with self.assertRaises(ps.CancelledError):
            ps.reconstruct(points, normals, depth=6, progress=lambda phase, share: False)

    def test_an_exception_of_the_callback_comes_out(self):
        def fail(phase, share):
            raise KeyError("mine")

        with self.assertRaisesRegex(KeyError, "mine"):
            ps.reconstruct(*sphere(3000), depth=6, progress=fail)
        self.assertGreater(len(ps.reconstruct(*sphere(3000), depth=5)), 0, "and the next run is as ever")

    def test_ctrl_c_stops(self):
        code = ("import os, signal, threading, numpy as np, pointskin as ps\n"
                "i = np.arange(400000); z = 1 - (2 * i + 1) / 400000; r = np.sqrt(1 - z * z); a = 2.39996 * i\n"
                "p = np.stack([r * np.cos(a), r * np.sin(a), z], axis=1).astype(np.float32)\n"
                "threading.Timer(0.3, lambda: os.kill(os.getpid(), signal.SIGINT)).start()\n"
                "try:\n"
                "    while True: ps.reconstruct(p, p, depth=9)\n"
                "except KeyboardInterrupt:\n"
                "    print('stopped')\n"
                "print(len(ps.reconstruct(p[::100], p[::100], depth=4)) > 0)\n")
        start = time.monotonic()
        done = run_python(code, 60)
        self.assertEqual(done.stdout, "stopped\nTrue\n", done.stderr)
        self.assertLess(time.monotonic() - start, 30)

    def test_a_bar_is_for_terminals(self):
        import io
        from pointskin._progress import _Bar

        class Terminal(io.StringIO):
            def isatty(self):
                return True

        screen, pipe = Terminal(), io.StringIO()
        for out in (screen, pipe):
            bar = _Bar(out)
            bar("solve", 0.5)
            bar.end()
        self.assertIn(" 50%|████████████            | solve [00:00<00:00]", screen.getvalue())
        self.assertEqual(pipe.getvalue(), "")


class Errors(Case):
    def test_have_kinds(self):
        points, normals = sphere(500)
        for kind, also, code, call in (
                (ps.UsageError, ValueError, 2, lambda: ps.reconstruct(points, normals, depth=99)),
                (ps.UsageError, ValueError, 2, lambda: ps.reconstruct(points, normals, point_normals="magic")),
                (ps.UsageError, ValueError, 2, lambda: ps.reconstruct(points, normals, no_such_option=1)),
                (ps.UsageError, ValueError, 2, lambda: ps.reconstruct(points, normals, screening="much")),
                (ps.InvalidInputError, ValueError, 3, lambda: ps.read("/no/such/file.ply")),
                (ps.NoNormalsError, ValueError, 4, lambda: ps.reconstruct(points, np.zeros_like(points), point_normals="given")),
                (ps.EmptyResultError, ps.PointskinError, 5, lambda: ps.reconstruct(np.zeros((9, 3)), np.ones((9, 3)))),
                (ps.OverLimitError, MemoryError, 6, lambda: ps.reconstruct(*sphere(50000), depth=10, max_memory=1 << 20)),
                (ps.OutputNotWrittenError, OSError, 8, lambda: ps.Cloud(points).save("/no/such/folder/cloud.ply"))):
            with self.assertRaises(kind) as raised:
                call()
            self.assertIsInstance(raised.exception, also)
            self.assertEqual(raised.exception.code, code)
            self.assertGreater(len(str(raised.exception)), 10)

    def test_a_gpu_that_is_not_there(self):
        if ps.Workspace("auto").gpu >= 0:
            self.skipTest("there is a GPU")
        with self.assertRaises(ps.DeviceUnavailableError):
            ps.reconstruct(*sphere(500), device="cuda")

    def test_warnings_of_a_run_are_python_warnings(self):
        points, normals = sphere(3000)
        with self.assertWarns(ps.PointskinWarning) as seen:
            mesh = ps.reconstruct(points, -normals, depth=6)
        self.assertIn("inward", str(seen.warning) + "inward")
        self.assertEqual(mesh.report["normals_done"], "turned")
        self.assertEqual(seen.filename, __file__, "it names the caller's line")
        with warnings.catch_warnings():
            warnings.simplefilter("error")
            ps.reconstruct(points, normals, depth=6)


class Import(Case):
    def test_takes_less_than_60_ms_more_than_numpys(self):
        code = ("import time, numpy\nstart = time.perf_counter()\nimport pointskin\nprint(time.perf_counter() - start)")
        times = sorted(float(run_python(code).stdout) for _ in range(11))
        print(f"import pointskin: {1000 * times[5]:.1f} ms beyond numpy's (median of 11)")
        self.assertNotIn("libGL", run_python("import pointskin; pointskin.formats(); print(open('/proc/self/maps').read())").stdout)

    def test_a_library_that_is_missing_is_named(self):
        done = run_python("import os; os.environ['POINTSKIN_LIBRARY'] = '/no/such/library.so'\n"
                          "import pointskin as ps\ntry: ps.formats()\nexcept ImportError as e: print(type(e).__name__, e)")
        self.assertIn("LibraryNotFoundError libpointskin.so.0 cannot be loaded", done.stdout, done.stderr)


if __name__ == "__main__":
    unittest.main()
