"""Judges what the program left behind, by the documents alone. Every function gives a list of sentences: what is wrong."""
import math
import re
import struct
import zlib

import ply


class Topology:
    """Edges and fans of triangles, counted from the numbers of their vertices."""

    def __init__(self, triangles, vertices):
        self.degenerate = sum(a == b or b == c or c == a for a, b, c in triangles)
        self.out_of_range = any(not 0 <= v < vertices for t in triangles for v in t)
        directed, edges = {}, {}
        for a, b, c in triangles:
            for u, v in ((a, b), (b, c), (c, a)):
                directed[u, v] = directed.get((u, v), 0) + 1
        for (u, v), count in directed.items():
            forward, backward = edges.get((min(u, v), max(u, v)), (0, 0))
            edges[min(u, v), max(u, v)] = (forward + count, backward) if u < v else (forward, backward + count)
        self.edges = len(edges)
        self.boundary = sum(f + b == 1 for f, b in edges.values())
        self.crowded = sum(f + b > 2 for f, b in edges.values())
        self.misoriented = sum(f + b == 2 and f != 1 for f, b in edges.values())
        self.used = len({v for t in triangles for v in t})
        self.many_fans = self._vertices_with_many_fans(triangles)

    @staticmethod
    def _vertices_with_many_fans(triangles):
        """Vertices whose triangles are not joined by edges at the vertex into one fan, open or closed."""
        around = {}
        for a, b, c in triangles:
            for v, p, q in ((a, b, c), (b, c, a), (c, a, b)):
                around.setdefault(v, []).append((p, q))
        bad = 0
        for spokes in around.values():
            joined = {}
            for p, q in spokes:
                joined.setdefault(p, []).append(q)
                joined.setdefault(q, []).append(p)
            stack = [spokes[0][0]]
            seen = set(stack)
            while stack:
                for q in joined[stack.pop()]:
                    if q not in seen:
                        seen.add(q)
                        stack.append(q)
            bad += len(seen) != len(joined)
        return bad

    def manifold(self):
        return not (self.degenerate or self.crowded or self.many_fans)

    def watertight_but_for_volume(self):
        return self.manifold() and not (self.boundary or self.misoriented or self.out_of_range)


def volume(places, triangles):
    """Enclosed volume in units of the bounding box's longest side, from a corner of the box; no overflow, no rounding."""
    lower = [min(c) for c in zip(*places)]
    side = max(max(c) - low for c, low in zip(zip(*places), lower)) or 1.0
    unit = [tuple((c - low) / side for c, low in zip(p, lower)) for p in places]
    terms = []
    for i, j, k in triangles:
        (ax, ay, az), (bx, by, bz), (cx, cy, cz) = unit[i], unit[j], unit[k]
        terms.append(ax * (by * cz - bz * cy) + ay * (bz * cx - bx * cz) + az * (bx * cy - by * cx))
    return math.fsum(terms) / 6


def mesh(found, closed, positive):
    """A mesh in a Ply: `closed` if no option opens it, `positive` if it must enclose a volume above 0."""
    wrong, places = [], found.rows("x", "y", "z")
    if not found.triangles:
        return ["the mesh has no triangle"]
    if not all(math.isfinite(c) for p in places for c in p):
        return ["vertices are not finite"]
    topology = Topology(found.triangles, len(places))
    if topology.out_of_range:
        return ["a triangle names a vertex that is not there"]
    for count, what in ((topology.degenerate, "triangles name a vertex twice"),
                        (topology.crowded, "edges have more than two triangles"),
                        (topology.misoriented, "edges are passed twice in one direction"),
                        (topology.many_fans, "vertices have more than one fan"),
                        (topology.boundary if closed else 0, "edges have one triangle"),
                        (len(places) - topology.used, "vertices are not used")):
        if count:
            wrong.append(f"{count} {what}")
    if closed and positive and not wrong and not volume(places, found.triangles) > 0:
        wrong.append("the enclosed volume is not positive")
    return wrong + normals(found)


def normals(found):
    if "nx" not in found.columns:
        return []
    lengths = (math.sqrt(x * x + y * y + z * z) for x, y, z in found.rows("nx", "ny", "nz"))
    bad = sum(not abs(length - 1) < 1e-4 for length in lengths)
    return [f"{bad} normals are not of unit length"] if bad else []


def attributes(found, doubtful):
    """Every property is finite but those that are not in the input."""
    return [f"the property {name} is not finite" for name, column in found.columns.items()
            if name not in ("x", "y", "z", "nx", "ny", "nz") and name not in doubtful
            and not all(math.isfinite(v) for v in column)]


def png(data):
    """A whole picture: chunks with right checksums, as many bytes as the header says, an end."""
    if data[:8] != b"\x89PNG\r\n\x1a\n":
        return ["the picture is no PNG"]
    at, chunks = 8, []
    while at + 12 <= len(data):
        length, kind = struct.unpack(">I4s", data[at:at + 8])
        body = data[at + 8:at + 8 + length]
        if data[at + 8 + length:at + 12 + length] != struct.pack(">I", zlib.crc32(kind + body)):
            return ["a chunk of the picture has another checksum"]
        chunks.append((kind, body))
        at += 12 + length
    if at != len(data) or not chunks or chunks[0][0] != b"IHDR" or chunks[-1][0] != b"IEND":
        return ["the picture is cut off"]
    width, height, bits, colour = struct.unpack(">IIBB", chunks[0][1][:10])
    channels = {0: 1, 2: 3, 3: 1, 4: 2, 6: 4}[colour]
    pixels = zlib.decompress(b"".join(body for kind, body in chunks if kind == b"IDAT"))
    expected = height * (1 + (width * channels * bits + 7) // 8)
    return [] if len(pixels) == expected else ["the picture has another number of pixels than it says"]


def messages(code, text, answers_no):
    """Lines on stderr. `answers_no`: exit code 5 is the answer of `check`, which is no error."""
    if re.search("[\x00-\x09\x0b-\x1f\x7f]", text):
        return ["a control character on stderr"]
    # `edit` tells of every operation that is done, and commands that make normals of these, before what fails.
    lines = [line for line in text.split("\n") if line and not re.match(r"\d+: |normals of \d+ points", line)]
    warnings = [line for line in lines if line.startswith("pointskin: warning:")]
    errors = [line for line in lines if line.startswith("pointskin:") and line not in warnings]
    if code == 0 or answers_no:
        return [f"an error on stderr, but exit code {code}"] if errors else []
    if len(errors) != 1 or len(lines) != len(warnings) + 1:
        return [f"exit code {code} with {len(errors)} lines of error among {len(lines) - len(warnings)} on stderr"]
    return []
