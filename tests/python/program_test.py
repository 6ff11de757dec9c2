"""Python gives the bytes that the program gives, for every command."""
import json


from common import Case, np, ps, run_python, sphere, unittest


class SameBytes(Case):
    def setUp(self):
        super().setUp()
        points, normals = sphere(6000)
        rng = np.random.default_rng(3)
        colours = rng.integers(0, 255, (6000, 3), dtype=np.uint8)
        self.cloud = ps.Cloud(points + rng.normal(0, 0.003, points.shape).astype(np.float32), normals,
                              {"rgb": colours, "class": (points[:, 2] > 0).astype(np.int32)})
        self.input = self.file("cloud.ply")
        self.cloud.save(self.input)

    def same(self, mesh, name, *arguments):
        """The program writes the same file as `mesh` saves."""
        mine, its = self.file("mine_" + name), self.file("its_" + name)
        mesh.save(mine)
        self.program(*arguments, "-o", its)
        with open(mine, "rb") as a, open(its, "rb") as b:
            self.assertEqual(a.read(), b.read(), arguments)

    def test_reconstruct(self):
        cloud = ps.read(self.input)
        for name, options, arguments in (
                ("plain.ply", {}, ()),
                ("deep.ply", {"depth": 7, "screening": 4.0, "iterations": 3}, ("--depth", 7, "--screening", 4, "--iterations", 3)),
                ("auto.ply", {"depth": "auto", "trim": "auto"}, ("--depth", "auto", "--trim", "auto")),
                ("coloured.ply", {"depth": 6, "attributes": True, "density": True},
                 ("--depth", 6, "--keep-attributes", "--density")),
                ("trimmed.ply", {"depth": 6, "trim": 0.05}, ("--depth", 6, "--trim", 0.05)),
                ("bare.obj", {"depth": 5, "vertex_normals": False}, ("--depth", 5, "--no-normals")),
                ("distance.stl", {"depth": 6, "field": "distance"}, ("--depth", 6, "--field", "distance")),
                ("offset.ply", {"depth": 6, "offset": 0.1}, ("--depth", 6, "--offset", 0.1)),
                ("estimated.ply", {"depth": 6, "point_normals": "estimate"}, ("--depth", 6, "--normals", "estimate")),
                ("dirichlet.ply", {"depth": 6, "boundary": "dirichlet", "weakness": True},
                 ("--depth", 6, "--boundary", "dirichlet", "--weakness"))):
            with self.subTest(name):
                self.same(ps.reconstruct(cloud, **options), name, "reconstruct", self.input, *arguments)

    def test_reconstruct_of_arrays_and_by_a_field(self):
        cloud = ps.read(self.input)
        self.same(ps.reconstruct(cloud.points, cloud.normals, depth=6), "arrays.ply", "reconstruct", self.input, "--depth", 6)
        self.same(ps.solve(cloud, depth=6).extract(), "field.ply", "reconstruct", self.input, "--depth", 6)

    def test_orient(self):
        bare = self.file("bare.ply")
        ps.Cloud(self.cloud.points).save(bare)
        self.same(ps.orient(ps.read(bare)), "oriented.ply", "orient", bare)
        self.same(ps.orient(ps.read(bare), method="sensor", sensors=[[5, 5, 5], [-5, -5, -5]]), "sensor.ply", "orient", bare,
                  "--method", "sensor", "--sensor", "5,5,5", "--sensor=-5,-5,-5")

    def test_boolean(self):
        other = self.file("other.ply")
        ps.Cloud(*sphere(5000, 0.8, (0.7, 0.2, 0))).save(other)
        for operation, name in (("unite", "union"), ("intersect", "intersection"), ("subtract", "difference"),
                                ("symmetric_difference", "symmetric-difference")):
            with self.subTest(operation):
                made = ps.boolean(ps.read(self.input), ps.read(other), operation, depth=6)
                self.same(made, f"{operation}.ply", "boolean", self.input, other, "--op", name, "--depth", 6)

    def test_deform(self):
        script = self.file("bend.json")
        with open(script, "w", encoding="utf-8") as out:
            json.dump({"handles": [
                {"region": {"half_space": {"point": [0, 0, 0.5], "normal": [0, 0, 1]}},
                 "rigid": {"axis": [0, 1, 0], "point": [0, 0, 0], "radians": 0.75}},
                {"region": {"half_space": {"point": [0, 0, -0.5], "normal": [0, 0, -1]}}}]}, out)
        deformer = ps.Deformer(ps.read(self.input), depth=6)
        deformer.deform([ps.handle("half_space", point=(0, 0, 0.5), normal=(0, 0, 1), axis=(0, 1, 0), angle=0.75),
                         ps.handle("half_space", point=(0, 0, -0.5), normal=(0, 0, -1))])
        self.same(deformer.mesh(), "bent.ply", "deform", self.input, "--script", script, "--depth", 6)

    def test_edit(self):
        camera = ps.camera(self.cloud, width=640, height=480)
        plain = {"view": camera["view"].ravel().tolist(), "projection": camera["projection"].ravel().tolist(),
                 "width": 640, "height": 480}
        script = self.file("edit.json")
        with open(script, "w", encoding="utf-8") as out:
            json.dump({"version": 1, "operations": [
                {"op": "guide", "camera": plain, "stroke": [[100, 240], [540, 240]]},
                {"op": "remove", "camera": plain, "originals": True,
                 "area": [[[250, 180], [390, 180], [390, 300], [250, 300]]]}]}, out)
        session = ps.EditSession(ps.read(self.input), depth=6)
        session.guide(camera, [[100, 240], [540, 240]])
        session.remove(camera, [[250, 180], [390, 180], [390, 300], [250, 300]], originals=True)
        self.same(session.mesh, "edited.ply", "edit", self.input, "--script", script, "--depth", 6)

    def test_fluid(self):
        grid = np.stack(np.meshgrid(*[np.arange(8) * 0.1] * 3, indexing="ij"), axis=-1).reshape(-1, 3)
        particles = self.file("particles.ply")
        ps.Cloud(grid.astype(np.float32)).save(particles)
        self.same(ps.fluid(ps.read(particles), 0.05), "water.ply", "fluid", particles, "--particle-radius", 0.05)
        self.same(ps.fluid(ps.read(particles), 0.05, kernel="anisotropic", smoothing_iterations=3), "smooth.ply", "fluid", particles,
                  "--particle-radius", 0.05, "--kernel", "anisotropic", "--mesh-smoothing-iters", 3)

    def test_convert(self):
        mesh = ps.reconstruct(self.cloud, depth=5, attributes=True)
        mesh.save(self.file("mesh.ply"))
        for extension in [found["extensions"][0] for found in ps.formats() if found["writes_meshes"]]:
            with self.subTest(extension):
                mine, its = self.file("mine" + extension), self.file("its" + extension)
                ps.write(mine, ps.read(self.file("mesh.ply")))
                self.program("convert", self.file("mesh.ply"), its)
                with open(mine, "rb") as a, open(its, "rb") as b:
                    self.assertEqual(a.read(), b.read())

    def test_clouds_are_merged_alike(self):
        other = self.file("other.ply")
        ps.Cloud(*sphere(500, 0.5)).save(other)
        merged = ps.merge(ps.read(self.input), ps.read(other))
        self.assertEqual(len(merged), 6500)
        self.same(ps.reconstruct(merged, depth=6), "merged.ply", "reconstruct", self.input, other, "--depth", 6)

    def test_render(self):
        mesh = ps.reconstruct(self.cloud, depth=5)
        file = self.file("mesh.ply")
        mesh.save(file)
        ps.render(ps.read(file), width=320, height=240, azimuth_degrees=70, up="z").save(self.file("mine.png"))
        self.program("render", file, "-o", self.file("its.png"), "--size", "320x240", "--azimuth", 70, "--up", "z")
        with open(self.file("mine.png"), "rb") as a, open(self.file("its.png"), "rb") as b:
            self.assertEqual(a.read(), b.read())

    def test_check_and_compare_have_the_same_numbers(self):
        mesh, reference = ps.reconstruct(self.cloud, depth=5), ps.reconstruct(self.cloud, depth=6)
        mesh.save(self.file("mesh.ply"))
        reference.save(self.file("reference.ply"))
        said = json.loads(self.program("check", self.file("mesh.ply"), "--json"))
        said = said.get("mesh", said)
        measured = mesh.measure()
        for name in ("vertices", "triangles", "components", "euler"):
            self.assertEqual(said[name], measured[name], name)
        said = json.loads(self.program("compare", self.file("mesh.ply"), self.file("reference.ply"), "--json"))
        mine = ps.compare(mesh, reference)
        self.assertEqual(said["f_score"], mine["f_score"])
        self.assertEqual(said["two_sided"]["rms"], mine["two_sided"]["rms"])
        distances = ps.distances(mesh, reference)
        self.program("compare", self.file("mesh.ply"), self.file("reference.ply"), "--heat", self.file("heat.ply"))
        heat = ps.read(self.file("heat.ply")).attributes["distance"]
        self.assertTrue((heat == distances.astype(heat.dtype)).all())


class TheProgram(Case):
    def test_is_what_python_m_pointskin_runs(self):
        expected = self.program("--version")
        done = run_python("import runpy, sys; sys.argv = ['pointskin', '--version']; runpy.run_module('pointskin', run_name='__main__')")
        self.assertEqual((done.returncode, done.stdout), (0, expected), done.stderr)

    def test_is_missed_with_a_sentence(self):
        done = run_python("import os; os.environ.pop('POINTSKIN_PROGRAM', None); os.environ['PATH'] = '/nonexistent'\n"
                          "import pointskin.program as p; import sys; sys.exit(p.main([]))")
        self.assertEqual(done.returncode, 1)
        self.assertIn("the program pointskin is not installed", done.stderr)


if __name__ == "__main__":
    unittest.main()
