"""The cases of the accuracy benchmark: clouds with a known truth."""
import dataclasses
import fnmatch
import pathlib

# Points per generated cloud: about 0.5 to 1.3 finest cells apart at depth 8.
# Flat shapes are turned against the axes by two fixed rotations: along the axes a grid is better than elsewhere.
SHAPE_POINTS = {"gyroid": 500_000, "sphere": 100_000, "torus": 100_000, "knot": 200_000, "plate@1": 100_000,
                "plate@2": 100_000, "slab@1": 100_000, "slab@2": 100_000, "nested": 200_000}
# The shapes have a radius of about 1.
KINDS = {"clean": [], "noisy": ["--noise", "0.003", "--normal-noise", "0.1"]}

# Virtual scans, lengths in units of the diagonal. Of the gyroid and the nested spheres no camera sees the inside.
SCANNED_SHAPES = ("sphere", "torus", "knot", "plate@1", "plate@2", "slab@1", "slab@2")
SCANS = {"scan": ["--sigma", "0.0005", "--misregistration", "0.0005"],
         "roughscan": ["--views", "10", "--spread", "0.6", "--sigma", "0.0015", "--misregistration", "0.0015",
                       "--window", "2", "--outliers", "0.01"],
         "misregistered": ["--misregistration", "0.003"]}

# Faults of real clouds, one at a time, of shapes that are smooth, twisted, thin and sharp. Lengths as above. 1 finest cell
# of depth 8 is about 0.3 % of the diagonal.
SPOILED_SHAPES = ("torus", "knot", "plate@1", "slab@2")
SPOILED_SHELLS = {"gyroid": ("outliers1", "noise0.1", "noise0.3", "noise1")}
SPOILED_MESHES = ("outliers1", "noise0.1", "noise0.3", "noise1", "1000", "5000noisy", "density100", "holes15", "flipped1")
FAULTS = {
    "outliers0.1": ["--outliers", "0.001"], "outliers1": ["--outliers", "0.01"], "outliers5": ["--outliers", "0.05"],
    "clusters1": ["--outliers", "0.01", "--clusters", "5"],
    "noise0.1": ["--sigma", "0.001", "--normal-noise", "0.1"], "noise0.3": ["--sigma", "0.003", "--normal-noise", "0.2"],
    "noise1": ["--sigma", "0.01", "--normal-noise", "0.3"],
    "lines": ["--lines", "0.01"], "quantised": ["--quantum", "0.002"],
    "500": ["--keep", "500"], "1000": ["--keep", "1000"], "5000": ["--keep", "5000"], "10000": ["--keep", "10000"],
    "5000noisy": ["--keep", "5000", "--sigma", "0.003", "--normal-noise", "0.2"],
    "density10": ["--density-ratio", "10"], "density100": ["--density-ratio", "100"], "density1000": ["--density-ratio", "1000"],
    "holes5": ["--holes", "0.05"], "holes15": ["--holes", "0.15"], "holes30": ["--holes", "0.3"],
    "flipped1": ["--flipped", "0.01"], "flipped10": ["--flipped", "0.1"],
    "outside": ["--outside"],
}


@dataclasses.dataclass
class Case:
    name: str
    truth: list          # the words for pointskin_metrics that name the truth
    generate: list       # the words that write the cloud, {out} where its name goes; empty for a file
    cloud: pathlib.Path  # of a file; a generated cloud gets its name in the working folder


def ply_header(path):
    """The lines of a PLY file's header, or none if it is no PLY file."""
    lines = []
    with open(path, "rb") as file:
        for line in file:
            lines.append(line.decode("latin-1").strip())
            if lines[0] != "ply" or lines[-1] == "end_header" or len(lines) > 1000:
                break
    return lines if lines and lines[0] == "ply" else []


def point_count(path):
    """Vertices of a PLY file."""
    for line in ply_header(path):
        words = line.split()
        if words[:2] == ["element", "vertex"]:
            return int(words[2])
    raise ValueError(f"{path} is no PLY file with vertices")


def has_normals(path):
    return any(line.startswith("property ") and line.split()[-1] == "nx" for line in ply_header(path))


def shape_cases(tools, points, seed):
    for shape, usual in SHAPE_POINTS.items():
        for kind, noise in KINDS.items():
            generate = [str(tools / "pointskin_generate"), shape, "-o", "{out}", "--points", str(points or usual),
                        "--seed", str(seed), *noise]
            yield Case(f"{shape}-{kind}", ["--shape", shape], generate, None)


def scan_cases(tools, name, surface, truth, seed):
    """Scans of one surface; `surface` and `truth` are the words that name it for either program."""
    for kind, faults in SCANS.items():
        generate = [str(tools / "pointskin_scan"), *surface, "-o", "{out}", "--seed", str(seed), *faults]
        yield Case(f"{name}-{kind}", truth, generate, None)


def scanned_shape_cases(tools, seed):
    for shape in SCANNED_SHAPES:
        yield from scan_cases(tools, shape, ["--shape", shape], ["--shape", shape], seed)


def spoiled(tools, name, surface, truth, seed, faults):
    """A surface with one fault after another; `surface` and `truth` are the words that name it for either program."""
    for fault in faults:
        generate = [str(tools / "pointskin_spoil"), *surface, "-o", "{out}", "--seed", str(seed), *FAULTS[fault]]
        yield Case(f"{name}-{fault}", truth, generate, None)


def spoiled_cases(tools, seed):
    for shape, faults in {**dict.fromkeys(SPOILED_SHAPES, tuple(FAULTS)), **SPOILED_SHELLS}.items():
        yield from spoiled(tools, shape, ["--shape", shape], ["--shape", shape], seed, faults)


def file_cases(tools, folder, seed):
    """Every NAME.ply with normals that has its truth beside it, as NAME_gt.ply; of every NAME_gt.ply, turned against the
    axes, scans and points with faults."""
    for truth in sorted(folder.glob("*_gt.ply")):
        cloud = truth.with_name(truth.name.removesuffix("_gt.ply") + ".ply")
        words = ["--truth", str(truth)]
        if cloud.exists() and has_normals(cloud):
            yield Case(cloud.stem, words, [], cloud)
        for rotation in ("1", "2"):
            turned = ["--rotation", rotation]
            yield from scan_cases(tools, f"{cloud.stem}@{rotation}", [str(truth), *turned], [*words, *turned], seed)
        yield from spoiled(tools, f"{cloud.stem}@1", ["--mesh", str(truth), "--rotation", "1"], [*words, "--rotation", "1"],
                           seed, SPOILED_MESHES)


def known_cases(tools, points, seed, data):
    """All of them; those of files only where there is a folder `data`."""
    known = [*shape_cases(tools, points, seed), *scanned_shape_cases(tools, seed), *spoiled_cases(tools, seed)]
    return known + list(file_cases(tools, data.resolve(), seed)) if data else known


def choose(cases, patterns):
    """The cases whose name matches one of the comma separated shell patterns."""
    return [case for case in cases if any(fnmatch.fnmatchcase(case.name, p) for p in patterns.split(","))]
