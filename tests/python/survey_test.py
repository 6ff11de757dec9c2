"""Scans in survey coordinates: LAS and LAZ, and what becomes of their digits."""
import pathlib
import struct

from common import Case, np, ps, sphere, unittest

FILES = pathlib.Path(__file__).resolve().parents[1] / "data" / "formats"
SCALE = 0.001
CENTRE = np.array([500000.0, 4649776.0, 250.0])


def las(points, offset, minor=2, scale=SCALE):
    """Points of the format 0 as LAS 1.2, or 6 as 1.4, written by the standard."""
    format_, record = (0, struct.Struct("<3iHBBbBH")) if minor < 4 else (6, struct.Struct("<3iHBBBBhHd"))
    size = 227 if minor < 4 else 375
    whole = np.round((points - offset) / scale).astype(np.int64)
    head = struct.pack("<4sHHIHH8sBB32s32sHHHIIBHI5I", b"LASF", 0, 0, 0, 0, 0, b"", 1, minor, b"", b"", 1, 2020, size, size, 0,
                       format_, record.size, len(points), *([0] * 5))
    head += struct.pack("<12d", scale, scale, scale, *offset, *np.stack([points.max(axis=0), points.min(axis=0)], axis=1).ravel())
    if minor == 4:
        head += struct.pack("<QQIQ15Q", 0, 0, 0, len(points), *([0] * 15))
    if minor < 4:
        rows = [record.pack(*row, 7, 0b001001, 2, -5, 0, 3) for row in whole]
    else:
        rows = [record.pack(*row, 7, 0x11, 0, 40, 0, -1000, 3, 12.5) for row in whole]
    return head + b"".join(rows)


class Survey(Case):
    def saved(self, name, data):
        path = self.file(name)
        with open(path, "wb") as out:
            out.write(data)
        return path

    def ball(self, count=20000):
        """Points on a ball of 10 m, on the grid of the file."""
        points, _ = sphere(count, 10.0, CENTRE, np.float64)
        return np.round(points / SCALE) * SCALE

    def test_points_keep_their_last_digit(self):
        points = self.ball()
        for minor in (0, 1, 2, 3, 4):
            size = {3: 235}.get(minor)
            data = las(points, np.array([499000.0, 4649000.0, 0.0]), minor)
            if size:  # LAS 1.3 has eight bytes more in its header
                data = data[:94] + struct.pack("<HI", size, size) + data[100:227] + bytes(8) + data[227:]
            cloud = ps.read(self.saved("a.las", data))
            self.assertLess(np.abs(cloud.points - points).max(), 0.05 * SCALE)
            self.assertEqual(cloud.attributes["classification"][0], 2 if minor < 4 else 40)
            self.assertEqual(cloud.attributes["intensity"][0], 7)
            self.assertAlmostEqual(float(cloud.attributes["scan_angle"][0]), -5 if minor < 4 else -6, places=5)

    def test_a_tile_of_kilometres_keeps_its_digits_around_its_middle(self):
        random = np.random.default_rng(5)
        points = np.round((CENTRE + random.uniform(-500, 500, (5000, 3))) / SCALE) * SCALE
        for offset in (np.zeros(3), np.array([499000.0, 4649000.0, 0.0])):
            cloud = ps.read(self.saved("a.las", las(points, offset)) if np.abs(points - offset).max() < 2**31 * SCALE else
                            self.saved("a.las", las(points, offset, scale=SCALE * 4)))
            self.assertLess(np.abs(cloud.points - points).max(), 0.1 * SCALE + (0 if offset.any() else 2 * SCALE))

    def test_the_mesh_lies_where_the_points_are_to_a_tenth_of_a_millimetre(self):
        points = self.ball()
        path = self.saved("a.las", las(points, np.array([499000.0, 4649000.0, 0.0])))
        out = self.file("m.ply")
        self.program("reconstruct", path, "--estimate-normals", "-o", out, "--depth", 6, "-q")
        mesh = ps.read(out)
        local = ps.reconstruct(ps.orient(ps.Cloud(points - CENTRE)), depth=6)
        self.assertEqual(len(mesh.vertices), len(local.vertices))
        self.assertLess(np.abs(mesh.vertices - CENTRE - local.vertices).max(), 1e-4)

    def test_scans_with_different_offsets_merge(self):
        points = self.ball()
        whole = self.saved("whole.las", las(points, np.array([499000.0, 4649000.0, 0.0])))
        parts = [self.saved("a.las", las(points[::2], np.array([500000.0, 4650000.0, 100.0]))),
                 self.saved("b.las", las(points[1::2], np.array([498000.0, 4649500.0, -50.0]), 4))]
        meshes = []
        for name, given in (("one.ply", [whole]), ("two.ply", parts)):
            self.program("reconstruct", *given, "--estimate-normals", "-o", self.file(name), "--depth", 6, "-q")
            meshes.append(ps.read(self.file(name)))
        self.assertEqual(len(meshes[0].vertices), len(meshes[1].vertices))
        self.assertLess(np.abs(meshes[0].vertices - meshes[1].vertices).max(), 1e-4)

    def test_compressed_points_are_those_of_the_same_file_not_compressed(self):
        for name in ("format3", "format8"):
            plain, packed = ps.read(FILES / f"{name}.las"), ps.read(FILES / f"{name}.laz")
            np.testing.assert_array_equal(plain.points, packed.points)
            self.assertEqual(list(plain.attributes), list(packed.attributes))
            for attribute in plain.attributes:
                np.testing.assert_array_equal(plain.attributes[attribute], packed.attributes[attribute], attribute)
            self.assertTrue({"reflectance", "echo", "gps_time", "red"} <= set(plain.attributes))
            reflectance = plain.attributes["reflectance"]
            self.assertTrue(((reflectance >= 5) & (reflectance <= 35)).all() and len(set(reflectance)) > 100)

    def test_broken_files_are_refused(self):
        for name in ("format3.las", "format3.laz", "format8.laz"):
            data = (FILES / name).read_bytes()
            for end in range(0, len(data) - 8, 7):
                with self.assertRaises(ps.InvalidInputError, msg=f"{name} cut at {end}"):
                    ps.read(self.saved("a" + name[-4:], data[:end]))
            random = np.random.default_rng(11)
            for _ in range(300):  # whatever is changed: an answer, no crash
                wrong = bytearray(data)
                for place in random.integers(0, len(data), 3):
                    wrong[place] = random.integers(0, 256)
                try:
                    ps.read(self.saved("a" + name[-4:], bytes(wrong)))
                except (ps.InvalidInputError, ps.OverLimitError):
                    pass


if __name__ == "__main__":
    unittest.main()
