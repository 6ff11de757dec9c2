#!/usr/bin/env python3
"""The judge of the campaign finds what is wrong: every rule is broken once."""
import math
import types
import unittest

import campaign
import clouds
import judge
import meshes
import ply

PLACES, TRIANGLES = clouds.box_mesh([0, 0, 0], [1, 2, 3])


def wrong(places=PLACES, triangles=TRIANGLES, closed=True):
    data = ply.write([[a, "double"] for a in "xyz"], places, triangles=triangles)
    return " ".join(judge.mesh(ply.read(data), closed, True))


class WhatIsJudged(unittest.TestCase):
    def test_meshes_made_of_points_have_finite_properties_only(self):
        cloud = ply.write([[n, "float"] for n in ("x", "y", "z", "heat")], [(0, 0, 0, 1), (0, 0, 1, float("nan"))])

        def doubtful(command, is_mesh):
            case = types.SimpleNamespace(points=["a"], inputs={"a": cloud}, command=lambda: command)
            return campaign.doubtful(case, is_mesh)

        for command in ("reconstruct", "edit", "deform", "boolean"):
            self.assertEqual(doubtful(command, True), set())
        for command, is_mesh in (("fluid", True), ("orient", False), ("convert", False)):
            self.assertEqual(doubtful(command, is_mesh), {"heat", "input_heat"})


class JudgeOfMeshes(unittest.TestCase):
    def test_a_box_is_right_and_has_its_volume(self):
        self.assertEqual(wrong(), "")
        self.assertAlmostEqual(judge.volume(PLACES, TRIANGLES), 6 / 27)  # in units of the longest side

    def test_a_missing_triangle_opens_it(self):
        self.assertIn("3 edges have one triangle", wrong(triangles=TRIANGLES[1:]))
        self.assertEqual(wrong(triangles=TRIANGLES[1:], closed=False), "")

    def test_a_turned_triangle_is_found(self):
        a, b, c = TRIANGLES[0]
        self.assertIn("3 edges are passed twice", wrong(triangles=[(a, c, b), *TRIANGLES[1:]]))

    def test_a_third_triangle_at_an_edge_is_found(self):
        self.assertIn("more than two triangles", wrong(triangles=[*TRIANGLES, TRIANGLES[0]]))

    def test_boxes_that_share_a_vertex_have_two_fans_there(self):
        more, again = clouds.box_mesh([1, 2, 3], [4, 4, 4])
        number = {p: k for k, p in enumerate(PLACES)}
        for p in more:
            number.setdefault(p, len(number))
        triangles = TRIANGLES + [tuple(number[more[v]] for v in t) for t in again]
        self.assertEqual(wrong(sorted(number, key=number.get), triangles), "1 vertices have more than one fan")

    def test_a_mesh_turned_inside_out_is_found(self):
        self.assertEqual(wrong(triangles=[(a, c, b) for a, b, c in TRIANGLES]), "the enclosed volume is not positive")

    def test_a_flat_mesh_is_found(self):
        self.assertEqual(wrong([(x, y, 0) for x, y, _ in PLACES]), "the enclosed volume is not positive")

    def test_numbers_that_are_not_finite_or_not_there_are_found(self):
        self.assertIn("not finite", wrong([(math.nan, 0, 0), *PLACES[1:]]))
        self.assertIn("not there", wrong(triangles=[(0, 1, 8), *TRIANGLES]))
        self.assertIn("1 vertices are not used", wrong([*PLACES, (5, 5, 5)]))
        self.assertIn("name a vertex twice", wrong(triangles=[(0, 0, 1), *TRIANGLES]))

    def test_normals_that_are_not_of_unit_length_are_found(self):
        data = ply.write([["nx", "float"], ["ny", "float"], ["nz", "float"]], [(1, 0, 0), (0, 0, 0), (0, 2, math.nan)])
        self.assertEqual(judge.normals(ply.read(data)), ["2 normals are not of unit length"])

    def test_attributes_that_are_not_finite_are_found(self):
        data = ply.read(ply.write([["x", "float"], ["heat", "float"]], [(0, math.inf)]))
        self.assertEqual(judge.attributes(data, set()), ["the property heat is not finite"])
        self.assertEqual(judge.attributes(data, {"heat"}), [])


class ReaderOfOtherMeshes(unittest.TestCase):
    def test_obj_and_off_read_as_what_they_are(self):
        obj = "".join(f"v {x} {y} {z}\n" for x, y, z in PLACES) + "".join("vn 0 0 1\n" for _ in PLACES)
        obj += "".join(f"f {a + 1}//{a + 1} {b + 1}//{b + 1} {c + 1}//{c + 1}\n" for a, b, c in TRIANGLES)
        off = "NOFF\n8 12 0\n" + "".join(f"{x} {y} {z} 0 0 1\n" for x, y, z in PLACES)
        off += "".join(f"3 {a} {b} {c}\n" for a, b, c in TRIANGLES)
        for found in (meshes.read_obj(obj.encode()), meshes.read_off(off.encode())):
            self.assertEqual(judge.mesh(found, True, True), [])
            self.assertEqual((found.count(), found.triangles), (8, TRIANGLES))
        self.assertRaises(ply.Malformed, meshes.read_off, off[:-8].encode())
        self.assertRaises(ply.Malformed, meshes.read_obj, obj.replace("f 1//1", "f 1//2").encode())

    def test_stl_and_glb_that_are_cut_off_are_found(self):
        whole = bytes(80) + (1).to_bytes(4, "little") + bytes(50)
        self.assertEqual(meshes.stl(whole), [])
        self.assertTrue(meshes.stl(whole[:-1]))
        self.assertTrue(meshes.stl(whole[:84] + b"\xff" * 50))
        whole = b"glTF" + (2).to_bytes(4, "little") + (24).to_bytes(4, "little") + (4).to_bytes(4, "little") + b"JSON{}  "
        self.assertEqual(meshes.glb(whole), [])
        self.assertTrue(meshes.glb(whole[:-1]))


class JudgeOfMessages(unittest.TestCase):
    def test_one_line_of_error_and_warnings_are_right(self):
        self.assertEqual(judge.messages(3, "pointskin: warning: a\npointskin: b\n", False), [])

    def test_none_two_and_strange_lines_are_found(self):
        for text in ("", "pointskin: a\npointskin: b\n", "terminate called\n", "pointskin: a\nb\n", "pointskin: \x1b[31m\n"):
            self.assertTrue(judge.messages(3, text, False), text)

    def test_an_error_with_success_is_found(self):
        self.assertTrue(judge.messages(0, "pointskin: a\n", False))
        self.assertEqual(judge.messages(0, "pointskin: warning: a\nmesh.ply: points 3\n", False), [])


class ReaderOfPly(unittest.TestCase):
    def test_every_form_reads_back(self):
        for form in ("ascii", "binary_little_endian", "binary_big_endian"):
            rows = [(0.5, -7, math.inf), (1e-300, 2 ** 31 - 1, 0.0)]
            data = ply.write([["x", "double"], ["id", "int"], ["y", "float"]], rows, form, [(0, 1, 1)])
            found = ply.read(data)
            self.assertEqual((found.rows("x", "id", "y"), found.triangles, found.form), (rows, [(0, 1, 1)], form))

    def test_files_that_are_cut_off_or_too_long_are_refused(self):
        data = ply.write([["x", "double"]], [(1.0,), (2.0,)], triangles=[(0, 1, 0)])
        for bad in (data[:-1], data[:-14], data + b"\0", data[:20]):
            self.assertRaises(ply.Malformed, ply.read, bad)


if __name__ == "__main__":
    unittest.main()
