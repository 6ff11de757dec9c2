"""Makes the seeds of fuzz_read_cloud and fuzz_read_mesh: a small file of every format, behind the byte that picks it. Those of
fuzz_mesh_parts are the PLY files alone, those of fuzz_cloud_parts PLY, text and NPY.

    POINTSKIN_PROGRAM=build/bin/pointskin python3 tests/fuzz/make_seeds.py tests/fuzz/corpus

Run it where all formats are built in, and again when the table of formats changes its order. python3-vtk9 and numpy make
files that the program does not write."""
import gzip
import os
import pathlib
import re
import struct
import subprocess
import sys
import tempfile

import numpy as np

PROGRAM = os.environ.get("POINTSKIN_PROGRAM", "build/bin/pointskin")
FILES = pathlib.Path(__file__).resolve().parents[1] / "data" / "formats"
BIG_PLY = (b"ply\nformat binary_big_endian 1.0\nelement mark 1\nproperty uchar m\nelement vertex 4\nproperty double z\nproperty ushort x\n"
           b"property float y\nelement face 4\nproperty uchar kind\nproperty list uint ushort vertex_index\nproperty float w\nend_header\n"
           + b"m" + b"".join(struct.pack(">dHf", z, x, y) for x, y, z in ((0, 0, 0), (1, 0, 0), (0, 1, 0), (0, 0, 1)))
           + b"".join(struct.pack(">BIHHHf", 1, 3, *t, 0.5) for t in ((0, 2, 1), (0, 1, 3), (0, 3, 2), (1, 2, 3))))
MESH = """ply
format ascii 1.0
element vertex 4
property float x
property float y
property float z
property float nx
property float ny
property float nz
property uchar red
property uchar green
property uchar blue
property short label
element face 4
property list uchar int vertex_indices
end_header
0 0 0 -1 0 0 1 2 3 -4
1 0 0 1 0 0 250 0 9 7
0 1 0 0 1 0 7 7 7 7
0 0 1 0 0 1 0 255 0 1
3 0 2 1
3 0 1 3
3 1 2 3
3 2 0 3
"""
PCD = """# .PCD v0.7
VERSION 0.7
FIELDS x y z rgb
SIZE 4 4 4 4
TYPE F F F F
COUNT 1 1 1 1
WIDTH 2
HEIGHT 1
VIEWPOINT 0 0 0 1 0 0 0
POINTS 2
DATA ascii
0 1 2 4.2108e+06
3 4 nan 4.808e+06
"""
VTK = """# vtk DataFile Version 5.1
cells
ASCII
DATASET UNSTRUCTURED_GRID
POINTS 4 float
0 0 0 1 0 0 0 1 0 1 1 0
CELLS 3 6
OFFSETS vtktypeint64
0 4 6
CONNECTIVITY vtktypeint64
0 1 2 3 0 1
CELL_TYPES 2
8
3
POINT_DATA 4
SCALARS id int 1
LOOKUP_TABLE default
1 2 3 4
NORMALS n float
0 0 1 0 0 1 0 0 1 0 0 1
"""


def indices():
    """Extension to the byte that picks its format."""
    table = subprocess.run([PROGRAM, "formats", "--markdown"], check=True, capture_output=True, text=True).stdout
    rows = [line for line in table.splitlines() if line.startswith("| ") and re.search(r"\| \.", line)]
    return {extension: row for row, line in enumerate(rows) for extension in line.split("|")[2].split()}


def vtk_files(folder):
    """The same tetrahedron by VTK, in its codings."""
    import vtk
    reader = vtk.vtkPLYReader()
    reader.SetFileName(str(folder / "mesh.ply"))
    for writer, name in ((vtk.vtkXMLPolyDataWriter(), "binary.vtp"), (vtk.vtkXMLPolyDataWriter(), "ascii.vtp"),
                         (vtk.vtkPolyDataWriter(), "binary.vtk")):
        writer.SetInputConnection(reader.GetOutputPort())
        writer.SetFileName(str(folder / name))
        if name == "ascii.vtp":
            writer.SetDataModeToAscii()
        elif name == "binary.vtp":
            writer.SetDataModeToBinary()
        else:
            writer.SetFileTypeToBinary()
        writer.Write()


def make(folder):
    (folder / "mesh.ply").write_text(MESH)
    for name in ("binary.ply", "mesh.obj", "mesh.stl", "mesh.off", "mesh.glb", "mesh.vtp", "mesh.vtu", "mesh.npz"):
        subprocess.run([PROGRAM, "convert", str(folder / "mesh.ply"), str(folder / name), "-q"], check=True)
    for name, option in (("small.glb", "--compress"), ("double.ply", "--double")):
        subprocess.run([PROGRAM, "convert", str(folder / "mesh.ply"), str(folder / name), option, "-q"], check=True)
    (folder / "big.ply").write_bytes(BIG_PLY)
    (folder / "mesh.gltf").write_text('{"asset":{"version":"2.0"},"meshes":[{"primitives":[{"attributes":{"POSITION":0}}]}],'
                                      '"accessors":[{"bufferView":0,"componentType":5126,"type":"VEC3","count":1}],'
                                      '"bufferViews":[{"buffer":0,"byteLength":12}],"buffers":[{"byteLength":12,'
                                      '"uri":"data:application/octet-stream;base64,AACAPwAAAEAAAEBA"}]}')
    points = np.arange(12, dtype=np.float32).reshape(4, 3)
    np.save(folder / "points.npy", points)
    np.save(folder / "table.npy", np.zeros(2, dtype=[("x", "<f8"), ("y", ">f4"), ("z", "<f4"), ("rgb", "u1", (3,))]))
    np.savez_compressed(folder / "packed.npz", vertices=points, faces=np.array([[0, 1, 2]], dtype=np.int64))
    np.hstack([points, points]).tofile(folder / "a.bnpts")
    points.tofile(folder / "floats.xyz")
    (folder / "text.csv").write_text("x,y,z,nx,ny,nz,label\n0,0,0,1,0,0,7\n1,2,3e-2,0,1,0,-1\n")
    (folder / "points.json").write_text("[[0,1,2],[3,4.5,-6e-1]]")
    (folder / "a.pcd").write_text(PCD)
    (folder / "cells.vtk").write_text(VTK)
    for file in FILES.iterdir():
        if file.suffix in (".las", ".laz", ".e57", ".ptx", ".bgeo"):
            (folder / file.name).write_bytes(file.read_bytes())
    (folder / "packed.bgeo").write_bytes(gzip.compress((FILES / "partio.bgeo").read_bytes(), mtime=0))
    vtk_files(folder)


def main():
    out = pathlib.Path(sys.argv[1])
    picks = indices()
    with tempfile.TemporaryDirectory() as name:
        folder = pathlib.Path(name)
        make(folder)
        for program in ("fuzz_read_cloud", "fuzz_read_mesh"):
            (out / program).mkdir(parents=True, exist_ok=True)
            for file in sorted(folder.iterdir()):
                if program == "fuzz_read_mesh" and file.suffix not in (".ply", ".obj", ".stl", ".off", ".glb", ".gltf", ".vtk", ".vtp",
                                                                       ".vtu", ".npz"):
                    continue
                seed = bytes([picks[file.suffix]]) + file.read_bytes()
                if len(seed) <= 8192:
                    (out / program / file.name.replace(".", "_")).write_bytes(seed)
        for program, suffixes in (("fuzz_mesh_parts", (".ply",)), ("fuzz_cloud_parts", (".ply", ".xyz", ".csv", ".npy"))):
            (out / program).mkdir(parents=True, exist_ok=True)
            for file in sorted(folder.iterdir()):
                if file.suffix in suffixes:
                    (out / program / file.name.replace(".", "_")).write_bytes(file.read_bytes())


if __name__ == "__main__":
    main()
