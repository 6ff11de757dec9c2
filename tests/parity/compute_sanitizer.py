#!/usr/bin/env python3
"""Runs the tests of tests/parity under the four tools of NVIDIA's compute-sanitizer, in parts that end within minutes.

    compute_sanitizer.py build-cuda                                  # everything
    compute_sanitizer.py build-cuda --tools racecheck --tests octree strays
    compute_sanitizer.py build-cuda --total 3000 > lines.txt; compute_sanitizer.py build-cuda --after lines.txt

A part is a few tests of one program under one tool; several run side by side, on all GPUs that there are. Every part has a
line with its time and what it found. The exit code is 1 if a tool found something, a test failed, or a part did not end in
its time.

The programs of tests/parity run but for endurance_gpu_test: it watches the memory of the whole device, forks, and resets the
device, and the tools hold memory of their own and follow one process.
"""
import argparse
import concurrent.futures
import os
import pathlib
import queue
import re
import signal
import subprocess
import sys
import time

# Tests in a part: under the first two one alone may take minutes.
TOOLS = {"racecheck": 1, "initcheck": 1, "synccheck": 8, "memcheck": 16}
SUMMARY = re.compile(r"(?:ERROR|RACECHECK) SUMMARY: (\d+) (?:error|hazard)")
EXCLUDED = {"endurance"}
# Memory of the host that one part may take: racecheck keeps records of every launch, and where memory ends parts are killed.
PART_BYTES = {"racecheck": 26 << 30}


def tests_of(program):
    """Names of the tests of a program of GoogleTest."""
    listed = subprocess.run([program, "--gtest_list_tests"], capture_output=True, text=True, check=True).stdout
    names, suite = [], ""
    for line in listed.splitlines():
        if line.startswith("  "):
            names.append(suite + line.split("#")[0].strip())
        elif line.strip().endswith(".") or "# TypeParam" in line:
            suite = line.split("#")[0].strip()
    return names


def visible_gpus():
    """What CUDA_VISIBLE_DEVICES says, or the numbers of all."""
    said = os.environ.get("CUDA_VISIBLE_DEVICES")
    if said is not None:
        return [name for name in said.split(",") if name]
    listed = subprocess.run(["nvidia-smi", "-L"], capture_output=True, text=True, check=True).stdout
    return [str(i) for i in range(len(listed.splitlines()))]


class Part:
    def __init__(self, tool, program, number, tests, excluded):
        self.tool, self.program, self.tests, self.excluded = tool, program, tests, excluded
        self.name = f"{tool} {program.stem.removesuffix('_gpu_test')} {number}"

    def run(self, logs, limit, gpu):
        """The line of this part, and whether all is well."""
        # Some tests ask for more memory than there is: the refusal that they expect is no error of theirs.
        options = ["--report-api-errors", "no"] if self.tool == "memcheck" else []
        options += [word for name in self.excluded for word in ("--kernel-name-exclude", f"kns={name}")]
        command = ["compute-sanitizer", "--tool", self.tool, *options, str(self.program),
                   "--gtest_filter=" + ":".join(self.tests)]
        log = logs / (self.name.replace(" ", "_") + ".log")
        began = time.monotonic()
        with log.open("w") as out:
            running = subprocess.Popen(command, stdout=out, stderr=subprocess.STDOUT, start_new_session=True,
                                       env=os.environ | {"POINTSKIN_REQUIRE_GPU": "1", "CUDA_VISIBLE_DEVICES": gpu})
            try:
                code = running.wait(limit)
            except subprocess.TimeoutExpired:
                code = None
                os.killpg(running.pid, signal.SIGKILL)  # with the program, which would keep the GPU busy
                running.wait()
        text = log.read_text(errors="replace")
        summary = SUMMARY.findall(text)
        passed = text.count("[       OK ]")
        found = int(summary[-1]) if summary else None
        skipped = len(re.findall(r"^\[  SKIPPED \] .* ms\)$", text, re.MULTILINE))
        well = code == 0 and found == 0 and passed + skipped == len(self.tests)
        said = "did not end" if code is None else f"exit {code}"
        without = f" ({skipped} skipped)" if skipped else ""
        line = (f"{self.name}: {passed} of {len(self.tests)} tests{without}, {time.monotonic() - began:.0f} s, "
                f"{'no summary' if found is None else f'{found} found'}, {said}")
        return line, well


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("build", type=pathlib.Path, help="folder of a build with CUDA")
    parser.add_argument("--tools", nargs="+", choices=TOOLS, default=list(TOOLS))
    parser.add_argument("--tests", nargs="+", metavar="NAME", help="programs, as octree for octree_gpu_test")
    parser.add_argument("--exclude", nargs="+", default=[], metavar="WORD",
                        help="kernels with this in their mangled name are not checked; cub: those of CUB")
    parser.add_argument("--jobs", type=int,
                        help="parts side by side (12 a GPU, at most one a core; of racecheck one per 26 GiB of memory)")
    parser.add_argument("--limit", type=float, default=600, metavar="SECONDS", help="for one part")
    parser.add_argument("--total", type=float, default=float("inf"), metavar="SECONDS",
                        help="parts that have not ended by then are stopped, and those not begun are named")
    parser.add_argument("--after", type=pathlib.Path, metavar="FILE",
                        help="what an earlier run of the same tests has printed: parts that were well are left out")
    parser.add_argument("--logs", type=pathlib.Path, help="default: compute-sanitizer in the build folder")
    given = parser.parse_args()

    programs = [p for p in sorted((given.build / "bin").glob("*_gpu_test"))
                if (name := p.stem.removesuffix("_gpu_test")) not in EXCLUDED
                and (given.tests is None or name in given.tests)]
    if not programs:
        sys.exit(f"no such *_gpu_test in {given.build / 'bin'}")
    logs = given.logs or given.build / "compute-sanitizer"
    logs.mkdir(parents=True, exist_ok=True)

    parts = []
    for tool in given.tools:
        for program in programs:
            tests, few = tests_of(program), TOOLS[tool]
            parts += [Part(tool, program, 1 + i // few, tests[i:i + few], given.exclude)
                      for i in range(0, len(tests), few)]

    if given.after:
        well = set(re.findall(r"^(\w+ \w+ \d+): .* 0 found, exit 0$", given.after.read_text(), re.MULTILINE))
        parts = [part for part in parts if part.name not in well]

    end = time.monotonic() + given.total
    gpus = visible_gpus()
    if not gpus:
        sys.exit("no GPU")
    memory = os.sysconf("SC_PAGE_SIZE") * os.sysconf("SC_PHYS_PAGES")
    jobs = given.jobs or max(1, min(12 * len(gpus), os.cpu_count() or 1,
                                    *(memory // PART_BYTES[tool] for tool in given.tools if tool in PART_BYTES)))
    places = queue.SimpleQueue()  # a GPU for every part that runs
    for i in range(jobs):
        places.put(gpus[i % len(gpus)])

    def judge(part):
        left = end - time.monotonic()
        if left < 1:
            return f"{part.name}: not begun", False
        gpu = places.get()
        try:
            return part.run(logs, min(given.limit, left), gpu)
        finally:
            places.put(gpu)

    ill = 0
    with concurrent.futures.ThreadPoolExecutor(jobs) as pool:
        for done in concurrent.futures.as_completed([pool.submit(judge, part) for part in parts]):
            line, well = done.result()
            ill += not well
            print(("" if well else "NOT WELL: ") + line, flush=True)
    print(f"parts: {len(parts)}, not well: {ill}")
    return 1 if ill else 0


if __name__ == "__main__":
    sys.exit(main())
