"""Clouds at random: shapes, and what goes wrong with them. A cloud is [[name, type], ...] and rows of numbers."""
import math

import ply

SCALES = [1e-38, 1e-30, 1e-20, 1e-9, 1e-3, 1.0, 1.0, 1.0, 1.0, 1e3, 1e9, 1e20, 1e30, 1e37, 1e38]
OFFSETS = [1.0, 1e3, 1e5, 1e6, 1e7, 1e9]


def _unit(v):
    length = math.sqrt(sum(c * c for c in v))
    return tuple(c / length for c in v) if length > 0 else (0.0, 0.0, 1.0)


def _direction(r):
    return _unit((r.gauss(0, 1), r.gauss(0, 1), r.gauss(0, 1)))


def sphere(r, n):
    return [(d, d) for d in (_direction(r) for _ in range(n))]


def ellipsoid(r, n):
    axes = [10 ** r.uniform(-3, 0) for _ in range(3)]
    return [(tuple(a * c for a, c in zip(axes, d)), _unit([c / a for a, c in zip(axes, d)]))
            for d in (_direction(r) for _ in range(n))]


def torus(r, n):
    tube, points = r.uniform(0.15, 0.5), []
    while len(points) < n:
        u, v = r.uniform(0, 2 * math.pi), r.uniform(0, 2 * math.pi)
        if r.random() > (1 + tube * math.cos(v)) / (1 + tube):  # evenly over the area
            continue
        normal = (math.cos(u) * math.cos(v), math.sin(u) * math.cos(v), math.sin(v))
        points.append(((math.cos(u) + tube * normal[0], math.sin(u) + tube * normal[1], tube * normal[2]), normal))
    return points


def box(r, n):
    points = []
    for _ in range(n):
        axis, side = r.randrange(3), r.choice((-1.0, 1.0))
        place = [r.uniform(-1, 1) for _ in range(3)]
        normal = [0.0, 0.0, 0.0]
        place[axis] = normal[axis] = side
        points.append((tuple(place), tuple(normal)))
    return points


def plane(r, n):
    return [((r.uniform(-1, 1), r.uniform(-1, 1), 0.0), (0.0, 0.0, 1.0)) for _ in range(n)]


def two_planes(r, n):
    gap = 10 ** r.uniform(-4, -0.5)
    return [((r.uniform(-1, 1), r.uniform(-1, 1), side * gap), (0.0, 0.0, side))
            for side in (r.choice((-1.0, 1.0)) for _ in range(n))]


def line(r, n):
    direction, across = _direction(r), _direction(r)
    return [(tuple(t * c for c in direction), across) for t in (r.uniform(-1, 1) for _ in range(n))]


def axis_line(r, n):
    return [((r.uniform(-1, 1), 0.0, 0.0), (0.0, 1.0, 0.0)) for _ in range(n)]


def one_place(r, n):
    normal = _direction(r)
    return [((0.25, -0.5, 0.125), normal)] * n


def single(r, n):
    return one_place(r, 1)


def few(r, n):
    return [(tuple(r.uniform(-1, 1) for _ in range(3)), _direction(r)) for _ in range(r.randint(2, 12))]


def noise(r, n):
    return [(tuple(r.uniform(-1, 1) for _ in range(3)), _direction(r)) for _ in range(n)]


def corners(r, n):
    sides = (-1.0, 1.0)
    return [((x, y, z), _unit((x, y, z))) for x in sides for y in sides for z in sides]


def grid(r, n):
    side = max(2, round(n ** (1 / 3)))
    step = 2 / side
    return [((i * step, j * step, k * step), _unit((i - side / 2 + 0.25, j - side / 2, k - side / 2)))
            for i in range(side) for j in range(side) for k in range(side)]


def cap(r, n):
    level = r.uniform(-0.5, 0.8)
    return [(d, d) for d in (_direction(r) for _ in range(n)) if d[2] >= level] or sphere(r, 3)


def density_ratio(r, n):
    """A sphere with nearly all of its points in one place."""
    width, points = 10 ** r.uniform(-4, -1), sphere(r, max(4, n // 10))
    while len(points) < n:
        d = _unit((r.gauss(0, width), r.gauss(0, width), 1.0))
        points.append((d, d))
    return points


def two_spheres(r, n):
    distance = r.choice((1.5, 2.0, 2.0 + 10 ** r.uniform(-3, 0)))
    return [((d[0] + distance * r.randrange(2), d[1], d[2]), d) for d in (_direction(r) for _ in range(n))]


SOLIDS = [sphere, torus, box, two_spheres]  # closed, evenly sampled, normals right
SHAPES = SOLIDS * 2 + [ellipsoid, plane, two_planes, line, axis_line, one_place, single, few, noise, corners, grid, cap,
                       density_ratio]


# What goes wrong. Each takes points as [[place, normal], ...] and gives such.
def duplicates(r, points):
    return points + [points[r.randrange(len(points))] for _ in range(len(points) // 2 + 1)]


def opposed(r, points):
    return points + [(p, tuple(-c for c in n)) for p, n in points]


def flipped(r, points):
    share = r.choice((0.05, 0.3, 0.5, 1.0))
    return [(p, tuple(-c for c in n)) if r.random() < share else (p, n) for p, n in points]


def not_finite(r, points):
    share, bad = r.choice((0.01, 0.3, 1.0)), (math.nan, math.inf, -math.inf)
    return [(tuple(r.choice(bad) if k == r.randrange(3) else c for k, c in enumerate(p)), n)
            if r.random() < share else (p, n) for p, n in points]


def normals_not_finite(r, points):
    bad = (math.nan, math.inf, -math.inf)
    return [(p, (r.choice(bad), n[1], n[2])) if r.random() < 0.1 else (p, n) for p, n in points]


def zero_normals(r, points):
    share = r.choice((0.1, 0.9, 1.0))
    return [(p, (0.0, 0.0, 0.0)) if r.random() < share else (p, n) for p, n in points]


def long_normals(r, points):
    return [(p, tuple(c * length for c in n)) for p, n in points for length in (10 ** r.uniform(-30, 30),)]


def outliers(r, points):
    far = 10 ** r.uniform(0.5, 4)
    return points + [(tuple(far * c for c in _direction(r)), _direction(r)) for _ in range(r.randint(1, 40))]


def jitter(r, points):
    width = 10 ** r.uniform(-4, -0.5)
    return [(tuple(c + r.gauss(0, width) for c in p), n) for p, n in points]


def anisotropic(r, points):
    f = [10 ** r.uniform(-4, 0) for _ in range(3)]
    return [(tuple(a * c for a, c in zip(f, p)), _unit([c / a for a, c in zip(f, n)])) for p, n in points]


FLAWS = [duplicates, opposed, flipped, not_finite, normals_not_finite, zero_normals, long_normals, outliers, jitter,
         anisotropic]

ATTRIBUTES = [
    ("red", "uchar", lambda r: r.randrange(256)), ("green", "uchar", lambda r: r.randrange(256)),
    ("blue", "uchar", lambda r: r.randrange(256)), ("intensity", "ushort", lambda r: r.randrange(65536)),
    ("class_id", "int", lambda r: r.choice((-2 ** 31, -1, 0, 7, 2 ** 31 - 1))),
    ("heat", "float", lambda r: r.choice((0.0, r.gauss(0, 1), 3.4e38, -3.4e38, 1e-40))),
    ("time", "double", lambda r: r.choice((0.0, r.uniform(0, 4e5), 1e300, -1e300))),
    ("density", "float", lambda r: r.uniform(0, 1)),
    ("maybe", "float", lambda r: r.choice((math.nan, math.inf, 1.0))),
]


class Cloud:
    """What a case knows of its points; `solid` if they are a closed shape whose surface must come out."""

    def __init__(self, properties, rows, form, solid):
        self.properties, self.rows, self.form, self.solid = properties, rows, form, solid

    def bytes(self):
        return ply.write(self.properties, self.rows, self.form)


def random_cloud(r, normals=True, most=1500, least=1):
    """One shape, up to three flaws, a scale and an offset."""
    shape = r.choice(SHAPES)
    n = r.choice([n for n in (1, 3, 30, 200, 600, 1000, most) if n >= least])
    points = shape(r, n)
    flaws = r.sample(FLAWS, r.choice((0, 0, 1, 1, 2, 3)))
    for flaw in flaws:
        points = flaw(r, points)
    points = points[:3 * most]
    scale, offset = r.choice(SCALES), (0.0, 0.0, 0.0)
    if r.random() < 0.3 and 1e-3 <= scale <= 1e3:
        offset = tuple(r.choice((-1, 0, 1)) * r.choice(OFFSETS) for _ in range(3))
    kind = "double" if any(offset) and r.random() < 0.8 else r.choice(("float", "float", "double"))
    solid = shape in SOLIDS and n >= 600 and not flaws and not any(offset) and 1e-30 <= scale <= 1e30
    properties = [["x", kind], ["y", kind], ["z", kind]]
    if normals:
        properties += [[name, "float"] for name in ("nx", "ny", "nz")]
    extra = r.sample(ATTRIBUTES, r.randint(1, 5)) if r.random() < 0.4 else []
    properties += [[name, kind] for name, kind, _ in extra]
    rows = []
    for place, normal in points:
        row = [scale * c + o for c, o in zip(place, offset)] + (list(normal) if normals else [])
        row += [make(r) for _, _, make in extra]
        rows.append(tuple(ply.round_to(p[1], v) for p, v in zip(properties, row)))
    form = r.choice(("binary_little_endian", "binary_little_endian", "binary_big_endian", "ascii"))
    return Cloud(properties, rows, form, solid)


def box_mesh(lower, upper):
    """Places and triangles of a closed box, seen from outside counter-clockwise."""
    places = [tuple((upper if k >> axis & 1 else lower)[axis] for axis in range(3)) for k in range(8)]
    quads = [(0, 2, 3, 1), (4, 5, 7, 6), (0, 1, 5, 4), (2, 6, 7, 3), (0, 4, 6, 2), (1, 3, 7, 5)]
    return places, [t for a, b, c, d in quads for t in ((a, b, c), (a, c, d))]


def bounds(cloud):
    """Lower and upper corner of the finite points, or None."""
    places = [row[:3] for row in cloud.rows if all(math.isfinite(c) for c in row[:3])]
    return ([min(c) for c in zip(*places)], [max(c) for c in zip(*places)]) if places else None
