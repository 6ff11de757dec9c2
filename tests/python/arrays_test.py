"""Arrays of any type, strides and library come in, and ours go out, without copies where that is possible."""
import array
import gc
import os
import re

from common import Case, bytes_of, has, np, ps, sphere, unittest


class Inputs(Case):
    @classmethod
    def setUpClass(cls):
        cls.points, cls.normals = sphere(3000)
        cls.expected = bytes_of(ps.reconstruct(cls.points, cls.normals, depth=6))

    def gives_the_same(self, points, normals=None):
        made = ps.reconstruct(points, self.normals if normals is None else normals, depth=6)
        self.assertEqual(bytes_of(made), self.expected)

    def test_types_that_hold_the_same_numbers_give_the_same_bytes(self):
        self.gives_the_same(self.points.astype(np.float64))
        self.gives_the_same(self.points.astype(">f4"))
        self.gives_the_same(self.points.astype(">f8"), self.normals.astype(">f8"))

    def test_strides_of_any_kind(self):
        self.gives_the_same(np.asfortranarray(self.points))
        wide = np.zeros((3000, 7), dtype=np.float32)
        wide[:, 2:5] = self.points
        self.gives_the_same(wide[:, 2:5])
        twice = np.repeat(self.points, 2, axis=0)
        self.gives_the_same(twice[::2])
        self.gives_the_same(self.points[::-1].copy()[::-1])
        mirrored = self.points[:, ::-1].copy()
        self.gives_the_same(mirrored[:, ::-1])

    def test_what_must_not_be_written_is_read(self):
        frozen = self.points.copy()
        frozen.flags.writeable = False
        self.gives_the_same(frozen)
        self.assertTrue((frozen == self.points).all())

    def test_the_buffer_protocol_and_lists(self):
        flat = array.array("f", self.points.ravel().tolist())
        self.gives_the_same(memoryview(flat).cast("B").cast("f", shape=[3000, 3]))
        self.gives_the_same(self.points.tolist())

    def test_order_does_not_matter(self):
        order = np.random.default_rng(7).permutation(3000)
        self.gives_the_same(self.points[order], self.normals[order])

    def test_arrays_live_as_long_as_they_are_read(self):
        """A Cloud that is made on the way from arrays is freed after the call, not before."""
        points, normals = sphere(4000)
        cloud = ps.Cloud(points, normals)
        self.assertEqual(ps.estimate_bytes(points, depth=6), ps.estimate_bytes(ps.Cloud(points), depth=6))
        self.assertEqual(ps.suggest_depth(points), ps.suggest_depth(ps.Cloud(points)))
        camera = ps.camera(cloud)
        for session in (ps.EditSession(points, normals, depth=5), ps.EditSession(cloud, depth=5)):
            session.remove(camera, [[(0, 0), (300, 0), (300, 300), (0, 300)]])
            self.assertEqual(bytes_of(session.mesh), bytes_of(ps.reconstruct(session.cloud, depth=5)))
        parts = [ps.handle("points", points=np.arange(50), translation=(0, 0, 0.1)), ps.handle("half_space", normal=(0, 0, 1))]
        deformers = [ps.Deformer(points, normals), ps.Deformer(cloud)]
        for deformer in deformers:
            deformer.deform(parts)
        self.assertEqual(*[bytes_of(deformer.mesh()) for deformer in deformers])

    def test_shapes_that_do_not_fit_are_named(self):
        for points, normals, words in ((np.zeros((5, 2)), None, r"points must have the shape \(n, 3\)"),
                                       (self.points, self.normals[:-1], "normals must be as many"),
                                       (np.zeros(3), None, "points must have the shape"),
                                       (np.array([["a", "b", "c"]]), None, "points must be numbers"),
                                       (np.zeros((5, 3), dtype=complex), None, "points must be numbers")):
            with self.assertRaisesRegex(ps.UsageError, words):
                ps.reconstruct(points, normals, depth=5)

    def test_no_points_are_an_empty_result(self):
        with self.assertRaises(ps.EmptyResultError):
            ps.reconstruct(np.zeros((0, 3)), np.zeros((0, 3)))
        self.assertEqual(len(ps.Cloud([])), 0)

    def test_points_that_are_not_finite_are_left_out_with_a_warning(self):
        points = np.vstack([self.points, [[np.nan, 0, 0], [0, np.inf, 0]]]).astype(np.float32)
        normals = np.vstack([self.normals, np.ones((2, 3))]).astype(np.float32)
        with self.assertWarnsRegex(ps.PointskinWarning, "2 points were dropped"):
            made = ps.reconstruct(points, normals, depth=6)
        self.assertEqual(bytes_of(made), self.expected)

    def test_normals_of_no_length_are_left_out_with_a_warning(self):
        points = np.vstack([self.points, [[2.0, 0, 0]]]).astype(np.float32)
        normals = np.vstack([self.normals, np.zeros((1, 3))]).astype(np.float32)
        with self.assertWarnsRegex(ps.PointskinWarning, "1 points were dropped: their normal"):
            made = ps.reconstruct(points, normals, depth=6)
        self.assertEqual(bytes_of(made), self.expected)

    def test_colours_are_split_and_joined(self):
        colours = np.random.default_rng(1).integers(0, 255, (3000, 3), dtype=np.uint8)
        weights = np.random.default_rng(2).random((3000, 2))
        cloud = ps.Cloud(self.points, self.normals, {"rgb": colours, "w": weights})
        self.assertEqual(list(cloud.attributes), ["red", "green", "blue", "w_0", "w_1"])
        self.assertTrue((cloud.attributes["rgb"] == colours).all())
        self.assertTrue((cloud.attributes["w"] == weights).all())
        self.assertIn("rgb", cloud.attributes)
        self.assertNotIn("rgba", cloud.attributes)
        made = ps.reconstruct(cloud, depth=6, attributes=True)
        self.assertEqual(made.attributes["rgb"].shape, made.vertices.shape)
        self.assertEqual(made.attributes["rgb"].dtype, np.uint8)

    def test_masked_integers_stay_missing(self):
        classes = np.ma.MaskedArray(np.arange(3000, dtype=np.int32), mask=np.arange(3000) % 5 == 0)
        cloud = ps.Cloud(self.points, self.normals, {"class": classes})
        again = cloud.attributes["class"]
        self.assertTrue((again.mask == classes.mask).all())
        self.assertTrue((again.compressed() == classes.compressed()).all())

    def test_large_coordinates_keep_their_digits(self):
        corner = np.array([431000.123, 5412345.678, 812.25])
        points = self.points.astype(np.float64) + corner
        made = ps.reconstruct(points, self.normals, depth=6)
        self.assertEqual(made.vertices.dtype, np.float64)
        self.assertTrue(made.origin.any())
        plain = ps.reconstruct(self.points, self.normals, depth=6)
        self.assertEqual(len(plain.vertices), len(made.vertices))
        distance = ps.compare(ps.Mesh(made.vertices - corner, made.faces), plain)["two_sided"]["max"]
        self.assertLess(distance, 1e-4)


class Outputs(Case):
    def setUp(self):
        super().setUp()
        self.mesh = ps.reconstruct(*sphere(2000), depth=5)

    def test_are_not_copied(self):
        vertices = self.mesh.vertices
        self.assertEqual(np.asarray(vertices).ctypes.data, self.mesh.vertices.ctypes.data)
        self.assertEqual(vertices.dtype, np.float32)
        self.assertEqual(self.mesh.faces.dtype, np.int32)
        self.assertFalse(vertices.flags.owndata)

    def test_live_longer_than_the_mesh(self):
        vertices, faces = self.mesh.vertices, self.mesh.faces
        before = vertices.copy(), faces.copy()
        del self.mesh
        gc.collect()
        more = [ps.reconstruct(*sphere(2000), depth=5) for _ in range(5)]
        self.assertTrue((vertices == before[0]).all() and (faces == before[1]).all())
        self.assertEqual(len(more), 5)

    def test_can_be_changed_and_are_saved_so(self):
        self.mesh.vertices[:] *= 2
        self.mesh.save(self.file("twice.ply"))
        self.assertTrue((ps.read(self.file("twice.ply")).vertices == self.mesh.vertices).all())

    def test_a_mesh_of_arrays_has_them(self):
        again = ps.Mesh(self.mesh.vertices, self.mesh.faces.astype(np.int64), self.mesh.normals)
        self.assertEqual(bytes_of(again), bytes_of(self.mesh))
        self.assertTrue(ps.check(again))
        with self.assertRaisesRegex(ps.InvalidInputError, "names vertex"):
            ps.Mesh(self.mesh.vertices, self.mesh.faces + 1)

    def test_files_are_measured_in_parts_where_memory_is_limited(self):
        path, mesh = self.file("mesh.ply"), ps.reconstruct(*sphere(20000), depth=7)
        mesh.save(path)
        expected = mesh.measure()
        self.assertEqual(ps.measure(path), expected)
        limit, found = 1, None
        while found is None:  # what each error says would do is more than before
            try:
                found = ps.measure(path, 1, max_memory=limit)
            except ps.OverLimitError as refused:
                more = int(re.search(r"(\d+) bytes", str(refused))[1])
                self.assertGreater(more, limit)
                limit = more
        self.assertEqual(found, expected)
        self.assertLess(limit, os.path.getsize(path))
        self.assertTrue(ps.check(path, max_memory=limit))
        with self.assertRaisesRegex(ps.UsageError, "in memory already"):
            ps.check(mesh, max_memory=limit)
        with self.assertRaises(ps.InvalidInputError):
            ps.measure(self.file("none.ply"))

    def test_numpy_takes_them_by_dlpack(self):
        taken = np.from_dlpack(self.mesh.vertices)
        self.assertEqual(taken.ctypes.data, self.mesh.vertices.ctypes.data)


@unittest.skipUnless(has("torch"), "torch is not installed")
class Torch(Case):
    def test_tensors_go_in_without_a_copy_and_come_out_without_one(self):
        import torch
        points, normals = sphere(3000)
        expected = bytes_of(ps.reconstruct(points, normals, depth=6))
        made = ps.reconstruct(torch.from_numpy(points), torch.from_numpy(normals), depth=6)
        self.assertEqual(bytes_of(made), expected)
        tensor = torch.from_dlpack(made.vertices)
        self.assertEqual(tensor.data_ptr(), made.vertices.ctypes.data)
        tensor[0, 0] = 42
        self.assertEqual(made.vertices[0, 0], 42)
        faces = torch.from_dlpack(made.faces)
        self.assertEqual(faces.dtype, torch.int32)

    def test_tensors_of_other_types_and_strides(self):
        import torch
        points, normals = sphere(3000)
        expected = bytes_of(ps.reconstruct(points, normals, depth=6))
        columns = torch.from_numpy(points).t().contiguous().t()
        self.assertEqual(bytes_of(ps.reconstruct(columns, torch.from_numpy(normals).double(), depth=6)), expected)
        with_gradient = torch.from_numpy(points.copy()).requires_grad_()
        self.assertEqual(bytes_of(ps.reconstruct(with_gradient, torch.from_numpy(normals), depth=6)), expected)

    def test_a_tensor_outlives_the_mesh(self):
        import torch
        made = ps.reconstruct(*sphere(2000), depth=5)
        tensor, before = torch.from_dlpack(made.vertices), made.vertices.copy()
        del made
        gc.collect()
        self.assertTrue((tensor.numpy() == before).all())


if __name__ == "__main__":
    unittest.main()
