#!/usr/bin/env python3
"""How many normals `pointskin orient` puts on the right side, and what becomes of the mesh.

    bench/normals.py CLOUD.ply[:TRUTH.ply] ... [--program build/bin/pointskin] [--flip 10,30,50] [--depth 8]

For every cloud with normals: without them, and with a share of them flipped. Right is the side of the normal in the file.
With a truth: F-score and distances of the mesh. Clouds without normals are only reconstructed. Python's own library alone.
"""
import argparse
import array
import json
import pathlib
import random
import subprocess
import sys
import tempfile


def read_ply(path):
    """Positions and normals (or None) of a binary little-endian PLY of floats and uchars."""
    data = pathlib.Path(path).read_bytes()
    end = data.index(b"end_header\n") + len(b"end_header\n")
    count, sizes, names, in_vertex = 0, [], [], False
    for line in data[:end].decode("ascii").splitlines():
        words = line.split()
        if words[:1] == ["element"]:
            in_vertex = words[1] == "vertex"
            count = int(words[2]) if in_vertex else count
        elif words[:1] == ["property"] and in_vertex:
            sizes.append({"float": 4, "float32": 4, "uchar": 1, "uint8": 1}[words[1]])
            names.append(words[2])
    stride = sum(sizes)
    offset = {name: sum(sizes[:i]) for i, name in enumerate(names)}

    def triple(first):
        values = array.array("f")
        start = end + offset[first]
        for i in range(count):
            values.frombytes(data[start + i * stride : start + i * stride + 12])
        return values

    return triple("x"), triple("nx") if "nx" in offset else None


def write_ply(path, positions, normals):
    names = ["x", "y", "z"] + (["nx", "ny", "nz"] if normals else [])
    count = len(positions) // 3
    header = "ply\nformat binary_little_endian 1.0\nelement vertex %d\n" % count
    header += "".join("property float %s\n" % name for name in names) + "end_header\n"
    body = array.array("f")
    for i in range(0, 3 * count, 3):
        body.extend(positions[i : i + 3])
        if normals:
            body.extend(normals[i : i + 3])
    pathlib.Path(path).write_bytes(header.encode("ascii") + body.tobytes())


def right_share(found, truth):
    right = sum(
        found[i] * truth[i] + found[i + 1] * truth[i + 1] + found[i + 2] * truth[i + 2] > 0
        for i in range(0, len(truth), 3)
    )
    return 3 * right / len(truth)


def run(*words):
    return subprocess.run([str(w) for w in words], check=True, capture_output=True, text=True).stdout


def judge(args, name, cloud, truth_normals, truth_mesh, folder):
    oriented, mesh, report = folder / "oriented.ply", folder / "mesh.ply", folder / "report.json"
    run(args.program, "orient", cloud, "-o", oriented, "--report", report, "-q", *args.options)
    normals = json.loads(report.read_text())["normals"]
    row = "%-34s" % name
    row += "%9.3f" % (100 * right_share(read_ply(oriented)[1], truth_normals)) if truth_normals else "%9s" % "-"
    row += " %-9s %5d %3d %8.0f" % (normals["method"], normals["patches"], normals["rounds"], normals["ms"]["total"])
    run(args.program, "reconstruct", oriented, "-o", mesh, "--depth", args.depth, "--report", report, "-q")
    found = json.loads(report.read_text())["mesh"]
    row += " %-6s %4d %6d" % ("yes" if found["closed"] else "no", found["components"], found["euler"])
    if truth_mesh:
        compared = json.loads(run(args.program, "compare", mesh, truth_mesh, "--json"))
        row += "  %.4f" % compared["f_score"]
    print(row, flush=True)


def main():
    parser = argparse.ArgumentParser(description=__doc__.splitlines()[0])
    parser.add_argument("clouds", nargs="+", metavar="CLOUD.ply[:TRUTH.ply]")
    parser.add_argument("--program", default="build/bin/pointskin")
    parser.add_argument("--flip", default="10,30,50", help="percent of normals to flip, several with commas")
    parser.add_argument("--depth", type=int, default=8)
    parser.add_argument("--options", default="", help="of pointskin orient")
    args = parser.parse_args()
    args.options = args.options.split()
    print("%-34s%9s %-9s %5s %3s %8s %-6s %4s %6s  F-score" %
          ("cloud", "right %", "method", "patch", "try", "ms", "closed", "comp", "euler"))
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        for given in args.clouds:
            path, _, truth_mesh = given.partition(":")
            positions, normals = read_ply(path)
            stem, cloud = pathlib.Path(path).stem, folder / "cloud.ply"
            write_ply(cloud, positions, None)
            judge(args, stem + ", none", cloud, normals, truth_mesh, folder)
            for share in [float(s) for s in args.flip.split(",") if s and normals]:
                chance = random.Random(1)
                turned = array.array("f", normals)
                for i in range(0, len(turned), 3):
                    if 100 * chance.random() < share:
                        turned[i], turned[i + 1], turned[i + 2] = -turned[i], -turned[i + 1], -turned[i + 2]
                write_ply(cloud, positions, turned)
                judge(args, "%s, %g %% flipped" % (stem, share), cloud, normals, truth_mesh, folder)
    return 0


if __name__ == "__main__":
    sys.exit(main())
