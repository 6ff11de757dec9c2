"""Meshes and clouds of open3d, and of trimesh and pyvista where they are installed, there and back."""
from common import Case, has, np, ps, sphere, unittest


def example():
    points, normals = sphere(4000)
    colours = (127 * (1 + normals)).astype(np.uint8)
    return ps.reconstruct(points, normals, depth=5, attributes={"rgb": colours}), ps.Cloud(points, normals, {"rgb": colours})


class Interop(Case):
    @unittest.skipUnless(has("open3d"), "open3d is not installed")
    def test_open3d(self):
        mesh, cloud = example()
        theirs = mesh.to_open3d()
        self.assertTrue(theirs.is_watertight())
        self.assertTrue((np.asarray(theirs.vertices) == mesh.vertices).all())
        again = ps.Mesh.from_open3d(theirs)
        self.assertTrue((again.vertices == mesh.vertices).all() and (again.faces == mesh.faces).all())
        self.assertTrue((again.attributes["rgb"] == mesh.attributes["rgb"]).all())
        self.assertLess(np.abs(again.normals - mesh.normals).max(), 1e-6)
        points = cloud.to_open3d()
        back = ps.Cloud.from_open3d(points)
        self.assertTrue((back.points == cloud.points).all() and (back.attributes["rgb"] == cloud.attributes["rgb"]).all())

    @unittest.skipUnless(has("open3d"), "open3d is not installed")
    def test_open3d_reads_what_we_write(self):
        import open3d
        mesh, _ = example()
        for extension in (".ply", ".obj", ".stl"):
            mesh.save(self.file("mesh" + extension))
            theirs = open3d.io.read_triangle_mesh(self.file("mesh" + extension))
            self.assertEqual(len(theirs.triangles), len(mesh.faces), extension)

    @unittest.skipUnless(has("trimesh"), "trimesh is not installed")
    def test_trimesh(self):
        mesh, _ = example()
        theirs = mesh.to_trimesh()
        self.assertTrue(theirs.is_watertight)
        again = ps.Mesh.from_trimesh(theirs)
        self.assertTrue((again.vertices == mesh.vertices).all() and (again.attributes["rgb"] == mesh.attributes["rgb"]).all())

    @unittest.skipUnless(has("pyvista"), "pyvista is not installed")
    def test_pyvista(self):
        mesh, cloud = example()
        theirs = mesh.to_pyvista()
        self.assertEqual(theirs.n_open_edges, 0)
        again = ps.Mesh.from_pyvista(theirs)
        self.assertTrue((again.vertices == mesh.vertices).all() and (again.attributes["rgb"] == mesh.attributes["rgb"]).all())
        self.assertEqual(cloud.to_pyvista().n_points, len(cloud))

    @unittest.skipIf(has("trimesh"), "trimesh is installed")
    def test_what_is_missing_is_named(self):
        mesh, _ = example()
        with self.assertRaisesRegex(ps.UsageError, "trimesh is not installed"):
            mesh.to_trimesh()


if __name__ == "__main__":
    unittest.main()
