"""Reads and writes PLY, from the format's description alone: nothing here is shared with the program that is tested."""
import struct

TYPES = {
    "char": "b", "uchar": "B", "short": "h", "ushort": "H", "int": "i", "uint": "I", "float": "f", "double": "d",
    "int8": "b", "uint8": "B", "int16": "h", "uint16": "H", "int32": "i", "uint32": "I", "float32": "f", "float64": "d",
}
ENDIAN = {"binary_little_endian": "<", "binary_big_endian": ">"}


class Malformed(Exception):
    """The bytes are no whole PLY file."""


class Ply:
    """Columns of the vertices by name, and triangles as triples of numbers; None where there is no element `face`."""

    def __init__(self, form):
        self.form = form
        self.types = {}
        self.columns = {}
        self.triangles = None

    def count(self):
        return len(self.columns["x"]) if "x" in self.columns else 0

    def rows(self, *names):
        return list(zip(*(self.columns[name] for name in names)))


def _header(data):
    end = data.find(b"end_header\n")
    if not data.startswith(b"ply\n") or end < 0:
        raise Malformed("no header")
    form, elements = None, []
    for line in data[:end].decode("latin-1").split("\n")[1:]:
        words = line.split(" ")
        if words[0] == "format":
            form = words[1]
        elif words[0] == "element":
            elements.append((words[1], int(words[2]), []))
        elif words[0] == "property":
            elements[-1][2].append((words[-1], words[1:-1]))
    return form, elements, data[end + len(b"end_header\n"):]


def read(data):
    """The file in these bytes. Only triangles are accepted as faces, and no byte may be left over."""
    form, elements, body = _header(data)
    if form == "ascii":
        return _read_ascii(Ply(form), elements, body)
    if form not in ENDIAN:
        raise Malformed(f"format {form}")
    ply, offset = Ply(form), 0
    for name, count, properties in elements:
        if name == "vertex":
            offset = _read_columns(ply, count, properties, ENDIAN[form], body, offset)
        elif name == "face":
            offset = _read_triangles(ply, count, properties, ENDIAN[form], body, offset)
        elif count:
            raise Malformed(f"element {name}")
    if offset != len(body):
        raise Malformed(f"{len(body) - offset} bytes left over")
    return ply


def _read_columns(ply, count, properties, endian, body, offset):
    record = struct.Struct(endian + "".join(TYPES[kind[0]] for _, kind in properties))
    end = offset + record.size * count
    if end > len(body):
        raise Malformed("the vertices are cut off")
    columns = list(zip(*record.iter_unpack(body[offset:end]))) if count else [()] * len(properties)
    for (name, kind), column in zip(properties, columns):
        ply.types[name], ply.columns[name] = kind[0], column
    return end


def _read_triangles(ply, count, properties, endian, body, offset):
    if len(properties) != 1 or properties[0][1][0] != "list" or properties[0][0] not in ("vertex_indices", "vertex_index"):
        raise Malformed("faces are not lists of vertices alone")
    _, size, index = properties[0][1]
    record = struct.Struct(endian + TYPES[size] + 3 * TYPES[index])
    end = offset + record.size * count
    if end > len(body):
        raise Malformed("the faces are cut off, or no triangles")
    ply.triangles = []
    for corners, a, b, c in record.iter_unpack(body[offset:end]):
        if corners != 3:
            raise Malformed("a face is no triangle")
        ply.triangles.append((a, b, c))
    return end


def _read_ascii(ply, elements, body):
    words, at = body.split(), 0
    for name, count, properties in elements:
        if name == "vertex":
            width = len(properties)
            if at + width * count > len(words):
                raise Malformed("the vertices are cut off")
            for place, (title, kind) in enumerate(properties):
                convert = (lambda word, k=kind[0]: round_to(k, float(word))) if TYPES[kind[0]] in "fd" else int
                ply.types[title] = kind[0]
                ply.columns[title] = [convert(word) for word in words[at + place:at + width * count:width]]
            at += width * count
        elif name == "face":
            corners = [int(word) for word in words[at:at + 4 * count]]
            if len(corners) != 4 * count or any(n != 3 for n in corners[::4]):
                raise Malformed("the faces are cut off, or no triangles")
            ply.triangles = list(zip(corners[1::4], corners[2::4], corners[3::4]))
            at += 4 * count
    if at != len(words):
        raise Malformed("words left over")
    return ply


def round_to(kind, value):
    """The value as the type holds it; float overflows become infinities, as a cast would have it."""
    if TYPES[kind] == "d":
        return float(value)
    if TYPES[kind] == "f":
        try:
            return struct.unpack("<f", struct.pack("<f", value))[0]
        except OverflowError:
            return float("inf") if value > 0 else float("-inf")
    return int(value)


def write(properties, rows, form="binary_little_endian", triangles=None):
    """A file with these properties, [[name, type], ...], one row a vertex."""
    head = ["ply", f"format {form} 1.0", f"element vertex {len(rows)}"]
    head += [f"property {kind} {name}" for name, kind in properties]
    if triangles is not None:
        head += [f"element face {len(triangles)}", "property list uchar int vertex_indices"]
    text = ("\n".join(head + ["end_header"]) + "\n").encode("latin-1")
    if form == "ascii":
        lines = [" ".join(repr(v) for v in row) for row in rows] + [f"3 {a} {b} {c}" for a, b, c in triangles or []]
        return text + "".join(line + "\n" for line in lines).encode()
    record = struct.Struct(ENDIAN[form] + "".join(TYPES[kind] for _, kind in properties))
    face = struct.Struct(ENDIAN[form] + "Biii")
    return text + b"".join(record.pack(*row) for row in rows) + b"".join(face.pack(3, *t) for t in triangles or [])
