"""What the fault tests share: small inputs, a small run of every command, and what must hold after a run that went wrong."""
import collections
import concurrent.futures
import json
import math
import os
import pathlib
import re
import shutil
import struct
import subprocess
import tempfile
import time

KINDS = ("alloc", "map", "thread", "open", "read", "write", "sync", "rename", "close", "stat", "mode")
DRIVER_KINDS = ("device-alloc", "pinned", "launch", "copy", "wait")
ALL_KINDS = (*KINDS, *DRIVER_KINDS)
OLD = b"the old file\n"
EXIT_CODES = {0, 2, 3, 4, 5, 6, 7, 8, 130}  # 1, an internal error, would be a bug
NO_DEVICE = 7
TIMES_OUT_AFTER_S = 120
WRITTEN_BEFORE = re.compile(r"interrupted; (\d+) files? w(?:as|ere) written before")
TEMPORARY = re.compile(r"\.(?P<output>.+)\.\d+-[0-9a-f]{16}\.tmp")


def sphere(points, centre=0.0):
    """Points of a unit sphere on a spiral, with normals."""
    for i in range(points):
        z = 1 - (2 * i + 1) / points
        radius, angle = math.sqrt(1 - z * z), i * math.pi * (3 - math.sqrt(5))
        x, y = radius * math.cos(angle), radius * math.sin(angle)
        yield (x + centre, y, z, x, y, z)


def ply(rows, names):
    rows = list(rows)
    header = [f"ply\nformat binary_little_endian 1.0\nelement vertex {len(rows)}", *(f"property float {n}" for n in names)]
    return "\n".join([*header, "end_header\n"]).encode() + b"".join(struct.pack(f"<{len(names)}f", *row) for row in rows)


NORMALS = ("x", "y", "z", "nx", "ny", "nz")
BEND = {"handles": [
    {"region": {"half_space": {"point": [-0.5, 0, 0], "normal": [-1, 0, 0]}}},
    {"region": {"half_space": {"point": [0.5, 0, 0], "normal": [1, 0, 0]}},
     "rigid": {"axis": [0, 0, 1], "point": [0, 1.5, 0], "degrees": 30}}]}
EDITS = {"version": 1, "operations": [
    {"op": "guide", "camera": {"azimuth": 0}, "stroke": [[600, 500], [604, 400]], "normals": "stroke", "inside_only": False},
    {"op": "insert", "file": "b.ply", "translation": [0.2, 0, 0]}, {"op": "undo"}]}


def make_inputs(program, folder):
    """Writes a cloud, another, one as text without normals, particles, scripts and a mesh into `folder`."""
    (folder / "a.ply").write_bytes(ply(sphere(600), NORMALS))
    (folder / "b.ply").write_bytes(ply(sphere(600, 0.7), NORMALS))
    (folder / "c.ply").write_bytes(ply(sphere(500), NORMALS))
    (folder / "d.ply").write_bytes(ply(sphere(400), NORMALS))
    (folder / "open.ply").write_bytes(ply((row for row in sphere(3000) if row[2] < 0.5), NORMALS))
    (folder / "bare.xyz").write_text("".join("%.6f %.6f %.6f\n" % row[:3] for row in sphere(400)))
    grid = ((float(x), float(y), float(z)) for x in range(6) for y in range(6) for z in range(6))
    (folder / "particles.ply").write_bytes(ply(grid, NORMALS[:3]))
    (folder / "bend.json").write_text(json.dumps(BEND))
    (folder / "edits.json").write_text(json.dumps(EDITS))
    subprocess.run([program, "reconstruct", folder / "a.ply", "-o", folder / "mesh.ply", "--depth", "4", "-q"], check=True)


# A word with "@" is a file of the inputs; `outputs` are compared by their bytes, `reports`, which hold times, are to be
# whole. In a `sequence` an interrupt leaves the frames before.
# `at_once` outputs are written at a time. What is `slow` is tried less often where not every call is.
Command = collections.namedtuple("Command", "words outputs reports sequence printed at_once slow",
                                 defaults=((), (), False, True, 1, False))


def command(words, outputs="", reports="", **more):
    return Command(tuple(words.split()), tuple(outputs.split()), tuple(reports.split()), **more)


COMMANDS = {
    "reconstruct": command("reconstruct @a.ply -o out.ply --report report.json --depth 4 --threads 2", "out.ply", "report.json"),
    "reconstruct-stdout": command("reconstruct @a.ply -o - --depth 4 --threads 2 -q"),
    "reconstruct-each": command(
        "reconstruct @a.ply @b.ply @c.ply @d.ply --each -o out_{}.ply --report r_{}.json --depth 4 --threads 2",
        "out_a.ply out_b.ply out_c.ply out_d.ply", "r_a.json r_b.json r_c.json r_d.json", at_once=2),
    "reconstruct-blocks": command(  # some 8 blocks, cut where the samples end
        "reconstruct @open.ply -o out.ply --report report.json --depth 8 --iterations 1 --trim 0.05 --density --max-memory 40M --temp . --threads 2",
        "out.ply", "report.json", slow=True),
    "orient": command("orient @bare.xyz -o out.ply --threads 2", "out.ply"),
    "boolean": command("boolean @a.ply @b.ply --op union -o out.obj --cloud points.ply --depth 4 --threads 2", "out.obj points.ply"),
    "edit": command("edit @a.ply --script @edits.json -o out.ply --save saved.json --report report.json --depth 4 --threads 2",
                    "out.ply", "saved.json report.json"),
    "deform": command("deform @a.ply --script @bend.json -o out.stl --cloud points.ply --depth 4 --threads 2", "out.stl points.ply"),
    "fluid": command("fluid @particles.ply -r 0.5 -o out.off --report report.json --threads 2", "out.off", "report.json"),
    "fluid-simulate": command(
        "fluid --simulate drop --frames 3 --particles 300 -o out_{}.ply --particles-out p_{}.ply --report report.json --threads 2",
        "out_0.ply out_1.ply out_2.ply p_0.ply p_1.ply p_2.ply", "report.json", sequence=True),
    "convert": command("convert @mesh.ply out.obj --threads 2", "out.obj"),
    "convert-glb": command("convert @mesh.ply out.glb --compress --threads 2", "out.glb"),
    "convert-3mf": command("convert @mesh.ply out.3mf --threads 2", "out.3mf"),
    "convert-npz": command("convert @mesh.ply out.npz --threads 2", "out.npz"),
    "convert-cloud": command("convert @bare.xyz out.ply --ascii --threads 2", "out.ply"),
    "check": command("check @mesh.ply --self-intersections --json --threads 2"),
    "compare": command("compare @mesh.ply @a.ply --samples 1000 --heat heat.ply --json --threads 2", "heat.ply"),
    "render": command("render @mesh.ply -o out.png --size 80x60 --threads 2 -q", "out.png"),
    "problems": command("problems @a.ply -o out.ply --report report.json --depth 4 --threads 2", "out.ply", "report.json"),
    "info": command("info @mesh.ply --json --threads 2"),
    "formats": command("formats"),
    "help": command("help reconstruct"),
    "manual": command("manual"),
    "completion": command("completion bash"),
    "bench": command("bench --generate sphere:500 --depths 4 --repeat 1 --devices cpu --threads 2 --report report.json --plot out.svg -q",
                     "", "report.json out.svg", printed=False),
}

Result = collections.namedtuple("Result", "code out err files counts failed has_handler seconds")


class Bench:
    """Runs the program in folders of its own, preloaded with the library that injects faults."""

    def __init__(self, program, shim, root):
        self.program, self.shim = str(pathlib.Path(program).resolve()), str(pathlib.Path(shim).resolve())
        self.root = pathlib.Path(root)
        self.inputs = self.root / "inputs"
        self.inputs.mkdir()
        make_inputs(self.program, self.inputs)

    def words(self, one):
        return [self.program, *(word.replace("@", f"{self.inputs}/") for word in one.words)]

    def run(self, one, fault=None, signal=None, inputs=None):
        """@param signal  a function that is called with the process and the file of counts, and sends something"""
        folder = pathlib.Path(tempfile.mkdtemp(dir=self.root))
        try:
            for name in (*one.outputs, *one.reports):
                (folder / name).write_bytes(OLD)
            state = pathlib.Path(f"{folder}.state")
            state.write_bytes(bytes(8 * (len(ALL_KINDS) + 2)))
            environment = dict(os.environ, LC_ALL="C", LD_PRELOAD=self.shim, FAULT_STATE=str(state), **(fault or {}))
            began = time.monotonic()
            words = [word.replace(str(self.inputs), str(inputs)) for word in self.words(one)] if inputs else self.words(one)
            process = subprocess.Popen(words, cwd=folder, env=environment, stdin=subprocess.DEVNULL,
                                       stdout=subprocess.PIPE, stderr=subprocess.PIPE)
            try:
                if signal is not None:
                    signal(process, state)
                out, err = process.communicate(timeout=TIMES_OUT_AFTER_S)
                code = process.returncode
            except subprocess.TimeoutExpired:
                process.kill()
                out, err = process.communicate()
                code = "no end"
            seconds = time.monotonic() - began
            numbers = struct.unpack(f"<{len(ALL_KINDS) + 2}Q", state.read_bytes())
            files = {path.name: path.read_bytes() for path in folder.iterdir()}
            if inputs:
                out = out.replace(str(inputs).encode(), str(self.inputs).encode())
            return Result(code, out, err.decode(errors="replace"), files, dict(zip(ALL_KINDS, numbers)), numbers[-2],
                          numbers[-1] != 0, seconds)
        finally:
            shutil.rmtree(folder, ignore_errors=True)
            pathlib.Path(f"{folder}.state").unlink(missing_ok=True)

    def judge(self, one, result, good, killed=False):
        """@param good  the same run without a fault @returns what is wrong, a sentence each"""
        wrong = []
        if not killed:
            wrong += judge_end(result)
        known = {*one.outputs, *one.reports}
        left = sorted(result.files.keys() - known)
        temporaries = [name for name in left if (match := TEMPORARY.fullmatch(name)) and match["output"] in known]
        if killed and len(temporaries) <= one.at_once:
            left = [name for name in left if name not in temporaries]
        if left:
            wrong.append(f"left behind: {', '.join(left)}")
        for name in sorted(known):
            wrong += judge_file(name, name in one.reports, result, good)
        if result.code == 0 and one.printed and result.out != good.out:
            wrong.append("stdout is not what it is without the fault")
        if result.code == 130 and not one.sequence:
            told = WRITTEN_BEFORE.search(result.err)
            written = sum(result.files.get(name) != OLD for name in known)
            if written != (int(told[1]) if told else 0):
                wrong.append("does not say how many files were written")
        return wrong


def judge_end(result):
    """The exit code and what was said."""
    if result.code not in EXIT_CODES:
        return [f"ended with {result.code}: {' '.join(result.err.splitlines()[-2:])[-200:]}"]
    lines = result.err.splitlines()
    errors = [line for line in lines if line.startswith("pointskin: ") and not line.startswith("pointskin: warning:")]
    if result.code == 0 and errors:
        return [f"success, and an error: {errors}"]
    if result.code != 0 and (len(errors) != 1 or lines[-1] != errors[0]):
        return [f"exit code {result.code}, and not one line of error at the end: {result.err[-300:]!r}"]
    return []


def judge_file(name, is_report, result, good):
    """It is as it was, or as a run without a fault makes it."""
    held = result.files.get(name)
    if held is None:
        return [f"{name} is gone"]
    if result.code == 0 and held == OLD:
        return [f"success, and {name} was not written"]
    if held == OLD:
        return []
    if is_report and name.endswith(".svg"):
        return [] if held.rstrip().endswith(b"</svg>") else [f"{name} is no whole SVG"]
    if is_report:
        try:
            json.loads(held)
            return []
        except ValueError:
            return [f"{name} is no JSON"]
    return [] if held == good.files[name] else [f"{name} is neither the old file nor the new one, {len(held)} bytes"]


def spread(count, most):
    """At most `most` of 1..count, evenly spread, with both ends."""
    if count <= most:
        return list(range(1, count + 1))
    return sorted({1 + round(i * (count - 1) / (most - 1)) for i in range(most)})


def in_parallel(jobs, work):
    """Runs work(job) for all jobs, as many at a time as there are processors."""
    with concurrent.futures.ThreadPoolExecutor(max(2, os.cpu_count() or 2)) as pool:
        return list(pool.map(work, jobs))


# Commands that take --device; `bench` names devices in its own way.
ON_DEVICES = ("reconstruct", "reconstruct-stdout", "reconstruct-each", "reconstruct-blocks", "orient", "boolean", "edit", "deform",
              "fluid", "fluid-simulate", "problems")
# A limit is for the memory of the device there: too little for the whole, enough for some four blocks.
LIMIT_ON_DEVICES = {"reconstruct-blocks": "25M"}


def on_device(commands, device):
    """Those of `commands` that take --device, with it."""
    def words(name, one):
        limit = LIMIT_ON_DEVICES.get(name)
        limited = [limit if before == "--max-memory" and limit else word for before, word in zip(("", *one.words), one.words)]
        return (*limited, "--device", device)
    return {name: one._replace(words=words(name, one)) for name, one in commands.items() if name in ON_DEVICES}


def chosen(names):
    """The commands of these names, or all."""
    unknown = set(names or ()) - COMMANDS.keys()
    if unknown:
        raise SystemExit(f"no such commands: {', '.join(sorted(unknown))}")
    return {name: COMMANDS[name] for name in names or COMMANDS}
