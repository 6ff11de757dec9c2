"""Files of other programs, read back equal, and ours read by them: numpy and Open3D."""
import gzip
import pathlib
import shutil
import struct
import subprocess
import xml.etree.ElementTree
import zipfile

from common import Case, has, np, ps, sphere, unittest

FILES = pathlib.Path(__file__).resolve().parents[1] / "data" / "formats"


def noise(count, seed=1):
    """Points and normals without symmetry, and colours."""
    random = np.random.default_rng(seed)
    points = random.normal(size=(count, 3)).astype(np.float32)
    normals = points / np.linalg.norm(points, axis=1, keepdims=True)
    return points, normals.astype(np.float32), random.integers(0, 256, (count, 3), dtype=np.uint8)


class Numpy(Case):
    def saved(self, name, array=None, **arrays):
        path = self.file(name)
        if array is not None:
            np.save(path, array)
        elif arrays.pop("compressed", False):
            np.savez_compressed(path, **arrays)
        else:
            np.savez(path, **arrays)
        return path

    def test_an_array_of_points(self):
        points, normals, colours = noise(1000)
        for made in (points, points.astype(np.float64), np.asfortranarray(points), points.astype(">f4"), points.astype(">f8")):
            cloud = ps.read(self.saved("a.npy", made))
            np.testing.assert_array_equal(cloud.local_points + cloud.origin, points)
            self.assertIsNone(cloud.normals)
        cloud = ps.read(self.saved("a.npy", np.hstack([points, normals])))
        np.testing.assert_array_equal(cloud.normals, normals)
        cloud = ps.read(self.saved("a.npy", np.hstack([points, colours])))
        np.testing.assert_array_equal(cloud.attributes["rgb"], colours)
        cloud = ps.read(self.saved("a.npy", np.hstack([points, colours, normals])))
        np.testing.assert_array_equal(cloud.attributes["rgb"], colours)
        np.testing.assert_array_equal(cloud.normals, normals)

    def test_a_structured_array(self):
        points, normals, colours = noise(500)
        layout = [("X", "<f8"), ("Y", "<f8"), ("Z", "<f8"), ("normal", "<f4", (3,)), ("colour", "u1", (3,)), ("id", ">i8")]
        made = np.zeros(500, dtype=np.dtype(layout, align=False))
        for axis, name in enumerate("XYZ"):
            made[name] = points[:, axis] + 5e5
        made["normal"], made["colour"], made["id"] = normals, colours, np.arange(500) - 2**60
        cloud = ps.read(self.saved("a.npy", made))
        np.testing.assert_allclose(cloud.points, points + 5e5, atol=1e-6)
        np.testing.assert_array_equal(cloud.normals, normals)
        np.testing.assert_array_equal(cloud.attributes["rgb"], colours)
        np.testing.assert_array_equal(cloud.attributes["id"], made["id"])
        aligned = np.zeros(500, dtype=np.dtype({"names": ["x", "y", "z", "t"], "formats": ["f4", "f4", "f4", "f8"],
                                                "offsets": [0, 4, 8, 16], "itemsize": 24}))
        for axis, name in enumerate("xyz"):
            aligned[name] = points[:, axis]
        aligned["t"] = np.arange(500) / 7
        cloud = ps.read(self.saved("a.npy", aligned))
        np.testing.assert_array_equal(cloud.points, points)
        np.testing.assert_array_equal(cloud.attributes["t"], aligned["t"])
        self.assertEqual(list(cloud.attributes), ["t"])

    def test_archives(self):
        points, normals, colours = noise(700)
        for compressed in (False, True):
            path = self.saved("a.npz", compressed=compressed, points=points.astype(np.float64), normals=normals,
                              colors=colours / 255.0, label=np.arange(700, dtype=np.int32), camera=np.eye(4))
            cloud = ps.read(path)
            np.testing.assert_array_equal(cloud.points, points)
            np.testing.assert_array_equal(cloud.normals, normals)
            np.testing.assert_array_equal(cloud.attributes["rgb"], colours)
            np.testing.assert_array_equal(cloud.attributes["label"], np.arange(700))
            self.assertEqual(sorted(cloud.attributes), ["blue", "green", "label", "red"])
        cloud = ps.read(self.saved("a.npz", x=points[:, 0], y=points[:, 1], z=points[:, 2]))
        np.testing.assert_array_equal(cloud.points, points)

    def test_ours_in_numpy(self):
        points, normals = sphere(3000, centre=(431000.5, 5412000.25, 800), dtype=np.float64)
        rgb = np.random.default_rng(3).integers(0, 256, (3000, 3), dtype=np.uint8)
        mesh = ps.reconstruct(points, normals, depth=5, attributes={"rgb": rgb, "label": np.arange(3000, dtype=np.uint32) % 7})
        path = self.file("m.npz")
        mesh.save(path)
        with np.load(path) as arrays:
            self.assertEqual(sorted(arrays.files), ["faces", "label", "normals", "rgb", "vertices"])
            self.assertEqual(arrays["vertices"].dtype, np.float64)
            np.testing.assert_array_equal(arrays["vertices"], mesh.vertices)
            np.testing.assert_array_equal(arrays["faces"], mesh.faces)
            np.testing.assert_array_equal(arrays["rgb"], mesh.attributes["rgb"])
            self.assertEqual(arrays["label"].dtype, np.uint32)
        again = ps.read(path)
        self.assertIsInstance(again, ps.Mesh)
        np.testing.assert_array_equal(again.faces, mesh.faces)
        np.testing.assert_allclose(again.vertices, mesh.vertices, atol=1e-5)
        cloud = ps.Cloud(points, normals, {"rgb": rgb})
        cloud.save(path)
        with np.load(path) as arrays:
            self.assertEqual(sorted(arrays.files), ["normals", "points", "rgb"])
            np.testing.assert_array_equal(arrays["points"], cloud.points)


class Floats(Case):
    def test_of_poissonrecon(self):
        points, normals, _ = noise(100)
        path = self.file("a.bnpts")
        np.hstack([points, normals]).astype("<f4").tofile(path)
        cloud = ps.read(path)
        np.testing.assert_array_equal(cloud.points, points)
        np.testing.assert_array_equal(cloud.normals, normals)
        with open(path, "ab") as more:
            more.write(b"\0")
        with self.assertRaisesRegex(ps.InvalidInputError, "truncated"):
            ps.read(path)

    def test_of_splashsurf(self):
        points, _, _ = noise(100)
        path = self.file("a.xyz")
        points.astype("<f4").tofile(path)
        np.testing.assert_array_equal(ps.read(path).points, points)
        np.savetxt(path, points, fmt="%.9g")
        np.testing.assert_allclose(ps.read(path).points, points, rtol=1e-7)


def pcd(fields, sizes, types, counts, rows, kind, body):
    """A file as the Point Cloud Library writes it."""
    head = ["# .PCD v0.7 - Point Cloud Data file format", "VERSION 0.7", f"FIELDS {fields}", f"SIZE {sizes}", f"TYPE {types}",
            f"COUNT {counts}", f"WIDTH {rows}", "HEIGHT 1", "VIEWPOINT 0 0 0 1 0 0 0", f"POINTS {rows}", f"DATA {kind}", ""]
    return "\n".join(head).encode() + body


class Pcd(Case):
    def read(self, data):
        path = self.file("a.pcd")
        with open(path, "wb") as out:
            out.write(data)
        return ps.read(path)

    @unittest.skipUnless(has("open3d"), "needs python3-open3d")
    def test_of_open3d_in_all_encodings(self):
        import open3d
        points, normals, colours = noise(2000)
        cloud = open3d.geometry.PointCloud(open3d.utility.Vector3dVector(points))
        cloud.normals = open3d.utility.Vector3dVector(normals)
        cloud.colors = open3d.utility.Vector3dVector(colours / 255.0)
        for options in ({"write_ascii": True}, {}, {"compressed": True}):
            path = self.file("o.pcd")
            self.assertTrue(open3d.io.write_point_cloud(path, cloud, **options))
            found = ps.read(path)
            np.testing.assert_allclose(found.points, points, rtol=1e-6)
            np.testing.assert_allclose(found.normals, normals, atol=1e-6)
            np.testing.assert_array_equal(found.attributes["rgb"], colours)

    def test_padding_histograms_and_labels(self):
        row = struct.pack("<3f4BdI2f", 1.5, -2, 3, 0, 0, 0, 0, 1e9, 77, 0.25, 0.5)
        cloud = self.read(pcd("x y z _ t label fpfh", "4 4 4 1 8 4 4", "F F F U F U F", "1 1 1 4 1 1 2", 3, "binary", 3 * row))
        np.testing.assert_array_equal(cloud.points, [[1.5, -2, 3]] * 3)
        self.assertEqual(sorted(cloud.attributes), ["fpfh_0", "fpfh_1", "label", "t"])
        np.testing.assert_array_equal(cloud.attributes["label"], [77] * 3)
        np.testing.assert_array_equal(cloud.attributes["fpfh"], [[0.25, 0.5]] * 3)
        self.assertEqual(cloud.attributes["t"][0], 1e9)

    def test_organised_scans_have_holes(self):
        body = b"nan nan nan 4.2108e+06\n1 2 3 2.3418052e-38\n"
        with self.assertWarnsRegex(ps.PointskinWarning, "1 points were left out"):
            cloud = self.read(pcd("x y z rgb", "4 4 4 4", "F F F F", "1 1 1 1", 2, "ascii", body))
        self.assertEqual((len(cloud), cloud.dropped), (1, 1))
        self.assertEqual(list(cloud.attributes["rgb"][0]), list(np.float32(2.3418052e-38).tobytes()[2::-1]))

    def test_survey_coordinates_in_text_keep_their_digits(self):
        body = b"431000.123 5412345.678 812.345\n431001.5 5412346.25 812\n"
        cloud = self.read(pcd("x y z", "4 4 4", "F F F", "1 1 1", 2, "ascii", body))
        np.testing.assert_allclose(cloud.points[0], [431000.123, 5412345.678, 812.345], atol=1e-6)

    def test_broken_files_are_refused(self):
        row = struct.pack("<3f", 1, 2, 3)
        good = ("x y z", "4 4 4", "F F F", "1 1 1", 2, "binary", 2 * row)
        self.assertEqual(len(self.read(pcd(*good))), 2)
        data = pcd(*good)
        for end in range(len(data)):
            with self.assertRaises(ps.PointskinError, msg=f"cut at {end}"):
                if len(self.read(data[:end])) > 0:
                    raise AssertionError(f"{end} of {len(data)} bytes are enough")
        for change in ((b"SIZE 4 4 4", b"SIZE 4 4 3"), (b"SIZE 4 4 4", b"SIZE 4 4"), (b"TYPE F F F", b"TYPE F F Q"),
                       (b"POINTS 2", b"POINTS 2000000000"), (b"POINTS 2", b"POINTS -1"), (b"COUNT 1 1 1", b"COUNT 1 1 99999999"),
                       (b"FIELDS x y z", b"FIELDS x y y"), (b"FIELDS x y z", b"FIELDS a b c"), (b"DATA binary", b"DATA zstd"),
                       (b"DATA binary", b"DATA binary_compressed"), (b"DATA binary", b"DATA ascii")):
            with self.assertRaises(ps.InvalidInputError, msg=str(change)):
                self.read(data.replace(*change))


@unittest.skipUnless(has("vtkmodules") or has("vtk"), "needs python3-vtk9")
class Vtk(Case):
    """VTK's XML files: all that VTK writes is read, and ours is read by it."""

    def data(self, grid):
        """A sphere with normals, colours, a label and a time; of a grid, triangles, a quad, a pixel and a strip as well."""
        import vtk
        from vtk.util.numpy_support import numpy_to_vtk
        source = vtk.vtkSphereSource()
        source.SetThetaResolution(24)
        source.SetPhiResolution(16)
        source.Update()
        made = source.GetOutput()
        count = made.GetNumberOfPoints()
        random = np.random.default_rng(4)
        for name, values in (("RGB", random.integers(0, 256, (count, 3), dtype=np.uint8)), ("time", random.random(count)),
                             ("label", np.arange(count, dtype=np.int64) - 2**40), ("velocity", random.random((count, 3)).astype("f4"))):
            array = numpy_to_vtk(values, deep=True)
            array.SetName(name)
            made.GetPointData().AddArray(array)
        if not grid:
            return made
        append = vtk.vtkAppendFilter()
        append.AddInputData(made)
        append.Update()
        return append.GetOutput()

    def check(self, path, made, name):
        from vtk.util.numpy_support import vtk_to_numpy
        mesh = ps.read(path)
        points = vtk_to_numpy(made.GetPoints().GetData())
        corners = []
        for cell in range(made.GetNumberOfCells()):
            ids = made.GetCell(cell).GetPointIds()
            corners.append([ids.GetId(i) for i in range(3)])
        np.testing.assert_allclose(mesh.vertices, points, atol=1e-6, err_msg=name)
        np.testing.assert_array_equal(mesh.faces, corners, err_msg=name)
        data = made.GetPointData()
        np.testing.assert_allclose(mesh.normals, vtk_to_numpy(data.GetArray("Normals")), atol=1e-6, err_msg=name)
        np.testing.assert_array_equal(mesh.attributes["rgb"], vtk_to_numpy(data.GetArray("RGB")), err_msg=name)
        np.testing.assert_array_equal(mesh.attributes["label"], vtk_to_numpy(data.GetArray("label")), err_msg=name)
        np.testing.assert_allclose(mesh.attributes["time"], vtk_to_numpy(data.GetArray("time")), atol=1e-7, err_msg=name)
        for axis in range(3):
            np.testing.assert_allclose(mesh.attributes["velocity_" + "xyz"[axis]], vtk_to_numpy(data.GetArray("velocity"))[:, axis],
                                       atol=1e-6, err_msg=name)

    def test_vtks_in_every_coding(self):
        import vtk
        for grid, writer, extension in ((False, vtk.vtkXMLPolyDataWriter(), "vtp"), (True, vtk.vtkXMLUnstructuredGridWriter(), "vtu")):
            made = self.data(grid)
            writer.SetInputData(made)
            for mode in ("Ascii", "Binary", "Appended"):
                for compressor in ("None", "ZLib"):
                    for wide in (False, True):
                        for encoded in (False, True):
                            getattr(writer, f"SetDataModeTo{mode}")()
                            getattr(writer, f"SetCompressorTypeTo{compressor}")()
                            (writer.SetHeaderTypeToUInt64 if wide else writer.SetHeaderTypeToUInt32)()
                            writer.SetByteOrder(0 if wide else 1)
                            writer.SetEncodeAppendedData(encoded)
                            writer.SetBlockSize(4096)
                            writer.SetFileName(self.file(f"a.{extension}"))
                            self.assertEqual(writer.Write(), 1)
                            self.check(self.file(f"a.{extension}"), made, f"{extension} {mode} {compressor} {wide} {encoded}")

    def test_legacy_files_in_every_coding(self):
        import vtk
        for grid, writer in ((False, vtk.vtkPolyDataWriter()), (True, vtk.vtkUnstructuredGridWriter())):
            made = self.data(grid)
            writer.SetInputData(made)
            writer.SetFileName(self.file("a.vtk"))
            for version in (42, 51):
                for coding in ("ASCII", "Binary"):
                    writer.SetFileVersion(version)
                    getattr(writer, f"SetFileTypeTo{coding}")()
                    self.assertEqual(writer.Write(), 1)
                    self.check(self.file("a.vtk"), made, f"{grid} {version} {coding}")

    def test_other_cells(self):
        import vtk
        grid = vtk.vtkUnstructuredGrid()
        points = vtk.vtkPoints()
        for x, y in ((0, 0), (1, 0), (0, 1), (1, 1), (0, 2), (1, 2)):
            points.InsertNextPoint(x, y, 0)
        grid.SetPoints(points)
        grid.InsertNextCell(vtk.VTK_PIXEL, 4, [0, 1, 2, 3])
        grid.InsertNextCell(vtk.VTK_TRIANGLE_STRIP, 4, [2, 3, 4, 5])
        grid.InsertNextCell(vtk.VTK_QUAD, 4, [0, 1, 3, 2])
        grid.InsertNextCell(vtk.VTK_VERTEX, 1, [5])
        for writer, name in ((vtk.vtkXMLUnstructuredGridWriter(), "a.vtu"), (vtk.vtkUnstructuredGridWriter(), "a.vtk")):
            writer.SetInputData(grid)
            writer.SetFileName(self.file(name))
            writer.Write()
            faces = ps.read(self.file(name)).faces
            np.testing.assert_array_equal(faces, [[0, 1, 3], [0, 3, 2], [2, 3, 4], [4, 3, 5], [0, 1, 3], [0, 3, 2]])

    def test_strips_of_polygons(self):
        import vtk
        source = vtk.vtkSphereSource()
        stripper = vtk.vtkStripper()
        stripper.SetInputConnection(source.GetOutputPort())
        stripper.Update()
        triangles = vtk.vtkTriangleFilter()
        triangles.SetInputConnection(stripper.GetOutputPort())
        triangles.Update()
        expected = [[triangles.GetOutput().GetCell(i).GetPointId(c) for c in range(3)]
                    for i in range(triangles.GetOutput().GetNumberOfCells())]
        around = lambda faces: sorted(tuple(np.roll(face, -int(np.argmin(face)))) for face in faces)  # noqa: E731
        for writer, name in ((vtk.vtkXMLPolyDataWriter(), "a.vtp"), (vtk.vtkPolyDataWriter(), "a.vtk")):
            writer.SetInputConnection(stripper.GetOutputPort())
            writer.SetFileName(self.file(name))
            writer.Write()
            self.assertEqual(around(ps.read(self.file(name)).faces), around(expected), name)

    def test_ours_in_vtk(self):
        import vtk
        from vtk.util.numpy_support import vtk_to_numpy
        points, normals = sphere(2000, centre=(500000, 4649000, 100), dtype=np.float64)
        rgb = np.random.default_rng(2).integers(0, 256, (2000, 3), dtype=np.uint8)
        mesh = ps.reconstruct(points, normals, depth=4, attributes={"rgb": rgb, "a<b": np.arange(2000, dtype=np.int16)})
        cloud = ps.Cloud(points, normals, {"rgb": rgb})
        for reader, extension in ((vtk.vtkXMLPolyDataReader(), "vtp"), (vtk.vtkXMLUnstructuredGridReader(), "vtu")):
            for ours in (mesh, cloud):
                ours.save(self.file(f"a.{extension}"))
                reader.SetFileName(self.file(f"a.{extension}"))
                reader.Modified()
                reader.Update()
                found = reader.GetOutput()
                places = mesh.vertices if ours is mesh else cloud.points
                np.testing.assert_array_equal(vtk_to_numpy(found.GetPoints().GetData()), places)
                np.testing.assert_array_equal(vtk_to_numpy(found.GetPointData().GetArray("RGB")), ours.attributes["rgb"])
                np.testing.assert_array_equal(vtk_to_numpy(found.GetPointData().GetNormals()), ours.normals)
                self.assertEqual(found.GetNumberOfCells(), len(mesh.faces) if ours is mesh else len(points))
                again = ps.read(self.file(f"a.{extension}"))
                np.testing.assert_allclose(again.vertices if ours is mesh else again.points, places, atol=1e-6)
                if ours is mesh:
                    np.testing.assert_array_equal(again.faces, mesh.faces)
                    np.testing.assert_array_equal(again.attributes["a<b"], mesh.attributes["a<b"])

    def test_broken_files_are_refused(self):
        import vtk
        points, normals = sphere(300)
        for extension in ("vtp", "vtu", "vtk"):
            path = self.file(f"a.{extension}")
            if extension == "vtk":
                writer = vtk.vtkUnstructuredGridWriter()
                writer.SetInputData(self.data(True))
                writer.SetFileName(path)
                writer.Write()
            else:
                ps.reconstruct(points, normals, depth=3).save(path)
            with open(path, "rb") as file:
                data = file.read()
            random = np.random.default_rng(6)
            for trial in range(400):
                wrong = bytearray(data if trial % 2 else data[:random.integers(0, len(data) - 40)])
                for place in random.integers(0, max(1, len(wrong)), 2 if trial % 2 else 0):
                    wrong[place] = random.integers(0, 256)
                with open(path, "wb") as file:
                    file.write(wrong)
                try:
                    ps.read(path)
                    self.assertEqual(trial % 2, 1, f"{len(wrong)} of {len(data)} bytes are enough")
                except ps.InvalidInputError:
                    pass


@unittest.skipUnless(shutil.which("assimp"), "needs assimp-utils")
class Printing(Case):
    def test_3mf_in_assimp(self):
        points, normals = sphere(2000)
        rgb = np.random.default_rng(2).integers(0, 256, (2000, 3), dtype=np.uint8)
        mesh = ps.reconstruct(points, normals, depth=4, attributes={"rgb": rgb})
        mesh.save(self.file("a.3mf"))
        subprocess.run(["assimp", "export", self.file("a.3mf"), self.file("a.ply")], check=True, stdout=subprocess.DEVNULL)
        found = ps.read(self.file("a.ply"))
        corners = lambda m: np.sort(m.vertices[m.faces].reshape(-1, 9), axis=0)
        np.testing.assert_allclose(corners(found), corners(mesh), atol=1e-5)

    def test_3mf_has_colours_and_says_what_is_closed(self):
        points, normals = sphere(2000)
        rgb = np.random.default_rng(2).integers(0, 256, (2000, 3), dtype=np.uint8)
        names = {"": "http://schemas.microsoft.com/3dmanufacturing/core/2015/02",
                 "m": "http://schemas.microsoft.com/3dmanufacturing/material/2015/02"}
        for keep, kind in ((slice(None), "model"), (slice(1, None), "surface")):
            mesh = ps.reconstruct(points, normals, depth=4, attributes={"rgb": rgb})
            mesh = ps.Mesh(mesh.vertices, mesh.faces[keep], attributes={"rgb": mesh.attributes["rgb"]})
            mesh.save(self.file("a.3mf"))
            with zipfile.ZipFile(self.file("a.3mf")) as archive:
                self.assertIsNone(archive.testzip())
                root = xml.etree.ElementTree.fromstring(archive.read("3D/3dmodel.model"))
            self.assertEqual(root.find(".//{*}object").get("type"), kind)
            palette = [color.get("color") for color in root.findall(".//m:color", names)]
            triangles = root.findall(".//{*}triangle")
            self.assertEqual(len(triangles), len(mesh.faces))
            for triangle, face in list(zip(triangles, mesh.faces))[::17]:
                for corner, vertex in zip(("p1", "p2", "p3"), face):
                    red, green, blue = mesh.attributes["rgb"][vertex]
                    self.assertEqual(palette[int(triangle.get(corner))], f"#{red:02X}{green:02X}{blue:02X}FF")


class Bgeo(Case):
    def test_of_partio(self):
        cloud = ps.read(FILES / "partio.bgeo")
        np.testing.assert_allclose(cloud.local_points, [[0, 0.1, 0.2], [0.1, 0.2, 0.3], [0.2, 0.3, 0.4], [0.3, 0.4, 0.5], [0.4, 0.5, 0.6]], rtol=1e-6)
        np.testing.assert_array_equal(cloud.attributes["id"], range(5))
        np.testing.assert_allclose(cloud.attributes["life"], [[life, 10] for life in (-1.2, -0.2, 0.8, 1.8, 2.8)], rtol=1e-6)

    def test_packed_by_gzip(self):
        data = (FILES / "partio.bgeo").read_bytes()
        path = self.file("a.bgeo")
        packed = gzip.compress(data)
        for cut in (0, 1, 9, 40):
            pathlib.Path(path).write_bytes(packed[:len(packed) - cut])
            if cut:
                self.assertRaises(ps.InvalidInputError, ps.read, path)
            else:
                np.testing.assert_array_equal(ps.read(path).points, ps.read(FILES / "partio.bgeo").points)

    def test_broken_files_are_refused(self):
        data = (FILES / "partio.bgeo").read_bytes()
        path = self.file("a.bgeo")
        random = np.random.default_rng(8)
        for trial in range(300):
            wrong = bytearray(data[:random.integers(0, 215)] if trial % 2 else data)
            if trial % 2 == 0:
                wrong[random.integers(0, 78)] = random.integers(0, 256)
            with open(path, "wb") as out:
                out.write(wrong)
            try:
                ps.read(path)
                self.assertEqual(trial % 2, 0, f"{len(wrong)} bytes are enough")
            except ps.InvalidInputError:
                pass


@unittest.skipUnless(has("open3d"), "needs python3-open3d")
class Meshes(Case):
    """Triangle meshes in Open3D: ours read there, its own read here."""

    def mesh(self):
        points, normals = sphere(2000)
        rgb = np.random.default_rng(2).integers(0, 256, (2000, 3), dtype=np.uint8)
        return ps.reconstruct(points, normals, depth=4, attributes={"rgb": rgb})

    def test_ours_in_open3d(self):
        import open3d
        mesh = self.mesh()
        for name, has_colours in (("a.ply", True), ("a.obj", True), ("a.off", True), ("a.glb", True), ("a.stl", False)):
            mesh.save(self.file(name))
            found = open3d.io.read_triangle_mesh(self.file(name))
            corners = np.asarray(found.vertices)[np.asarray(found.triangles)]
            np.testing.assert_allclose(corners, mesh.vertices[mesh.faces], rtol=1e-6, atol=1e-6, err_msg=name)
            if has_colours:
                colours = np.round(255 * np.asarray(found.vertex_colors))[np.asarray(found.triangles)]
                np.testing.assert_allclose(colours, mesh.attributes["rgb"][mesh.faces], atol=0.5, err_msg=name)

    def test_coordinates_in_double_on_request(self):
        mesh = self.mesh()
        for ascii in (False, True):
            mesh.save(self.file("f.ply"), ascii=ascii)
            mesh.save(self.file("d.ply"), double_coordinates=True, ascii=ascii)
            self.program("convert", self.file("f.ply"), self.file("c.ply"), "--double", *(["--ascii"] if ascii else []))
            for name, kind in (("f.ply", b"float x"), ("d.ply", b"double x"), ("c.ply", b"double x")):
                with open(self.file(name), "rb") as file:
                    self.assertIn(b"property " + kind, file.read(400), name)
                np.testing.assert_array_equal(ps.read(self.file(name)).vertices, mesh.vertices, name)

    def test_open3ds_here(self):
        import open3d
        made = open3d.geometry.TriangleMesh.create_torus(1.0, 0.4, 20, 12)
        made.compute_vertex_normals()
        vertices, faces = np.asarray(made.vertices), np.asarray(made.triangles)
        made.vertex_colors = open3d.utility.Vector3dVector(np.linspace(0, 1, 3 * len(vertices)).reshape(-1, 3))
        names = [("a.ply", {}), ("a.ply", {"write_ascii": True}), ("a.obj", {}), ("a.off", {}), ("a.stl", {}), ("a.gltf", {}), ("a.glb", {})]
        for name, options in names:
            self.assertTrue(open3d.io.write_triangle_mesh(self.file(name), made, **options), name)
            found = ps.read(self.file(name))
            np.testing.assert_allclose(found.vertices[found.faces], vertices[faces], atol=1e-5, err_msg=name)
            self.assertEqual(found.measure()["boundary_edges"], 0, name)
            if name in ("a.ply", "a.glb"):
                colours = np.asarray(made.vertex_colors)[faces]
                rgb = found.attributes["rgb"][found.faces]
                whole = 255.0 if rgb.dtype == np.uint8 else 1.0  # Open3D's GLB has floats
                np.testing.assert_allclose(rgb / whole, colours, atol=0.01, err_msg=name)


if __name__ == "__main__":
    unittest.main()
