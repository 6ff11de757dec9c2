#!/usr/bin/env python3
"""Several ranks under real launchers of MPI against one process: bytes, words, errors, ranks that die.

    ranks_test.py PROGRAM GENERATOR LAUNCHER... [--long]

LAUNCHER is mpirun.openmpi or mpirun.mpich, or their paths. --long: 1, 2, 3, 4 and 7 ranks, more clouds and options. Exit 0 if all is as
promised, 77 if no launcher is there, 1 with a line per failure otherwise.
"""
import argparse
import hashlib
import os
import pathlib
import random
import shutil
import signal
import subprocess
import sys
import tempfile
import time

LAST_SECONDS = 10  # from a fault to the end of all ranks

# Of a program that a sanitizer watches: launchers' libraries are not built for that, and give back nothing at the end.
MPI_LIBRARIES = ["libmpi", "libmpich", "libopen-pal", "libopen-rte", "libpmix", "libucs", "libucp", "mca_"]

CASES = [  # shape, points, noise, options
    ("gyroid", 20_000, 0.002, "--depth 7 --trim 0.02 --density"),
]
LONG_CASES = CASES + [
    ("sphere", 30_000, 0, "--depth 7"),
    ("knot", 60_000, 0, "--depth 8 --density"),
    ("gyroid", 60_000, 0.002, "--depth 8 --trim 0.02"),
    ("plate", 40_000, 0, "--depth 9 --iters 16"),
    ("gyroid", 200_000, 0.001, "--depth 9 --largest"),
    ("nested", 80_000, 0, "--depth 8 --bType 2 --confidence 1"),
    ("hand", 80_000, 0.001, "--depth 9 --iters 4 --pointWeight 0"),
    ("slab", 50_000, 0, "--depth 8 --open-domain --trim auto"),
]


def digest(path):
    return hashlib.sha256(path.read_bytes()).hexdigest()


class Ranks:
    """A launcher with a program, in a folder of its own."""

    def __init__(self, launcher, program, folder):
        self.launcher, self.program, self.folder = launcher, program, folder
        self.is_open_mpi = "openmpi" in os.path.basename(launcher)
        self.has_thread_sanitizer = b"__tsan_init" in pathlib.Path(program).read_bytes()
        self.temp = folder / "temp"
        self.temp.mkdir(exist_ok=True)

    def command(self, count, arguments):
        options = ["--oversubscribe", "--bind-to", "none", "--allow-run-as-root"] if self.is_open_mpi else ["-bind-to", "none"]
        return [self.launcher, *options, "-n", str(count), self.program, *arguments]

    def start(self, count, arguments):
        return subprocess.Popen(self.command(count, arguments), stdin=subprocess.DEVNULL, stdout=subprocess.PIPE,
                                stderr=subprocess.PIPE, text=True, cwd=self.folder, env=self.environment())

    def environment(self):
        leaks = self.folder / "leaks.txt"
        leaks.write_text("".join(f"leak:{library}\n" for library in MPI_LIBRARIES))
        ours = {"LSAN_OPTIONS": f"suppressions={leaks}:print_suppressions=0", "TSAN_OPTIONS": "ignore_noninstrumented_modules=1"}
        if self.is_open_mpi:  # what its closed modules leak has no name left; MPICH's ranks are looked at
            ours["ASAN_OPTIONS"] = "detect_leaks=0"
        theirs = {name: f"{os.environ.get(name, '')}:{value}".strip(":") for name, value in ours.items()}
        theirs["HWLOC_PLUGINS_PATH"] = str(self.folder / "none")  # they leak, and are closed, too
        if self.has_thread_sanitizer:
            theirs["UCX_MEM_EVENTS"] = "n"  # MPICH's UCX takes memory calls over, as the sanitizer has
        return os.environ | theirs

    def run(self, count, arguments):
        ranks = self.start(count, arguments)
        out, err = ranks.communicate(timeout=600)
        return ranks.returncode, out, [line for line in err.splitlines() if "pointskin: " in line or ": points " in line]

    def processes(self, of):
        """Process numbers of the ranks that the process `of` has started, itself or through others."""
        parents, ranks = {}, []
        for entry in pathlib.Path("/proc").iterdir():
            if not entry.name.isdigit():
                continue
            try:
                parents[int(entry.name)] = int((entry / "stat").read_text().rsplit(")", 1)[1].split()[1])
                if os.path.realpath(entry / "exe") == os.path.realpath(self.program):
                    ranks.append(int(entry.name))
            except OSError:
                continue

        def is_below(process):
            while process > 1:
                if process == of:
                    return True
                process = parents.get(process, 0)
            return False
        return [process for process in ranks if is_below(process)]


class Test:
    def __init__(self):
        self.failures = []
        self.checks = 0

    def expect(self, holds, what):
        self.checks += 1
        if not holds:
            self.failures.append(what)
            print("FAILED", what, flush=True)


def compare_bytes(test, all_ranks, generator, folder, cases, counts):
    for number, (shape, points, noise, options) in enumerate(cases):
        cloud, whole, found = folder / f"{number}.ply", folder / "whole.ply", folder / "found.ply"
        subprocess.run([generator, shape, "--points", str(points), "--noise", str(noise), "-o", cloud], check=True)
        arguments = ["reconstruct", str(cloud), *options.split()]
        subprocess.run([all_ranks[0].program, *arguments, "-o", whole, "--quiet", "--device", "cpu"], check=True)
        for ranks in all_ranks:
            for count in counts:
                name = f"{ranks.launcher} -n {count}: {shape} {options}"
                code, out, lines = ranks.run(count, [*arguments, "-o", str(found), "--temp", str(ranks.temp), "--device", "cpu"])
                test.expect(code == 0, f"{name}: exit {code}, {lines}")
                test.expect(found.exists() and digest(found) == digest(whole), f"{name}: other bytes")
                test.expect(out == "" and len([line for line in lines if "warning" not in line]) == 1,
                            f"{name}: one line of one rank, not {lines}")
                test.expect(not any(ranks.temp.iterdir()), f"{name}: temporary files are left")
                found.unlink(missing_ok=True)


def compare_errors(test, ranks, cloud):
    output = ranks.folder / "old.ply"
    output.write_text("old")
    rest = ["-o", str(output), "--temp", str(ranks.temp), "--device", "cpu"]
    for code, arguments in [
            (2, ["info", str(cloud)]),
            (2, ["reconstruct", str(cloud), *rest, "--weakness"]),
            (2, ["reconstruct", str(cloud), "--depth", "5", *rest]),
            (3, ["reconstruct", str(cloud) + "x", "--depth", "8", *rest]),
            (6, ["reconstruct", str(cloud), "--depth", "10", "--max-memory", "24M", *rest]),
            (8, ["reconstruct", str(cloud), "--depth", "8", "-o", str(output), "--temp", "/proc", "--device", "cpu"])]:
        found, _, lines = ranks.run(2, arguments)
        name = f"{ranks.launcher}: {' '.join(arguments)}"
        test.expect(found == code, f"{name}: exit {found}, not {code}; {lines}")
        test.expect(len(lines) == 1, f"{name}: one line, not {lines}")
        test.expect(output.read_text() == "old", f"{name}: the old output has changed")
        test.expect(not any(ranks.temp.iterdir()), f"{name}: temporary files are left")


def kill(test, ranks, cloud, moments, chance):
    """One rank dies, or all are told to stop, at some moment of a run."""
    output = ranks.folder / "old.ply"
    arguments = ["reconstruct", str(cloud), "--depth", "9", "-o", str(output), "--temp", str(ranks.temp), "--device", "cpu"]
    for moment in moments:
        output.write_text("old")
        fault = chance.choice(["one rank killed", "one rank told to stop", "interrupted"])
        started = ranks.start(3, arguments)
        time.sleep(moment)
        processes = ranks.processes(started.pid)
        if started.poll() is not None or not processes:
            started.communicate()
            continue
        at = time.monotonic()
        if fault == "interrupted":
            started.send_signal(signal.SIGINT)
        else:
            os.kill(chance.choice(processes), signal.SIGKILL if fault == "one rank killed" else signal.SIGTERM)
        name = f"{ranks.launcher}, {fault} after {moment:.2f} s"
        try:
            started.communicate(timeout=60)
        except subprocess.TimeoutExpired:
            started.kill()
            test.expect(False, f"{name}: has not ended in a minute")
        seconds = time.monotonic() - at
        test.expect(seconds <= LAST_SECONDS, f"{name}: all ended after {seconds:.1f} s")
        # What is made of an interrupt is the launcher's: Hydra may end with 0.
        test.expect(started.returncode != 0 or fault == "interrupted", f"{name}: exit 0")
        test.expect(output.read_text() == "old", f"{name}: the old output has changed")
        time.sleep(0.2)
        left = [process for process in processes if os.path.exists(f"/proc/{process}/exe")]
        test.expect(not left, f"{name}: ranks go on")
        files = [file.name for file in [*ranks.temp.iterdir(), *ranks.folder.iterdir()] if file.name.startswith(".pointskin")]
        test.expect(not files, f"{name}: left behind {files}")


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("program")
    parser.add_argument("generator")
    parser.add_argument("launchers", nargs="+")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--kills", type=int, help="runs that are disturbed, of each launcher (2; long: 40)")
    parser.add_argument("--seed", type=int, default=1)
    given = parser.parse_args()
    given.program = os.path.abspath(given.program)  # launchers start in another folder
    launchers = [launcher for launcher in given.launchers if shutil.which(launcher)]
    if not launchers:
        print("skipped: none of", *given.launchers)
        sys.exit(77)
    os.environ.update(OMPI_ALLOW_RUN_AS_ROOT="1", OMPI_ALLOW_RUN_AS_ROOT_CONFIRM="1")
    chance = random.Random(given.seed)
    test = Test()
    with tempfile.TemporaryDirectory(prefix="pointskin_ranks_") as name:
        folder = pathlib.Path(name)
        all_ranks = []
        for launcher in launchers:
            (folder / os.path.basename(launcher)).mkdir()
            all_ranks.append(Ranks(launcher, given.program, folder / os.path.basename(launcher)))
        cloud = folder / "cloud.ply"
        subprocess.run([given.generator, "knot", "--points", "150000", "-o", cloud], check=True)
        compare_bytes(test, all_ranks, given.generator, folder, LONG_CASES if given.long else CASES,
                      (1, 2, 3, 4, 7) if given.long else (2, 3))
        for ranks in all_ranks:
            compare_errors(test, ranks, cloud)
            kills = given.kills if given.kills is not None else 40 if given.long else 2
            kill(test, ranks, cloud, [chance.uniform(0.1, 4) for _ in range(kills)], chance)
    print(f"{test.checks} checks, {len(test.failures)} failures; {', '.join(launchers)}")
    sys.exit(1 if test.failures else 0)


if __name__ == "__main__":
    main()
