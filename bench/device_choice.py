#!/usr/bin/env python3
"""Whether `--device auto` chooses the device that is done first.

    bench/device_choice.py --bin build/bin [--points 1e4,1e5,1e6,1e7] [--depths 6,7,8,9,10,11] [--shapes knot,sphere] [--json FILE]

Generates clouds, reconstructs each from file to file on the CPU, on the GPU and with `auto`, in turn --repeat times (those of a
million points and more once), and prints medians of the wall clock of the whole process, which device `auto` took, and how much
longer that is than the better one. The last lines fit the model of src/reconstruct/run_seconds.cpp to the same runs. Needs a GPU.
Exit code 1 if a choice costs more than --limit, 2 on usage.
"""
import argparse
import itertools
import json
import math
import pathlib
import statistics
import subprocess
import sys
import tempfile
import time

DEVICES = ("cpu", "cuda", "auto")


def words(kind):
    return lambda text: [kind(word) for word in text.split(",")]


def timed(program, cloud, folder, device, depth):
    """Seconds of one run, which device it took, and the nodes of its octree."""
    report = folder / "report.json"
    begin = time.monotonic()
    subprocess.run([program, "reconstruct", cloud, "-o", folder / "mesh.ply", "--overwrite", "-q", "--device", device,
                    "--depth", str(depth), "--report", report], check=True)
    seconds = time.monotonic() - begin
    told = json.loads(report.read_text())
    return seconds, told["device"]["kind"], told["octree"]["nodes"]


def fit(rows, device):
    """Start, seconds a point and a node: least squares of relative errors, by the normal equations."""
    equations = [([1 / row[device], row["points"] / row[device], row["nodes"] / row[device]], 1.0) for row in rows]
    matrix = [[sum(x[i] * x[j] for x, _ in equations) for j in range(3)] + [sum(x[i] * y for x, y in equations)] for i in range(3)]
    for i in range(3):
        pivot = max(range(i, 3), key=lambda k: abs(matrix[k][i]))
        matrix[i], matrix[pivot] = matrix[pivot], matrix[i]
        for k in range(3):
            if k != i:
                factor = matrix[k][i] / matrix[i][i]
                matrix[k] = [a - factor * b for a, b in zip(matrix[k], matrix[i])]
    return [matrix[i][3] / matrix[i][i] for i in range(3)]


def main():
    parser = argparse.ArgumentParser()
    parser.add_argument("--bin", type=pathlib.Path, required=True)
    parser.add_argument("--shapes", type=words(str), default=["knot", "sphere", "gyroid", "torus", "plate"])
    parser.add_argument("--points", type=words(lambda word: int(float(word))), default=[10**4, 10**5, 10**6, 10**7])
    parser.add_argument("--depths", type=words(int), default=[6, 7, 8, 9, 10, 11])
    parser.add_argument("--repeat", type=int, default=3)
    parser.add_argument("--limit", type=float, default=1.15)
    parser.add_argument("--json", type=pathlib.Path)
    args = parser.parse_args()
    program = str(args.bin / "pointskin")
    rows = []
    with tempfile.TemporaryDirectory(prefix="pointskin-choice-") as root:
        folder = pathlib.Path(root)
        print("| shape | points | depth | nodes | CPU s | GPU s | auto s | auto takes | over the better |\n|---|---|---|---|---|---|---|---|---|")
        for shape, points in itertools.product(args.shapes, args.points):
            cloud = folder / "cloud.ply"
            subprocess.run([args.bin / "pointskin_generate", shape, "-o", cloud, "--points", str(points)], check=True,
                           stdout=subprocess.DEVNULL)
            for depth in args.depths:
                runs = {device: [] for device in DEVICES}
                for _ in range(args.repeat if points < 10**6 else 1):
                    for device in DEVICES:  # `auto` is the last, whose choice is kept
                        seconds, taken, nodes = timed(program, cloud, folder, device, depth)
                        runs[device].append(seconds)
                row = {"shape": shape, "points": points, "depth": depth, "nodes": nodes, "taken": taken,
                       **{device: statistics.median(seconds) for device, seconds in runs.items()}}
                row["over"] = row["auto"] / min(row["cpu"], row["cuda"])
                rows.append(row)
                print(f"| {shape} | {points} | {depth} | {nodes} | {row['cpu']:.3f} | {row['cuda']:.3f} | {row['auto']:.3f} "
                      f"| {taken} | {row['over']:.2f} |", flush=True)
    for device in ("cpu", "cuda"):
        start, per_point, per_node = fit(rows, device) if len(rows) > 3 and len({row["points"] for row in rows}) > 1 else (math.nan,) * 3
        print(f"{device}: {start:.3f} s, {1e6 * per_point:.4f} us a point, {1e6 * per_node:.4f} us a node")
    worst = max(rows, key=lambda row: row["over"])
    print(f"largest: {worst['over']:.2f} ({worst['shape']}, {worst['points']} points, depth {worst['depth']})")
    if args.json:
        args.json.write_text(json.dumps(rows, indent=1) + "\n")
    return 1 if worst["over"] > args.limit else 0


if __name__ == "__main__":
    sys.exit(main())
