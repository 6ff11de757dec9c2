#!/usr/bin/env python3
"""Runs the program on clouds and options at random and judges all that it does: see README.md in this folder."""
import argparse
import json
import math
import os
import pathlib
import random
import re
import shutil
import subprocess
import sys
import tempfile
import threading
import time

import cases
import judge
import meshes
import ply

HERE = pathlib.Path(__file__).resolve().parent
REGRESSIONS = HERE / "regressions"
CODES = {0, 3, 4, 5, 6}  # of a run whose command line is right and whose outputs can be written
UNITS = {"K": 2 ** 10, "M": 2 ** 20, "G": 2 ** 30}
PROGRAM_ALONE = 32 * 2 ** 20  # with the driver of a GPU, before it has read anything
DEVICE_COMMANDS = {"reconstruct", "problems", "boolean", "deform", "edit", "orient", "fluid"}
OCTAHEDRON = "".join(f"{x} {y} {z} {x} {y} {z}\n" for x, y, z in
                     ((1, 0, 0), (-1, 0, 0), (0, 1, 0), (0, -1, 0), (0, 0, 1), (0, 0, -1)))


def has_gpu(program):
    """Whether this program runs on a GPU of this machine."""
    with tempfile.TemporaryDirectory() as folder:
        cloud = pathlib.Path(folder) / "a.xyz"
        cloud.write_text(OCTAHEDRON)
        words = [program, "reconstruct", cloud, "-o", cloud.with_suffix(".ply"), "--depth", "4", "--device", "cuda"]
        return subprocess.run(words, capture_output=True, check=False).returncode == 0


class Runner:
    """Runs cases, each in a folder of its own below a temporary one."""

    def __init__(self, options):
        self.program, self.seconds, self.gpu = str(pathlib.Path(options.program).resolve()), options.seconds, options.gpu
        self.sanitized = options.sanitized
        self.root = pathlib.Path(tempfile.mkdtemp(prefix="pointskin-campaign-"))
        self.launcher = subprocess.Popen([sys.executable, "-S", "-E", str(HERE / "launcher.py")], text=True,
                                         stdin=subprocess.PIPE, stdout=subprocess.PIPE)

    def close(self):
        self.launcher.stdin.close()
        self.launcher.wait()
        shutil.rmtree(self.root, ignore_errors=True)

    def run(self, arguments, inputs):
        """What the launcher says, and `files`, `out` and `err`: all that is in the folder afterwards."""
        folder = self.root / "run"
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir()
        for name, data in inputs.items():
            (folder / name).write_bytes(data)
        streams = {name: str(self.root / name) for name in ("stdout", "stderr")}
        request = {"arguments": [self.program, *arguments], "folder": str(folder), "seconds": self.seconds, **streams}
        self.launcher.stdin.write(json.dumps(request) + "\n")
        self.launcher.stdin.flush()
        result = json.loads(self.launcher.stdout.readline())
        result["files"] = {str(p.relative_to(folder)): p.read_bytes() for p in folder.rglob("*") if p.is_file()}
        result["out"] = pathlib.Path(streams["stdout"]).read_bytes()
        result["err"] = pathlib.Path(streams["stderr"]).read_bytes().decode("utf-8", "surrogateescape")
        return result


def expected_codes(case):
    if case.codes:
        return set(case.codes)
    if case.beyond:
        return {2}
    expected = {0} if case.solid else CODES
    # Which operations of a script may follow each other is not said anywhere but in the error.
    refused = case.command() == "edit" or any(case.has(a) and case.has(b) for a, b in cases.REFUSED)
    return expected | {2} if refused else expected


def new_files(case, result):
    return {name: data for name, data in result["files"].items() if name not in case.inputs}


def named(case, name):
    """Whether an option names this file, also as a frame of a sequence."""
    return any(name == out or "{}" in out and name.startswith(out.split("{}")[0]) and name.endswith(out.split("{}")[1])
               and name[len(out.split("{}")[0]):-len(out.split("{}")[1])].isdigit()
               for out in case.outputs() + (["points.ply"] if case.command() == "convert" else []))


def judge_run(case, result, sanitized):
    """Exit code, messages, files and memory; then each file by itself."""
    code, made = result["code"], new_files(case, result)
    if result["late"]:
        return ["the time limit was passed"]
    if code == 2 and case.has("--max-memory") and "in blocks" in result["err"]:
        expected = {2}  # what the whole has no memory for, and blocks do not know yet
    else:
        expected = expected_codes(case)
    if code not in expected:
        return [f"exit code {code}, expected one of {sorted(expected)}: {result['err'].strip()[-300:]}"]
    wrong = judge.messages(code, result["err"], case.command() == "check" and code == 5)
    wrong += [f"the input {name} has changed" for name, data in case.inputs.items() if result["files"].get(name) != data]
    wrong += [f"the file {name} was left behind" for name in made if not named(case, name)]
    frames = any("{}" in out for out in case.outputs())
    if code and not frames and made:
        wrong.append(f"exit code {code}, but {', '.join(made)} was written")
    if code == 0 and not frames and not case.has("--dry-run"):
        wrong += [f"{name} was not written" for name in case.outputs() if name not in made]
    if code == 0 and frames and sum(name.startswith("mesh_") for name in made) != int(case.value("--frames")):
        wrong.append("another number of frames was written than asked for")
    if case.has("--dry-run") and made:
        wrong.append("a dry run has written files")
    wrong += [] if sanitized else judge_memory(case, result)
    for name, data in made.items():
        wrong += [f"{name}: {what}" for what in judge_file(case, name, data, result["err"])]
    return wrong + judge_answer(case, result)


def judge_memory(case, result):
    """--max-memory is what the process may take; a fiftieth above it, or 1 MiB, is let pass."""
    text = case.value("--max-memory")
    if not text or text[-1] not in UNITS or case.command() == "fluid" or result["code"] in (2, 6):
        return []
    limit = int(text[:-1]) * UNITS[text[-1]]
    if result["code"] and limit < PROGRAM_ALONE:  # it ended over its input before memory was asked for
        return []
    allowed = max(limit * 1.02, limit + 2 ** 20)
    return [f"{result['peak']} bytes were taken with --max-memory {text}"] if result["peak"] > allowed else []


def judge_file(case, name, data, said):
    """@param said  stderr: where it warns of coarse coordinates, a thin body may be flat."""
    if name.endswith(".json"):
        return judge_json(data)
    if name.endswith(".png"):
        return judge.png(data)
    if name.endswith((".stl", ".glb")):
        return meshes.stl(data) if name.endswith(".stl") else meshes.glb(data)
    read = {".obj": meshes.read_obj, ".off": meshes.read_off}.get(name[-4:], ply.read)
    try:
        found = read(data)
    except (ply.Malformed, ValueError, KeyError, IndexError) as problem:
        return [f"is no whole file of its format: {problem}"]
    if name.startswith("mesh"):
        opened = case.has("--trim", "--open")
        positive = not case.has("--largest", "--min-component") and "as float32 relative to" not in said
        wrong = judge.mesh(found, not opened, positive)
    else:
        wrong = judge_points(case, found)
    # Points that a script adds have no values of the properties that only the others have.
    added = case.command() == "edit" and not name.startswith("mesh")
    return wrong + ([] if added else judge.attributes(found, doubtful(case, name.startswith("mesh"))))


def judge_points(case, found):
    """Points that a command writes: finite, but for those of `convert` and `compare`, which write what they read."""
    if case.command() in ("convert", "compare"):
        return []
    wrong = [] if all(math.isfinite(v) for a in "xyz" for v in found.columns[a]) else ["points are not finite"]
    if case.command() == "orient":
        wrong += judge_oriented(ply.read(case.inputs["a.ply"]), found)
        finite = sum(all(abs(c) <= 1e38 for c in p) for p in ply.read(case.inputs["a.ply"]).rows("x", "y", "z"))
        if finite != found.count():
            wrong.append(f"{found.count()} points of {finite} finite ones")
        if not all(0 <= c <= 1 for c in found.columns.get("confidence", ())):
            wrong.append("a confidence is not between 0 and 1")
    return wrong


def judge_oriented(given, found):
    """Normals that stay keep their bytes, but for the sign; those that are made have unit length."""
    kept = set()
    if "nx" in given.columns:
        kept = {n for row in given.rows("nx", "ny", "nz") for n in (row, tuple(-c for c in row)) if any(row)}
    made = [n for n in found.rows("nx", "ny", "nz") if n not in kept]
    bad = sum(not abs(math.sqrt(sum(c * c for c in n)) - 1) < 1e-4 for n in made)
    return [f"{bad} normals are neither given nor of unit length"] if bad else []


def doubtful(case, is_mesh):
    """Properties that the input itself has with values that are not finite, and that what is written may have, too.

    A mesh that is made of points has only finite ones.
    """
    if is_mesh and case.command() not in ("fluid", "compare", "convert"):
        return set()
    names = set()
    for found in (ply.read(case.inputs[cloud]) for cloud in case.points):
        bad = {n for n, column in found.columns.items() if not all(map(math.isfinite, column))}
        names |= bad | {f"input_{n}" for n in bad}
        if bad & {"x", "y", "z"} and case.command() in ("compare", "convert"):
            names |= {"distance", "signed_distance"}
    return names


def judge_json(data):
    try:
        json.loads(data, parse_constant=lambda word: 1 / 0)
    except ValueError as problem:
        return [f"is no JSON: {problem}"]
    except ZeroDivisionError:
        return ["has numbers that are not finite"]
    return []


def judge_answer(case, result):
    """What is printed with --json, and the verdict of `check`."""
    if not case.has("--json") or result["code"] not in (0, 5) or not result["out"]:
        return []
    wrong = [f"stdout {what}" for what in judge_json(result["out"])]
    if case.command() != "check" or wrong:
        return wrong
    found, answer = ply.read(case.inputs["a.ply"]), json.loads(result["out"])
    topology = judge.Topology(found.triangles, found.count())
    enclosed = judge.volume(found.rows("x", "y", "z"), found.triangles)
    watertight = topology.watertight_but_for_volume() and enclosed > 0
    for key, value in (("watertight", watertight), ("degenerate_triangles", topology.degenerate),
                       ("non_manifold_edges", topology.crowded), ("boundary_edges", topology.boundary)):
        if answer[key] != value and not (topology.degenerate and key != "degenerate_triangles" and key != "watertight"):
            wrong.append(f"check says {key} {answer[key]}, it is {value}")
    if result["code"] == 0 and not watertight or result["code"] == 5 and watertight and not case.has("--self-intersections"):
        wrong.append(f"check ends with {result['code']}, watertight is {watertight}")
    return wrong


def shuffled(case):
    """The case with the points of its clouds in another order, where the order must not matter."""
    inputs = dict(case.inputs)
    for name in case.points:
        found = ply.read(inputs[name])
        names = list(found.columns)
        rows = found.rows(*names)
        random.Random(case.compare[1]).shuffle(rows)
        inputs[name] = ply.write([[n, found.types[n]] for n in names], rows, found.form)
    return inputs


def on(device, case, runner):
    """The option that runs a case on a device, where there is a choice."""
    return ["--device", device] if runner.gpu and case.command() in DEVICE_COMMANDS and not case.has("--device") else []


def judge_again(case, runner, first):
    """The same with another number of threads, of a mesh another order of the points, and after a GPU on the CPU: the
    same bytes."""
    arguments = [g for g in case.arguments if g[0] != "--threads"] + [["--threads", str(case.compare[0])]]
    meshes = [name for name in new_files(case, first) if name.startswith("mesh")]
    inputs = shuffled(case) if meshes and not case.has("--random-start", "--max-memory") else case.inputs
    second = runner.run([word for group in arguments for word in group] + on("cpu", case, runner), inputs)
    if first["code"] == second["code"] == 6 or case.has("--max-memory"):
        return []
    how = f"{case.compare[0]} threads" + (" and another order" if inputs is not case.inputs else "")
    how += " on the CPU" if on("cpu", case, runner) else ""
    if second["code"] != first["code"]:
        return [f"exit code {second['code']} with {how}: {second['err'].strip()[-300:]}"]
    compared = meshes if inputs is not case.inputs else [n for n in new_files(case, first) if not n.endswith(".json")]
    wrong = [f"{n} has other bytes with {how}" for n in compared if second["files"].get(n) != first["files"][n]]
    if inputs is case.inputs and case.has("--json") and second["out"] != first["out"]:
        wrong.append(f"the answer differs with {how}")
    return wrong


def judge_in_blocks(case, runner, whole):
    """The same with less memory than the whole took: where work goes on in blocks, the same bytes."""
    if whole["code"] or "contradict each other" in whole["err"]:  # normals are not repaired in blocks
        return []
    limit = str(int(case.share * whole["peak"]))
    blocks = runner.run(case.words() + ["--max-memory", limit] + on("cpu", case, runner), case.inputs)
    refused = blocks["code"] == 2 and "in blocks" in blocks["err"]
    if blocks["code"] not in (0, 6) and not refused:
        return [f"exit code {blocks['code']} with --max-memory {limit}: {blocks['err'].strip()[-300:]}"]
    if blocks["code"]:
        return [f"{n} was written with --max-memory {limit}, exit code {blocks['code']}" for n in new_files(case, blocks)]
    wrong = [f"{n} has other bytes with --max-memory {limit}" for n in new_files(case, whole)
             if blocks["files"].get(n) != whole["files"][n]]
    allowed = max(int(limit) * 1.05, int(limit) + 2 ** 21)
    wrong += [f"{blocks['peak']} bytes were taken with --max-memory {limit}"] if blocks["peak"] > allowed else []
    return wrong


def judge_case(case, runner):
    # What a process may take is measured on the CPU: a driver takes more than small limits allow.
    on_cpu = case.has("--max-memory") or case.share
    first = runner.run(case.words() + on("cpu" if on_cpu else "cuda", case, runner), case.inputs)
    wrong = judge_run(case, first, runner.sanitized)
    if wrong or first["code"] == 2:
        return wrong
    if case.share and not runner.sanitized:
        return judge_in_blocks(case, runner, first)
    return judge_again(case, runner, first)


def kind(wrong):
    """What is wrong, without numbers: a shrunk case must fail in the same way."""
    return "".join(c for c in wrong[0].split(": ", 2)[-1 if wrong[0].startswith("mesh") else 0] if c.isalpha())


def shrink(case, wrong, runner, seconds):
    """Drops options and halves clouds as long as the case fails in the same way."""
    end, what, text = time.monotonic() + seconds, kind(wrong), case.to_json()
    changed = True
    while changed and time.monotonic() < end:
        changed = False
        for smaller in smaller_cases(text):
            if time.monotonic() > end:
                break
            found = judge_case(smaller, runner)
            if found and kind(found) == what:
                text, changed = smaller.to_json(), True
                break
    return cases.Case.from_json(text)


def smaller_cases(text):
    case = cases.Case.from_json(text)
    for k in range(len(case.arguments) - 1, case.fixed - 1, -1):
        if case.beyond:  # what must be refused stays
            break
        smaller = cases.Case.from_json(text)
        smaller.arguments.pop(k)
        yield smaller
    for name in case.points:
        found = ply.read(case.inputs[name])
        names, rows = list(found.columns), found.rows(*found.columns)
        for parts in (2, 4, 8):
            for k in range(parts if len(rows) >= parts else 0):
                kept = rows[len(rows) * k // parts:len(rows) * (k + 1) // parts]
                smaller = cases.Case.from_json(text)
                smaller.solid = False
                rest = kept if parts == 2 else [row for row in rows if row not in set(kept)]
                if 0 < len(rest) < len(rows):
                    smaller.inputs[name] = ply.write([[n, found.types[n]] for n in names], rest, found.form)
                    yield smaller


class Campaign:
    """Workers that take numbers of cases in turn until the time is up."""

    def __init__(self, options):
        self.options, self.lock = options, threading.Lock()
        self.next, self.done, self.failed, self.codes = options.first, 0, [], {}
        self.end = time.monotonic() + 60 * options.minutes

    def take(self):
        with self.lock:
            past = time.monotonic() > self.end or self.options.cases and self.next - self.options.first >= self.options.cases
            self.next += 0 if past else 1
            return None if past else self.next - 1

    def work(self):
        runner = Runner(self.options)
        try:
            while (number := self.take()) is not None:
                case = cases.random_case(self.options.seed, number)
                wrong = judge_case(case, runner)
                with self.lock:
                    self.done += 1
                    self.codes[case.command()] = self.codes.get(case.command(), 0) + 1
                if wrong:
                    self.keep(case, number, wrong, runner)
        except Exception as problem:  # a campaign whose worker ended must not pass
            with self.lock:
                self.failed.append(f"worker: {problem!r}")
            raise
        finally:
            runner.close()

    def keep(self, case, number, wrong, runner):
        if not self.options.no_shrink:
            case = shrink(case, wrong, runner, self.options.shrink_seconds)
        case.shows = wrong[0]
        path = pathlib.Path(self.options.keep) / f"found_{self.options.seed}_{number}.json"
        path.parent.mkdir(parents=True, exist_ok=True)
        path.write_text(case.to_json())
        with self.lock:
            self.failed.append(str(path))
            print(f"case {number}: {'; '.join(wrong)}\n  pointskin {' '.join(case.words())}\n  {path}", flush=True)

    def run(self):
        workers = [threading.Thread(target=self.work) for _ in range(self.options.jobs)]
        for worker in workers:
            worker.start()
        for worker in workers:
            worker.join()


def run_regressions(options, paths):
    runner, failed = Runner(options), []
    for path in paths:
        case = cases.Case.from_json(pathlib.Path(path).read_text())
        wrong = judge_case(case, runner)
        if wrong:
            failed.append(str(path))
            print(f"{path}: {'; '.join(wrong)}\n  {case.shows}\n  pointskin {' '.join(case.words())}", flush=True)
    runner.close()
    return failed


def unpack(options):
    """Writes the inputs of a case beside each other and prints the command."""
    case = cases.Case.from_json(pathlib.Path(options.cases_given[0]).read_text())
    pathlib.Path(options.unpack).mkdir(parents=True, exist_ok=True)
    for name, data in case.inputs.items():
        (pathlib.Path(options.unpack) / name).write_bytes(data)
    print(f"cd {options.unpack} && {options.program} {' '.join(case.words())}")


def main():
    parser = argparse.ArgumentParser(description=__doc__)
    parser.add_argument("cases_given", nargs="*", metavar="CASE.json", help="judge these files alone")
    parser.add_argument("--program", default=str(HERE.parents[1] / "build/bin/pointskin"))
    parser.add_argument("--minutes", type=float, default=3)
    parser.add_argument("--seed", default=None, help="default: another one every time, which is printed")
    parser.add_argument("--first", type=int, default=0, help="number of the first case")
    parser.add_argument("--cases", type=int, default=0, help="at most so many")
    parser.add_argument("--jobs", type=int, default=len(os.sched_getaffinity(0)))
    parser.add_argument("--seconds", type=float, default=120, help="time limit of one run")
    parser.add_argument("--sanitized", action="store_true",
                        help="the program is built with a sanitizer, whose memory counts as the program's: memory is not judged")
    parser.add_argument("--shrink-seconds", type=float, default=60)
    parser.add_argument("--no-shrink", action="store_true")
    parser.add_argument("--keep", default=str(REGRESSIONS), help="folder for cases that fail")
    parser.add_argument("--unpack", metavar="DIR", help="write the inputs of CASE.json there and print its command")
    options = parser.parse_args()
    if not os.access(options.program, os.X_OK):
        parser.error(f"no program at {options.program}; build it, or name it with --program")
    if options.unpack:
        return unpack(options)
    options.gpu = has_gpu(options.program)
    known = options.cases_given or sorted(REGRESSIONS.glob("*.json"))
    begin = time.monotonic()
    failed = run_regressions(options, known)
    print(f"regressions: {len(known)}, failed {len(failed)}, {time.monotonic() - begin:.0f} s", flush=True)
    if options.cases_given:
        return 1 if failed else 0
    options.seed = options.seed or str(random.SystemRandom().randrange(10 ** 6))
    campaign = Campaign(options)
    begin = time.monotonic()
    campaign.run()
    minutes = (time.monotonic() - begin) / 60
    counts = ", ".join(f"{name} {n}" for name, n in sorted(campaign.codes.items()))
    print(f"seed {options.seed}: {campaign.done} cases in {minutes:.1f} minutes ({campaign.done / max(minutes, 1e-9):.0f} "
          f"a minute), failed {len(campaign.failed)}; {counts}")
    return 1 if failed or campaign.failed or not campaign.done else 0


if __name__ == "__main__":
    sys.exit(main())
