#!/usr/bin/env python3
"""Outputs that cannot be written, or meet others: what is said then, and what is left.

    disks_and_files.py PROGRAM SHIM [--long]

Disks that fill up and folders that are read-only are small file systems in memory, mounted in a namespace of this test's
own; where that is not allowed, these tests are left out, and that is said. Exit 1, and a line per finding.
"""
import argparse
import os
import pathlib
import shutil
import subprocess
import sys
import tempfile
import threading
import time

import runs

WRITERS = {name: one for name, one in runs.COMMANDS.items() if one.outputs or one.reports}
NOT_WRITTEN, USAGE, INVALID = 8, 2, 3
FULL = pathlib.Path("/dev/full")


class Findings:
    def __init__(self):
        self.count = self.tried = 0

    def check(self, right, story):
        self.tried += 1
        if not right:
            self.count += 1
            print(f"WRONG {story}", flush=True)


def started(bench, words, folder, **more):
    return subprocess.Popen([bench.program, *words], cwd=folder, stdin=subprocess.DEVNULL, stderr=subprocess.PIPE,
                            stdout=more.pop("stdout", subprocess.PIPE), **more)


def ended(process):
    out, err = process.communicate(timeout=runs.TIMES_OUT_AFTER_S)
    return runs.Result(process.returncode, out, err.decode(errors="replace"), {}, {}, 0, True, 0)


def run_in(bench, one, folder, words=None):
    return ended(started(bench, words or bench.words(one)[1:], folder))


def fails_well(found, result, code, story):
    found.check(result.code == code and not runs.judge_end(result), f"{story}: exit code {result.code}, {result.err!r}")


def with_old_files(one, folder):
    for name in (*one.outputs, *one.reports):
        (folder / name).write_bytes(runs.OLD)


def held(folder):
    return {path.name: path.read_bytes() for path in folder.iterdir() if path.is_file()}


def full_disks(found, bench, root, everything):
    """A disk that has room for a part of the outputs: none of it, a half, nearly all."""
    disk = root / "disk"
    disk.mkdir()
    page = 4096
    for name, one in WRITERS.items():
        good = bench.run(one)
        if good.code != 0:
            raise SystemExit(f"{name}: exit code {good.code}: {good.err}")
        known = (*one.outputs, *one.reports)
        most = sum(-(-len(good.files[file]) // page) for file in known)
        least = len(known)  # pages of the old files
        rooms = range(least, least + most) if everything else {least, least + most // 2, least + most - 1}
        for pages in sorted(rooms):
            subprocess.run(["mount", "-t", "tmpfs", "-o", f"size={pages * page}", "none", disk], check=True)
            try:
                with_old_files(one, disk)
                result = run_in(bench, one, disk)._replace(files=held(disk))
            finally:
                subprocess.run(["umount", disk], check=True)
            wrong = bench.judge(one, result, good)
            found.check(result.code in (0, NOT_WRITTEN) and not wrong,
                        f"{name} on a disk of {pages} pages: exit code {result.code}, {wrong}, {result.err!r}")
    disk.rmdir()


def read_only_folders(found, bench, root, _):
    disk = root / "read-only"
    disk.mkdir()
    for name, one in WRITERS.items():
        subprocess.run(["mount", "-t", "tmpfs", "-o", "size=256k", "none", disk], check=True)
        try:
            with_old_files(one, disk)
            subprocess.run(["mount", "-o", "remount,ro", disk], check=True)
            result = run_in(bench, one, disk)
            fails_well(found, result, NOT_WRITTEN, f"{name} in a read-only folder")
            found.check(set(held(disk).values()) == {runs.OLD}, f"{name} in a read-only folder: files have changed")
        finally:
            subprocess.run(["umount", disk], check=True)
    disk.rmdir()


def full_devices(found, bench, root, _):
    """Each output in turn is a link to /dev/full."""
    if not FULL.is_char_device():
        return print("left out: there is no /dev/full")
    for name, one in WRITERS.items():
        for file in (*one.outputs, *one.reports):
            folder = pathlib.Path(tempfile.mkdtemp(dir=root))
            (folder / file).symlink_to(FULL)
            fails_well(found, run_in(bench, one, folder), NOT_WRITTEN, f"{name} with {file} on a full device")
            found.check(FULL.is_char_device(), "/dev/full was replaced")
            found.check(not [path for path in folder.iterdir() if path.name.endswith(".tmp")],
                        f"{name} with {file} on a full device: something temporary is left")
            shutil.rmtree(folder)


def full_stdout(found, bench, root, _):
    for name, one in runs.COMMANDS.items():
        if not one.printed or not bench.run(one).out:
            continue
        with FULL.open("wb") as full:
            result = ended(started(bench, bench.words(one)[1:], root, stdout=full))
        fails_well(found, result._replace(out=b""), NOT_WRITTEN, f"{name} with stdout on a full device")
        for file in (*one.outputs, *one.reports):
            (root / file).unlink(missing_ok=True)


def closed_pipes(found, bench, root, _):
    """The reader of stdout goes: at once, and after some bytes of a result that is larger than a pipe."""
    for name, one in runs.COMMANDS.items():
        good = bench.run(one)
        if not one.printed or not good.out:
            continue
        for taken in (0, 1, 5000):
            if taken > 0 and len(good.out) < 2 * 65536:
                continue
            folder = pathlib.Path(tempfile.mkdtemp(dir=root))
            if taken > 0:
                process = started(bench, bench.words(one)[1:], folder)
                process.stdout.read(taken)
                process.stdout.close()
            else:  # gone before the first byte: a pipe takes what is written before its reader goes
                reader, writer = os.pipe()
                os.close(reader)
                process = started(bench, bench.words(one)[1:], folder, stdout=writer)
                os.close(writer)
            err = process.stderr.read().decode()
            result = runs.Result(process.wait(), b"", err, {}, {}, 0, True, 0)
            process.stderr.close()
            fails_well(found, result, NOT_WRITTEN, f"{name} into a pipe that closes after {taken} bytes")
            shutil.rmtree(folder)


def aliased(found, bench, root, _):
    """An output is an input by another name, and two outputs are one file, by three kinds of names."""
    aliases = {"a symbolic link": os.symlink, "a hard link": os.link}
    for name, one in WRITERS.items():
        inputs = [word for word in one.words if word.startswith("@")]
        outputs = [word for word in one.words[1:] if word in (*one.outputs, *one.reports)]
        for label, make in aliases.items():
            for output in outputs if inputs else ():
                folder = pathlib.Path(tempfile.mkdtemp(dir=root))
                shutil.copytree(bench.inputs, folder, dirs_exist_ok=True)
                before = held(folder)
                make(folder / inputs[0][1:], folder / output)
                result = run_in(bench, one, folder, [word.replace("@", f"{folder}/") for word in one.words])
                fails_well(found, result, USAGE, f"{name} with {output} as {label} to an input")
                found.check({file: data for file, data in held(folder).items() if file != output} == before,
                            f"{name} with {output} as {label} to an input: files have changed")
                shutil.rmtree(folder)
            for first, second in zip(outputs, outputs[1:]):
                folder = pathlib.Path(tempfile.mkdtemp(dir=root))
                (folder / first).write_bytes(runs.OLD)
                make(folder / first, folder / second)
                result = run_in(bench, one, folder)
                fails_well(found, result, USAGE, f"{name} with {second} as {label} to {first}")
                found.check(held(folder) == {first: runs.OLD, second: runs.OLD}, f"{name}: files have changed")
                shutil.rmtree(folder)


def concurrent_writers(found, bench, root, everything):
    """Several runs with one output, which is then the whole result of one of them; another process reads all the time."""
    folder = root / "shared"
    folder.mkdir()
    target = folder / "out.ply"
    results = {}
    for depth in (3, 4, 5):
        words = ["reconstruct", str(bench.inputs / "a.ply"), "-o", str(target), "--depth", str(depth), "-q", "--threads", "1"]
        fails_well(found, ended(started(bench, words, folder)), 0, f"a writer of depth {depth}")
        results[depth] = (words, target.read_bytes())
    whole = {data for _, data in results.values()}
    found.check(len(whole) == 3, "three depths, and not three files")
    strange = []
    done = threading.Event()

    def look():
        while not done.is_set():
            data = target.read_bytes()
            if data not in whole:
                strange.append(len(data))
            time.sleep(0.001)

    reader = threading.Thread(target=look)
    reader.start()
    for _ in range(40 if everything else 6):
        writers = [started(bench, words, folder) for words, _ in (*results.values(), *results.values())]
        for writer in writers:
            fails_well(found, ended(writer), 0, "one of several writers")
        found.check([path.name for path in folder.iterdir()] == ["out.ply"], "several writers left something behind")
    done.set()
    reader.join()
    found.check(not strange, f"a reader saw files of {strange} bytes beside several writers")


def cut_inputs(found, bench, root, everything):
    """Another program cuts an input while it is read: right after the n-th call into the C library."""
    for name, file in (("convert", "mesh.ply"), ("reconstruct", "a.ply"), ("check", "mesh.ply"), ("fluid", "particles.ply")):
        one = runs.COMMANDS[name]
        good = bench.run(one)
        cuts = [("map", call) for call in range(1, good.counts["map"] + 1)]
        cuts += [("alloc", call) for call in runs.spread(good.counts["alloc"], 1000 if everything else 24)]
        cuts += [(kind, 1) for kind in ("read", "close") if good.counts[kind] > 0]

        def cut(rule):
            inputs = pathlib.Path(tempfile.mkdtemp(dir=root))
            shutil.copytree(bench.inputs, inputs, dirs_exist_ok=True)
            fault = {"FAULT_KIND": rule[0], "FAULT_AT": str(rule[1]), "FAULT_MODE": "truncate", "FAULT_FILE": str(inputs / file)}
            result = bench.run(one, fault, inputs=inputs)
            shutil.rmtree(inputs)
            return result

        for rule, result in zip(cuts, runs.in_parallel(cuts, cut)):
            wrong = bench.judge(one, result, good)
            found.check(result.code in (0, INVALID) and not wrong,
                        f"{name} with {file} cut before call {rule[1]} of {rule[0]}: exit code {result.code}, {wrong}")


def spools_of(process):
    """Paths by which files without a name that a process has open are reached."""
    folder = pathlib.Path(f"/proc/{process.pid}/fd")
    spools = []
    try:
        for entry in folder.iterdir():
            if os.readlink(entry).endswith(" (deleted)") and entry.stat().st_size > 0:
                spools.append(entry)
    except OSError:
        pass  # it has just been closed, or the process has ended
    return spools


def cut_spools(found, bench, root, everything):
    """Another program cuts a file of temporary data to half its length while blocks are worked on."""
    one = runs.COMMANDS["reconstruct-blocks"]
    began = time.monotonic()
    good = bench.run(one)
    seconds = time.monotonic() - began
    rounds = 40 if everything else 5
    cuts = 0
    for number in range(rounds):
        folder = pathlib.Path(tempfile.mkdtemp(dir=root))
        with_old_files(one, folder)
        process = started(bench, bench.words(one)[1:], folder)
        time.sleep(seconds * (number + 0.5) / rounds)
        spools = spools_of(process)
        if spools:
            spool = spools[number % len(spools)]
            try:
                os.truncate(spool, spool.stat().st_size // 2)
                cuts += 1
            except OSError:
                pass
        at = time.monotonic()
        result = ended(process)
        story = f"a spool of blocks cut, round {number} of {rounds}"
        if result.code == 0:  # it was not needed any more
            found.check({name: held(folder)[name] for name in one.outputs} == {name: good.files[name] for name in one.outputs},
                        f"{story}: another mesh")
            continue
        fails_well(found, result, NOT_WRITTEN, story)
        found.check(time.monotonic() - at < 10, f"{story}: it took {time.monotonic() - at:.1f} s to end")
        found.check(held(folder) == {name: runs.OLD for name in (*one.outputs, *one.reports)}, f"{story}: left {list(held(folder))}")
    found.check(cuts > 0, "no spool of blocks was met")


def removed_working_folders(found, bench, root, _):
    """Names that are relative lead nowhere."""
    for name, one in WRITERS.items():
        folder = pathlib.Path(tempfile.mkdtemp(dir=root))
        process = started(bench, bench.words(one)[1:], folder, preexec_fn=folder.rmdir)
        fails_well(found, ended(process), NOT_WRITTEN, f"{name} in a removed folder")
    for words in (("edit", "a.ply", "--script", "edits.json", "-o", "/dev/null"), ("convert", "mesh.ply", "/dev/null"),
                  ("bench", "a.ply", "--depths", "4")):
        folder = pathlib.Path(tempfile.mkdtemp(dir=root))
        process = started(bench, words, folder, preexec_fn=folder.rmdir)
        fails_well(found, ended(process), INVALID, f"{words[0]} with inputs in a removed folder")


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("program")
    parser.add_argument("shim")
    parser.add_argument("--long", action="store_true")
    parser.add_argument("--inside", action="store_true", help=argparse.SUPPRESS)
    args = parser.parse_args()
    if not args.inside:
        alone = ["unshare", "--user", "--map-root-user", "--mount"]
        trial = [*alone, "mount", "-t", "tmpfs", "none", "/mnt"]
        if shutil.which("unshare") and subprocess.run(trial, capture_output=True).returncode == 0:
            os.execvp("unshare", [*alone, sys.executable, *sys.argv, "--inside"])
        print("left out: full disks and read-only folders, for nothing may be mounted here")
    tests = [full_devices, full_stdout, closed_pipes, aliased, concurrent_writers, cut_inputs, cut_spools,
             removed_working_folders]
    found = Findings()
    for test in tests + ([full_disks, read_only_folders] if args.inside else []):
        tried, wrong, began = found.tried, found.count, time.monotonic()
        with tempfile.TemporaryDirectory(prefix="pointskin-disks-") as root:
            bench = runs.Bench(args.program, args.shim, root)
            test(found, bench, pathlib.Path(root), args.long)
        print(f"{test.__name__}: {found.tried - tried} checks, {found.count - wrong} findings, {time.monotonic() - began:.0f} s", flush=True)
    return 1 if found.count else 0


if __name__ == "__main__":
    sys.exit(main())
