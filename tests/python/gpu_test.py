"""CUDA arrays of torch, cupy and jax: in and out on the device, on the caller's stream, with the bytes of the CPU.

Needs a GPU; skips without one. With a file of points as its argument it also prints times from tensor to tensor."""
import gc
import os
import sys
import time

from common import Case, bytes_of, has, np, ps, sphere, unittest

SCAN = os.environ.get("POINTSKIN_SCAN", "")


def gpu_is_there():
    try:
        return ps.built_with_cuda() and ps.Workspace("auto").gpu >= 0
    except ps.PointskinError:
        return False


GPU = gpu_is_there()
if os.environ.get("POINTSKIN_REQUIRE_GPU") == "1" and not GPU:
    sys.exit("there is no GPU, but POINTSKIN_REQUIRE_GPU=1")


@unittest.skipUnless(GPU and has("torch"), "needs a GPU and torch")
class Torch(Case):
    def setUp(self):
        super().setUp()
        import torch
        self.torch = torch
        self.points, self.normals = sphere(20000)
        self.expected = bytes_of(ps.reconstruct(self.points, self.normals, depth=7, device="cpu"))

    def tensors(self):
        return self.torch.from_numpy(self.points).cuda(), self.torch.from_numpy(self.normals).cuda()

    def same(self, mesh):
        self.assertGreaterEqual(mesh.gpu, 0)
        self.assertEqual(bytes_of(mesh), self.expected)

    def test_tensor_to_tensor(self):
        mesh = ps.reconstruct(*self.tensors(), depth=7)
        self.same(mesh)
        taken = self.torch.as_tensor(mesh.vertices, device="cuda")
        self.assertEqual(taken.data_ptr(), mesh.vertices.__cuda_array_interface__["data"][0])
        by_dlpack = self.torch.from_dlpack(mesh.faces)
        self.assertEqual(by_dlpack.data_ptr(), mesh.faces.__cuda_array_interface__["data"][0])
        self.assertTrue((taken.cpu().numpy() == mesh.to_host().vertices).all())

    def test_other_types_and_strides_stay_on_the_device(self):
        points, normals = self.tensors()
        self.same(ps.reconstruct(points.double(), normals.double(), depth=7))
        wide = self.torch.zeros((20000, 8), device="cuda")
        wide[:, 3:6] = points
        self.same(ps.reconstruct(wide[:, 3:6], normals, depth=7))

    def test_another_stream_than_the_default_one(self):
        stream = self.torch.cuda.Stream()
        with self.torch.cuda.stream(stream):
            points, normals = self.tensors()
            for _ in range(50):  # work that must be done before
                points = points * 2
            for _ in range(50):
                points = points / 2
            mesh = ps.reconstruct(points, normals, depth=7)
            self.assertEqual(mesh.vertices.stream, stream.cuda_stream)
            doubled = self.torch.as_tensor(mesh.vertices, device="cuda") * 2
        stream.synchronize()
        self.same(mesh)
        self.assertTrue((doubled.cpu().numpy() == 2 * mesh.to_host().vertices).all())
        named = ps.reconstruct(*self.tensors(), depth=7, stream=stream)
        self.assertEqual(named.vertices.stream, stream.cuda_stream)
        self.same(named)

    def test_no_copy_between_host_and_device(self):
        from torch.profiler import ProfilerActivity, profile
        points, normals = self.tensors()
        ps.reconstruct(points, normals, depth=7)
        self.torch.cuda.synchronize()
        with profile(activities=[ProfilerActivity.CUDA]) as seen:
            ps.reconstruct(points, normals, depth=7)
            self.torch.cuda.synchronize()
        copies = {}
        for event in seen.events():
            if "Memcpy" in event.name:
                copies[event.name] = copies.get(event.name, 0) + 1
        trace = self.file("trace.json")
        seen.export_chrome_trace(trace)
        import json
        with open(trace, encoding="utf-8") as read:
            events = json.load(read)["traceEvents"]
        moved = {}
        for event in events:
            if event.get("cat") == "gpu_memcpy":
                moved[event["name"]] = moved.get(event["name"], 0) + event["args"].get("bytes", 0)
        print(f"copies of a run: {copies}; bytes {moved}; the points have {points.nbytes + normals.nbytes}")
        across = sum(count for name, count in moved.items() if "HtoD" in name or "DtoH" in name)
        self.assertLess(across, 100_000, "counts and sizes only")

    def test_tensors_outlive_the_mesh(self):
        mesh = ps.reconstruct(*self.tensors(), depth=7)
        taken, before = self.torch.from_dlpack(mesh.vertices), mesh.to_host().vertices.copy()
        del mesh
        gc.collect()
        others = [ps.reconstruct(*self.tensors(), depth=7) for _ in range(4)]
        self.assertTrue((taken.cpu().numpy() == before).all())
        self.assertEqual(len(others), 4)

    def test_attributes_fields_and_fluids(self):
        points, normals = self.tensors()
        colours = self.torch.randint(0, 255, (20000, 3), dtype=self.torch.uint8, device="cuda")
        mesh = ps.reconstruct(points, normals, depth=6, attributes={"rgb": colours})
        host = ps.reconstruct(self.points, self.normals, depth=6, attributes={"rgb": colours.cpu().numpy()}, device="cpu")
        self.assertEqual(bytes_of(mesh), bytes_of(host))
        field = ps.solve(points, normals, depth=7)
        self.same(field.extract())
        water = ps.fluid(points, 0.02)
        self.assertEqual(bytes_of(water), bytes_of(ps.fluid(self.points, 0.02, device="cpu")))

    def test_many_runs_keep_no_memory(self):
        points, normals = self.tensors()
        for i in range(300):
            ps.reconstruct(points, normals, depth=6)
            if i == 100:
                self.torch.cuda.synchronize()
                before = self.torch.cuda.mem_get_info()[0]
        self.torch.cuda.synchronize()
        self.assertLess(before - self.torch.cuda.mem_get_info()[0], 1 << 20)


@unittest.skipUnless(GPU and has("cupy"), "needs a GPU and cupy")
class Cupy(Case):
    def test_arrays_go_in_and_out(self):
        import cupy
        points, normals = sphere(20000)
        expected = bytes_of(ps.reconstruct(points, normals, depth=7, device="cpu"))
        stream = cupy.cuda.Stream(non_blocking=True)
        with stream:
            mesh = ps.reconstruct(cupy.asarray(points), cupy.asarray(normals), depth=7)
            self.assertEqual(mesh.vertices.stream, stream.ptr)
            taken = cupy.asarray(mesh.vertices)
            self.assertEqual(taken.data.ptr, mesh.vertices.__cuda_array_interface__["data"][0])
            again = cupy.from_dlpack(mesh.faces)
            self.assertEqual(again.data.ptr, mesh.faces.__cuda_array_interface__["data"][0])
        stream.synchronize()
        self.assertEqual(bytes_of(mesh), expected)
        fortran = cupy.asfortranarray(cupy.asarray(points, dtype=cupy.float64))
        self.assertEqual(bytes_of(ps.reconstruct(fortran, cupy.asarray(normals), depth=7)), expected)


@unittest.skipUnless(GPU and has("jax"), "needs a GPU and jax")
class Jax(Case):
    def test_arrays_go_in_and_out(self):
        os.environ.setdefault("XLA_PYTHON_CLIENT_PREALLOCATE", "false")
        import jax
        points, normals = sphere(20000)
        if not any(device.platform == "gpu" for device in jax.devices()):
            self.skipTest("jax sees no GPU")
        expected = bytes_of(ps.reconstruct(points, normals, depth=7, device="cpu"))
        on_device = jax.numpy.asarray(points).block_until_ready(), jax.numpy.asarray(normals).block_until_ready()
        mesh = ps.reconstruct(*on_device, depth=7)
        self.assertGreaterEqual(mesh.gpu, 0)
        self.assertEqual(bytes_of(mesh), expected)
        taken = jax.dlpack.from_dlpack(mesh.vertices)
        self.assertTrue((np.asarray(taken) == mesh.to_host().vertices).all())


@unittest.skipUnless(GPU and has("torch") and SCAN, "needs a GPU, torch and POINTSKIN_SCAN")
class Speed(Case):
    def test_from_tensor_to_tensor(self):
        import json
        import torch
        cloud = ps.read(SCAN)
        points, normals = torch.from_numpy(cloud.local_points.copy()).cuda(), torch.from_numpy(cloud.normals.copy()).cuda()
        for _ in range(10):
            ps.reconstruct(points, normals)
        torch.cuda.synchronize()
        times = []
        for _ in range(50):
            start = time.perf_counter()
            ps.reconstruct(points, normals)
            torch.cuda.synchronize()
            times.append(1e3 * (time.perf_counter() - start))
        report = self.file("report.json")
        self.program("reconstruct", SCAN, "-o", self.file("mesh.ply"), "--device", "cuda", "--repeat", 50, "--report", report, "-q")
        with open(report, encoding="utf-8") as read:
            its = json.load(read)["ms_repeat"]
        print(f"{len(cloud)} points, depth 8, tensor to tensor: median {sorted(times)[25]:.3f} ms, least {min(times):.3f}; "
              f"the program, resident: {its}")


if __name__ == "__main__":
    unittest.main(verbosity=2)
