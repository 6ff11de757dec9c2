"""Cases at random: a command, its inputs and its options, with values inside, at and beyond the borders of docs/cli.md."""
import base64
import json
import random
import zlib

import clouds
import ply


class Case:
    """`arguments` are groups of words, of which the first `fixed` stay when a case is shrunk. `inputs` are bytes by name,
    `points` the names of those that are clouds. `codes` are the exit codes that are right. With a `share` the case is judged
    once more with that share of the memory that it took."""

    def __init__(self, command):
        self.arguments, self.fixed = [[command]], 1
        self.inputs, self.points = {}, []
        self.solid = self.beyond = False
        self.codes, self.shows, self.compare, self.share = None, "", [2, 1], 0.0

    def command(self):
        return self.arguments[0][0]

    def words(self):
        return [word for group in self.arguments for word in group]

    def value(self, name):
        """The word behind the last option of this name, "" if it stands alone, None if it is not there."""
        found = [group for group in self.arguments if group[0] == name]
        return None if not found else found[-1][1] if len(found[-1]) > 1 else ""

    def has(self, *names):
        return any(self.value(name) is not None for name in names)

    def outputs(self):
        return [group[1] for group in self.arguments[1:] if group[0] in OUTPUTS]

    def to_json(self):
        packed = {name: base64.b64encode(zlib.compress(data, 9)).decode() for name, data in self.inputs.items()}
        return json.dumps({"shows": self.shows, "arguments": self.arguments, "fixed": self.fixed, "codes": self.codes,
                           "solid": self.solid, "beyond": self.beyond, "threads": self.compare[0],
                           "order": self.compare[1], "points": self.points, "share": self.share,
                           "inputs": packed}, indent=1) + "\n"

    @staticmethod
    def from_json(text):
        data, case = json.loads(text), Case("")
        case.shows, case.arguments, case.fixed, case.codes = data["shows"], data["arguments"], data["fixed"], data["codes"]
        case.solid, case.beyond, case.points = data["solid"], data["beyond"], data["points"]
        case.compare, case.share = [data["threads"], data["order"]], data.get("share", 0.0)
        case.inputs = {name: zlib.decompress(base64.b64decode(packed)) for name, packed in data["inputs"].items()}
        return case


OUTPUTS = ("-o", "--cloud", "--report", "--save", "--heat", "--particles-out")




# Option: values that are right, values beyond the borders.
SURFACE = {
    "--screening": (["0", "0.01", "2", "100", "1e6"], ["-1", "nan"]),
    "--iterations": (["1", "3", "8", "30"], ["0", "1001", "-3"]),
    "--scale": (["1", "1.1", "1.5", "7", "100"], ["0.99", "100.5", "inf"]),
    "--samples-per-node": (["0", "0.3", "1.5", "20", "100"], ["-0.1", "101"]),
    "--fixed-screening": ([None], []),
    "--linear-fit": ([None], []),
    "--boundary": (["free", "neumann", "dirichlet"], ["open"]),
    "--keep-strays": ([None], []),
    "--no-normals": ([None], []),
    "--shift": (["auto", "none", "0,0,0", "1,2,3", "1e6,0,0"], ["1,2", "x"]),
}
FIT = {
    "--field": (["poisson", "distance"], ["sdf"]),
    "--confidence": ([None], []),
    "--open": ([None], []),
    "--trim": (["0.01", "0.05", "0.5", "0.99"], ["-0.1", "1"]),
    "--island-ratio": (["0", "0.001", "0.9"], ["1", "-1"]),
    "--largest": ([None], []),
    "--min-component": (["0", "0.01", "0.9", "5", "1000"], ["-1"]),
    "--density": ([None], []),
    "--keep-attributes": ([None], []),
}
NORMALS = {
    "--keep-within": (["0", "30", "75", "90"], ["-1", "91"]),
    "--max-rounds": (["1", "3", "40"], ["0", "1001"]),
    "--seed": (["1", "7"], ["x"]),
    "--random-start": ([None], []),
    "--sensor": (["0,0,5", "0,0,0", "1e9,0,0"], ["0,0", "nan,0,0"]),
}
RECONSTRUCT = {**SURFACE, **FIT, **NORMALS,
               "--normals": (["given", "auto", "repair", "estimate"], ["maybe"]),
               "--max-memory": (["16M", "24M", "40M", "100M", "1G"], ["-1", "x"]),
               "--dry-run": ([None], [])}
TRIM = {"--trim": ([*FIT["--trim"][0], "auto"], FIT["--trim"][1])}
ONE_MORE = {"--offset": (["0.01", "-0.01", "0.1", "-0.1", "1"], ["nan"]), "--weakness": ([None], [])}
TABLES = {
    "reconstruct": {**RECONSTRUCT, **TRIM, **ONE_MORE},
    "problems": {name: values for name, values in RECONSTRUCT.items() if name != "--field"},
    "edit": {**SURFACE, **FIT, "--weakness": ([None], []), "--cold": ([None], [])},
    "deform": {**SURFACE, **FIT, **ONE_MORE},
    "boolean": {**SURFACE, "--creases": (["sampled", "none"], ["x"]),
                "--coincidence": (["0", "0.5", "10", "100"], ["-1", "101"])},
    "orient": {**NORMALS, "--method": (["auto", "propagate", "iterate", "repair"], ["x"]), "--curvature": ([None], []),
               "--no-confidence": ([None], []), "--shift": SURFACE["--shift"], "--ascii": ([None], [])},
    "fluid": {"--cube-size": (["0.3", "0.5", "1", "4"], ["0.04", "4.1"]),
              "--smoothing-length": (["1", "2", "4"], ["0.9", "8.1"]),
              "--kernel": (["isotropic", "anisotropic"], ["cubic"]),
              "--mesh-smoothing-iters": (["0", "1", "25", "200"], ["-1", "1001"]),
              "--no-smoothing-weights": ([None], []), "--min-component": (["0", "1", "30"], ["-1"]),
              "--no-attributes": ([None], []), "--no-normals": ([None], []), "--shift": SURFACE["--shift"]},
    "simulate": {"--viscosity": (["0", "0.02", "1"], ["-0.1", "1.1"]), "--vorticity": (["0", "1", "1e3"], ["-1"]),
                 "--iterations": (["1", "4", "12"], ["0", "101"]), "--fps": (["24", "60", "10000"], ["0", "10001"]),
                 "--mesh-smoothing-iters": (["0", "5"], ["1001"])},
    "convert": {"--ascii": ([None], []), "--double": ([None], []), "--shift": SURFACE["--shift"]},
    "render": {"--up": (["x", "y", "z", "-x", "-y", "-z"], ["w"]), "--azimuth": (["0", "-400", "1e6"], ["x"]),
               "--elevation": (["-90", "0", "90"], ["91"]), "--fit": (["box", "sphere"], ["x"]),
               "--zoom": (["0.001", "1", "1000"], ["0", "1001"]), "--fov": (["1", "60", "170"], ["0.5", "171"]),
               "--orthographic": ([None], []), "--wireframe": ([None], []), "--flat": ([None], []),
               "--cull": ([None], []), "--point-size": (["0", "3", "50"], ["-1", "1001"]), "--no-shadows": ([None], []),
               "--target": (["0,0,0", "1e9,0,0"], ["0,0"]), "--colour-by": (["x", "z"], ["no_such"]),
               "--colour-map": (["auto", "sequential", "diverging"], ["x"]), "--no-colours": ([None], [])},
    "compare": {"--tau": (["0.01", "0.5"], ["-1"]), "--samples": (["1", "1000", "20000"], ["0"])},
    "check": {"--self-intersections": ([None], []), "--max-memory": (["12M", "20M", "100M", "8G"], ["0", "x", "-1"])},
    "info": {"--shift": SURFACE["--shift"]},
}
# Pairs that the documents call usage errors.
REFUSED = [("--field", name) for name in ("--envelope", "--weakness", "--boundary")]
REFUSED += [("--offset", name) for name in ("--trim", "--density", "--keep-attributes", "--envelope", "--open",
                                            "--weakness")]
REFUSED += [("--max-memory", "--self-intersections")]


def _options(r, case, table, most=5):
    names = r.sample(sorted(table), min(len(table), r.choice((0, 1, 2, 3, most))))
    wrong = r.choice(names) if names and r.random() < 0.04 else None
    for name in names:
        right, beyond = table[name]
        if name == wrong and beyond:
            case.beyond = True
            value = r.choice(beyond)
        else:
            value = r.choice(right)
        case.arguments.append([name] if value is None else [name, value])


def _cloud(r, case, name, normals=True, most=1500, least=1):
    cloud = clouds.random_cloud(r, normals, most, least)
    case.inputs[name] = cloud.bytes()
    case.points.append(name)
    return cloud


def _fit(r, case, cloud):
    """Depth and limits of the commands that fit surfaces, and whether a surface must come of it."""
    case.arguments.append(["--depth", r.choice(("1", "2", "3", "4", "5", "5", "6", "6", "7"))])
    _options(r, case, TABLES[case.command()])
    if r.random() < 0.07 and case.command() != "boolean":
        low, high = clouds.bounds(cloud) or ([-1] * 3, [1] * 3)
        grow = max(h - l for h, l in zip(high, low)) * r.choice((0.5, 0.01, -0.2))
        places, triangles = clouds.box_mesh([l - grow for l in low], [h + grow for h in high])
        case.inputs["envelope.ply"] = ply.write([[a, "double"] for a in "xyz"], places, triangles=triangles)
        case.arguments.append(["--envelope", "envelope.ply"])
    emptying = ("--trim", "--offset", "--min-component", "--envelope", "--max-memory", "--shift", "--open", "--scale")
    case.solid = (cloud.solid and any(name == "nx" for name, _ in cloud.properties) and int(case.value("--depth")) >= 4 and not case.has(*emptying)
                  and case.command() in ("reconstruct", "problems"))


def _inputs(r, case, *groups):
    case.arguments += [list(group) for group in groups]
    case.fixed = len(case.arguments)


def reconstruct(r, command="reconstruct"):
    case = Case(command)
    cloud = _cloud(r, case, "a.ply", normals=r.random() < 0.93)
    _inputs(r, case, ["a.ply"], ["-o", r.choice(("mesh.ply",) * 8 + ("mesh.obj", "mesh.stl", "mesh.off", "mesh.glb"))])
    _fit(r, case, cloud)
    if r.random() < 0.1:
        _cloud(r, case, "b.ply")
        case.arguments.insert(2, ["b.ply"])
        case.fixed += 1
        case.solid = False
    if r.random() < 0.2:
        case.arguments.append(["--report", "report.json"])
    return case


BLOCKS = {**SURFACE, **TRIM,
          **{name: FIT[name] for name in ("--open", "--confidence", "--largest", "--min-component", "--density", "--island-ratio",
                                     "--keep-attributes")},
          "--normals": (["given"], [])}


def in_blocks(r):
    """A cloud that is large enough for work in blocks to be of use."""
    case = Case("reconstruct")
    most = r.choice((3000, 8000, 20000))
    cloud = _cloud(r, case, "a.ply", most=most, least=most)
    _inputs(r, case, ["a.ply"], ["-o", "mesh.ply"])
    case.arguments.append(["--depth", r.choice(("8", "9", "10"))])
    case.fixed += 1
    _options(r, case, BLOCKS)
    case.solid = False
    case.share = r.uniform(0.4, 0.93)
    return case


def problems(r):
    return reconstruct(r, "problems")


def boolean(r):
    case = Case("boolean")
    cloud = _cloud(r, case, "a.ply", most=800)
    if r.random() < 0.4:
        places, triangles = clouds.box_mesh([-0.5, -0.5, -0.5], [1.5, r.choice((0.5, 2)), 0.5])
        if r.random() < 0.1:
            triangles = triangles[1:]
        case.inputs["b.ply"] = ply.write([[a, "float"] for a in "xyz"], places, triangles=triangles)
    else:
        _cloud(r, case, "b.ply", most=800)
    operation = r.choice(("union", "intersection", "difference", "symmetric-difference"))
    _inputs(r, case, ["a.ply"], ["b.ply"], ["--op", operation], ["-o", "mesh.ply"])
    _fit(r, case, cloud)
    if r.random() < 0.3:
        case.arguments.append(["--cloud", "points.ply"])
    return case


def _handles(r):
    hold = {"region": {"half_space": {"point": [0, -0.3, 0], "normal": [0, -1, 0]}}}
    move = {"region": {"ball": {"centre": [0, 1, 0], "radius": r.choice((1e-9, 0.5, 3))}}}
    if r.random() < 0.7:
        move["rigid"] = {"axis": [0, 0, 1], "point": [0, 0, 0], "degrees": r.choice((0, 30, 180, 720)),
                         "translation": [r.choice((0, 0.5, 100)), 0, 0]}
    else:
        move["affine"] = {"matrix": [[2, 0, 0, 0], [0, r.choice((0.1, 1, 0, -1)), 0, 0], [0, 0, 1, 0.5]]}
    script = {"handles": r.choice(([hold, move], [move], [hold]))}
    if r.random() < 0.4:
        script["lattices"] = [{"box": {"lower": [-1, -1, -1], "upper": [1, 1, 1]}, "spans": [2, 2, 2],
                               "moves": [{"at": [1, 1, 2], "by": [0, 0, r.choice((0.1, 3))]}],
                               "outside": r.choice(("extend", "stay"))}]
    return script


def deform(r):
    case = Case("deform")
    cloud = _cloud(r, case, "a.ply", most=800)
    case.inputs["script.json"] = json.dumps(_handles(r)).encode()
    frames = r.random() < 0.15
    _inputs(r, case, ["a.ply"], ["--script", "script.json"], ["-o", "mesh_{}.ply" if frames else "mesh.ply"])
    if frames:
        case.arguments.append(["--frames", r.choice(("2", "3"))])
        case.fixed += 1
    _fit(r, case, cloud)
    return case


def _operation(r):
    camera = {"azimuth": r.choice((0, 45, 90, -700)), "elevation": r.choice((0, 30, 90)), "width": 400, "height": 300}
    rectangle = [r.randrange(200), r.randrange(150), r.randrange(200, 400), r.randrange(150, 300)]
    return r.choice((
        {"op": "guide", "camera": camera, "stroke": [rectangle[:2], rectangle[2:]], "normals": r.choice(("cloud", "stroke"))},
        {"op": "guide", "camera": camera, "rectangle": rectangle, "inside_only": r.random() < 0.5},
        {"op": "remove", "camera": camera, "rectangle": rectangle, "originals": r.random() < 0.7,
         "layers": r.choice(("through", "front"))},
        {"op": "flip", "camera": camera, "rectangle": rectangle, "layers": r.choice(("through", "front"))},
        {"op": "boolean", "operation": r.choice(("union", "intersection", "difference", "symmetric")),
         "with": {"shape": "sphere", "points": 500}, "translation": [0.5, 0, 0]},
        {"op": "insert", "shape": "torus", "points": 500, "scale": r.choice((0.01, 1)), "snap": r.random() < 0.5},
        {"op": "orient", "method": r.choice(("turn", "propagate", "repair", "estimate"))},
        {"op": "options", "depth": r.choice((2, 4, 5))},
        {"op": "deform", **_handles(r)}))


def _operations(r):
    operations = [_operation(r) for _ in range(r.randint(1, 4))]
    if r.random() < 0.3:
        operations += [{"op": "undo"}] * r.randint(1, len(operations))
        operations += [{"op": "redo"}] * r.randint(0, 1)
    return operations


def edit(r):
    case = Case("edit")
    cloud = _cloud(r, case, "a.ply", most=600)
    case.inputs["script.json"] = json.dumps({"version": 1, "operations": _operations(r)}).encode()
    _inputs(r, case, ["a.ply"], ["--script", "script.json"], ["-o", "mesh.ply"])
    _fit(r, case, cloud)
    case.arguments = [["--depth", "5"] if g == ["--depth", "7"] else g for g in case.arguments]
    if r.random() < 0.3:
        case.arguments += [["--cloud", "points.ply"], ["--save", "scene.json"]]
    return case


def orient(r):
    case = Case("orient")
    _cloud(r, case, "a.ply", normals=r.random() < 0.5, most=600)
    _inputs(r, case, ["a.ply"], ["-o", "points.ply"])
    _options(r, case, TABLES["orient"])
    return case


def fluid(r):
    if r.random() < 0.2:
        return _simulate(r)
    case = Case("fluid")
    cloud = _cloud(r, case, "a.ply", normals=False, most=600)
    low, high = clouds.bounds(cloud) or ([0] * 3, [1] * 3)
    size = max(h - l for h, l in zip(high, low)) or 1.0
    radius = size * r.choice((0.5, 0.1, 0.05, 0.03, 0.01))
    case.beyond = not 0 < radius <= 1e18
    _inputs(r, case, ["a.ply"], ["-o", "mesh.ply"], ["-r", repr(radius)])
    _options(r, case, TABLES["fluid"])
    if case.beyond:
        case.codes = [2, 3]
    return case


def _simulate(r):
    case = Case("fluid")
    scene = r.choice(("dam-break", "double-dam-break", "drop", "obstacle", "stir"))
    _inputs(r, case, ["--simulate", scene], ["--frames", r.choice(("1", "2", "3"))],
            ["--particles", r.choice(("200", "201", "700"))], ["-o", "mesh_{}.ply"], ["--particles-out", "p_{}.ply"])
    _options(r, case, TABLES["simulate"])
    return case


def _broken_mesh(r):
    places, triangles = clouds.box_mesh([-1, -1, -1], [1, 1, 1])
    for _ in range(r.randrange(3)):
        k = r.randrange(len(triangles))
        a, b, c = triangles[k]
        change = r.randrange(6)
        if change == 0:
            triangles.pop(k)
        elif change == 1:
            triangles[k] = (a, c, b)
        elif change == 2:
            triangles.append((a, b, c))
        elif change == 3:
            triangles[k] = (a, a, c)
        elif change == 4:  # a second box that has a vertex or an edge in common with the first
            more, again = clouds.box_mesh([1, 1, r.choice((1, -1))], [2, 2, 2])
            number = {p: k for k, p in enumerate(places)}
            for p in more:
                number.setdefault(p, len(number))
            places = sorted(number, key=number.get)
            triangles += [tuple(number[more[v]] for v in t) for t in again]
        else:
            triangles = [(a, c, b) for a, b, c in triangles]
    return ply.write([[a, r.choice(("float", "double"))] for a in "xyz"], places,
                     r.choice(("ascii", "binary_little_endian", "binary_big_endian")), triangles)


def check(r):
    case = Case("check")
    case.inputs["a.ply"] = _broken_mesh(r)
    _inputs(r, case, ["a.ply"], ["--json"])
    _options(r, case, TABLES["check"])
    return case


def compare(r):
    case = Case("compare")
    for name in ("a.ply", "b.ply"):
        if r.random() < 0.4:
            case.inputs[name] = _broken_mesh(r)
        else:
            _cloud(r, case, name, normals=r.random() < 0.7, most=600)
    _inputs(r, case, ["a.ply"], ["b.ply"], ["--json"])
    _options(r, case, TABLES["compare"])
    if r.random() < 0.3:
        case.arguments.append(["--heat", "points.ply"])
    return case


def convert(r):
    case = Case("convert")
    _cloud(r, case, "a.ply", normals=r.random() < 0.7)
    _inputs(r, case, ["a.ply"], ["points.ply"])
    _options(r, case, TABLES["convert"])
    return case


def render(r):
    case = Case("render")
    if r.random() < 0.3:
        case.inputs["a.ply"] = _broken_mesh(r)
    else:
        _cloud(r, case, "a.ply", normals=r.random() < 0.7)
    _inputs(r, case, ["a.ply"], ["-o", "picture.png"], ["--size", r.choice(("1x1", "64x48", "200x150"))])
    _options(r, case, TABLES["render"])
    # Points have no edges, and a mesh has no points: usage errors. A size of 0 is the default.
    refused = case.has("--wireframe") if case.points else case.value("--point-size") not in (None, "0")
    if refused and not case.beyond:
        case.beyond, case.codes = True, [2, 3]  # a cloud without any finite point is refused first
    return case


def info(r):
    case = Case("info")
    _cloud(r, case, "a.ply", normals=r.random() < 0.7)
    _inputs(r, case, ["a.ply"], ["--json"])
    _options(r, case, TABLES["info"])
    return case


COMMANDS = [reconstruct] * 10 + [in_blocks, problems, boolean, boolean, deform, edit, edit, orient, orient, fluid, fluid, fluid,
                                 check, compare, convert, render, info]


def random_case(seed, number):
    """Case `number` of a campaign; it does not depend on those before it."""
    r = random.Random(f"{seed}/{number}")
    case = r.choice(COMMANDS)(r)
    case.arguments.append(["--threads", r.choice("1237")])
    case.compare = [r.choice([n for n in (1, 2, 3, 7) if str(n) != case.value("--threads")]), r.randrange(1, 1000)]
    return case
