#!/usr/bin/env python3
"""The table of docs/scale.md: clouds reconstructed within limits of memory, beside what `--dry-run` said, and in memory.

    bench/out_of_core.py CLOUD.ply:DEPTH ... --bin build/bin [--limits 1G,2G] [--device cpu] [--temp DIR] [--no-whole]

Reconstructs each cloud in memory, unless --no-whole, and within each limit, and prints a row for each run: blocks, the peak of the
process (of a GPU the buffers there), what was read and written by calls of the system, what the disk held at most with the mesh, and
the wall clock. Numbers in brackets are the estimates. All meshes of a cloud must have one sha256: else the exit code is 1; 2 on usage.
"""
import argparse
import hashlib
import json
import os
import pathlib
import re
import subprocess
import sys
import tempfile
import threading
import time

COLUMNS = ("points", "depth", "limit", "blocks", "peak", "read", "written", "disk", "time")


def sha256(path):
    digest = hashlib.sha256()
    with open(path, "rb") as file:
        while part := file.read(1 << 24):
            digest.update(part)
    return digest.hexdigest()


def gib(size):
    return f"{size / 2**30:.2f} GiB"


class Watch(threading.Thread):
    """Looks at a process while it runs: bytes through the system, and what the disk of a folder holds more than before."""

    def __init__(self, pid, folder):
        super().__init__()
        self.pid, self.folder, self.read, self.written = pid, folder, 0, 0
        self.before = self.most = self.used()
        self.ended = threading.Event()

    def used(self):
        disk = os.statvfs(self.folder)
        return (disk.f_blocks - disk.f_bfree) * disk.f_frsize

    def run(self):
        while not self.ended.wait(0.05):
            self.most = max(self.most, self.used())
            try:
                told = pathlib.Path(f"/proc/{self.pid}/io").read_text()
            except OSError:
                continue
            found = dict(line.split(": ") for line in told.splitlines())
            self.read, self.written = int(found.get("rchar", 0)), int(found.get("wchar", 0))


def run(program, cloud, depth, device, temp, folder, limit):
    """One run: its numbers, and the mesh's sha256."""
    mesh, report = folder / "mesh.ply", folder / "report.json"
    words = [program, "reconstruct", cloud, "-o", mesh, "--overwrite", "-q", "--device", device, "--depth", str(depth)]
    if limit:
        words += ["--max-memory", limit, "--temp", temp]
    mesh.unlink(missing_ok=True)
    begin = time.monotonic()
    child = subprocess.Popen(words)
    watch = Watch(child.pid, temp)
    watch.start()
    _, status, usage = os.wait4(child.pid, 0)
    seconds = time.monotonic() - begin
    watch.ended.set()
    watch.join()
    if status != 0:
        sys.exit(f"{' '.join(map(str, words))}: exit code {os.waitstatus_to_exitcode(status)}")
    row = {"seconds": seconds, "peak": 1024 * usage.ru_maxrss, "read": watch.read, "written": watch.written,
           "disk": watch.most - watch.before, "mesh": mesh.stat().st_size}
    if device != "cpu":  # the limit is for the GPU; a report costs time
        subprocess.run([*words, "--report", report], check=True)
        row["peak"] = json.loads(report.read_text())["memory"]["device_peak_bytes"]
    return row, sha256(mesh)


def planned(program, cloud, depth, device, temp, limit):
    """What --dry-run says of a run within a limit."""
    told = subprocess.run([program, "reconstruct", cloud, "--dry-run", "--device", device, "--depth", str(depth), "--max-memory", limit,
                           "--temp", temp], check=True, capture_output=True, text=True).stdout.splitlines()[-1]
    found = re.search(r"in (\d+) blocks?, .*estimate .*?\((\d+) bytes\), temporary data .*?\((\d+) bytes\)", told)
    return tuple(map(int, found.groups())) if found else None


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("clouds", nargs="+", help="CLOUD.ply:DEPTH")
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--limits", default="1G", help="of memory, with commas between")
    parser.add_argument("--device", default="cpu")
    parser.add_argument("--temp", type=pathlib.Path, default=pathlib.Path(tempfile.gettempdir()))
    parser.add_argument("--no-whole", action="store_true", help="not in memory")
    args = parser.parse_args()
    program = args.bin / "pointskin"
    all_same = True
    print("| " + " | ".join(COLUMNS) + " |\n|" + "---|" * len(COLUMNS))
    for named in args.clouds:
        cloud, _, depth = named.rpartition(":")
        if not cloud or not depth.isdigit():
            parser.error(f"{named}: not CLOUD.ply:DEPTH")
        shas = set()
        points = re.search(rb"element vertex (\d+)", pathlib.Path(cloud).open("rb").read(4096))
        for limit in ([] if args.no_whole else [None]) + args.limits.split(","):
            with tempfile.TemporaryDirectory(dir=args.temp) as folder:
                plan = planned(program, cloud, depth, args.device, args.temp, limit) if limit else None
                row, sha = run(program, cloud, depth, args.device, args.temp, pathlib.Path(folder), limit)
            shas.add(sha)
            estimates = [f" ({gib(size)})" for size in (plan[1], plan[2] + row["mesh"])] if plan else ["", ""]
            print(f"| {points.group(1).decode() if points else '?'} | {depth} | {limit or 'none'} | {plan[0] if plan else 'whole'} "
                  f"| {gib(row['peak'])}{estimates[0]} | {gib(row['read'])} | {gib(row['written'])} "
                  f"| {gib(row['disk'])}{estimates[1]} | {row['seconds']:.1f} s |", flush=True)
        print(f"\n{cloud}: sha256 {', '.join(sorted(sha[:12] for sha in shas))}", flush=True)
        all_same = all_same and len(shas) == 1
    return 0 if all_same else 1


if __name__ == "__main__":
    sys.exit(main())
