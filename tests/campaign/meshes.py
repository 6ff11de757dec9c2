"""Reads OBJ and OFF into the form of ply.py, and looks at STL and GLB, from the formats' descriptions alone."""
import math
import struct

import ply


def _mesh(places, normals, triangles):
    found = ply.Ply("text")
    for name, column in zip(("x", "y", "z"), zip(*places)):
        found.columns[name], found.types[name] = column, "double"
    for name, column in zip(("nx", "ny", "nz"), zip(*normals)):
        found.columns[name], found.types[name] = column, "double"
    found.triangles = triangles
    return found


def read_obj(data):
    """Vertices, normals and triangles whose corners name both by one number."""
    places, normals, triangles = [], [], []
    for line in data.decode("ascii").splitlines():
        words = line.split()
        if words[0] == "v":
            places.append(tuple(map(float, words[1:4])))
        elif words[0] == "vn":
            normals.append(tuple(map(float, words[1:])))
        elif words[0] == "f" and len(words) == 4:
            corners = [word.split("//") for word in words[1:]]
            if any(len(set(corner)) != 1 for corner in corners):
                raise ply.Malformed("a corner has the normal of another vertex")
            triangles.append(tuple(int(corner[0]) - 1 for corner in corners))
        else:
            raise ply.Malformed(f"the line {line}")
    return _mesh(places, normals, triangles)


def read_off(data):
    lines = data.decode("ascii").splitlines()
    has_normals, (vertices, faces) = "N" in lines[0], map(int, lines[1].split()[:2])
    if len(lines) != 2 + vertices + faces:
        raise ply.Malformed("another number of lines than the header says")
    rows = [tuple(map(float, line.split())) for line in lines[2:2 + vertices]]
    corners = [tuple(map(int, line.split())) for line in lines[2 + vertices:]]
    if any(len(face) != 4 or face[0] != 3 for face in corners):
        raise ply.Malformed("a face is no triangle")
    return _mesh([row[:3] for row in rows], [row[3:6] for row in rows] if has_normals else [], [f[1:] for f in corners])


def stl(data):
    """Binary: 80 bytes, a count, 50 bytes a triangle, of which 48 are 12 finite numbers."""
    if len(data) < 84 or len(data) != 84 + 50 * struct.unpack_from("<I", data, 80)[0]:
        return ["is no whole STL file"]
    records = struct.iter_unpack("<12fH", data[84:])
    return [] if all(math.isfinite(c) for record in records for c in record[:12]) else ["has numbers that are not finite"]


def glb(data):
    """The header has the length of the file, and the chunks fill it."""
    if len(data) < 12 or data[:4] != b"glTF" or struct.unpack_from("<I", data, 8)[0] != len(data):
        return ["is no whole GLB file"]
    at = 12
    while at + 8 <= len(data):
        at += 8 + struct.unpack_from("<I", data, at)[0]
    return [] if at == len(data) else ["its chunks do not fill the file"]
