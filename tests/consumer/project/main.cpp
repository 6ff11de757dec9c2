// What a stranger does with the installed library: host data, data that lies on a device, two surfaces of one field,
// and water. Exit 0 if all meshes are what they should be.
//
//   consumer [CLOUD.ply]   with a cloud: also times resident runs on it at depth 8
#include <pointskin/pointskin.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <iostream>
#include <optional>
#include <stdexcept>
#include <vector>

#include "device_memory.hpp"

namespace {

void require(bool holds, const char* what) {
  if (!holds) throw std::runtime_error(what);
}

pointskin::Cloud sphere() {
  pointskin::Cloud cloud;
  constexpr int kPoints = 10'000;
  for (int i = 0; i < kPoints; ++i) {  // a Fibonacci spiral covers the sphere evenly
    const double z = 1 - (2 * i + 1.0) / kPoints, angle = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
    const pointskin::Vec3f p{static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)),
                             static_cast<float>(z)};
    cloud.positions.push_back(p);
    cloud.normals.push_back(p);
  }
  return cloud;
}

bool same(const pointskin::Mesh& a, const pointskin::Mesh& b) {
  return a.vertices == b.vertices && a.normals == b.normals && a.triangles == b.triangles;
}

void require_sphere(const pointskin::Mesh& mesh) {
  const pointskin::MeshReport report = pointskin::measure(mesh);
  std::cout << report.triangles << " triangles, volume " << report.volume << ", Euler number " << report.euler << '\n';
  require(report.watertight() && report.euler == 2 && std::abs(report.volume - 4.18879) < 0.05, "no sphere");
}

/// Device pointers in, device pointers out, in a workspace of the caller's.
void try_resident(const pointskin::Workspace& workspace, const pointskin::Cloud& cloud, Memory& memory) {
  const pointskin::Mesh expected =
      pointskin::Reconstructor(pointskin::Device::cpu()).reconstruct(cloud, {{.depth = 6}});
  pointskin::DevicePoints points;
  points.positions = memory.put(cloud.positions);
  points.normals = memory.put(cloud.normals);
  pointskin::Reconstructor reconstructor(workspace);
  const pointskin::DeviceMesh mesh = reconstructor.reconstruct(points, {{.depth = 6}});
  pointskin::Mesh fetched;
  fetched.vertices = memory.get(mesh.vertices);
  fetched.normals = memory.get(mesh.normals);
  fetched.triangles = memory.get(mesh.triangles);
  require(same(fetched, expected), "the mesh of resident points is another one");

  const pointskin::Field field = reconstructor.solve(points, {.depth = 6});  // one solve, two extractions
  require(same(pointskin::download(workspace, field.extract_on_device({})), expected), "another extraction");
  const pointskin::MeshReport inner =
      pointskin::measure(field.extract({.isovalue = field.isovalue() + 0.1, .normals = false}));
  require(inner.watertight() && inner.volume < pointskin::measure(expected).volume, "the inner surface is not inside");
}

void try_water(const pointskin::Workspace& workspace) {
  namespace sim = pointskin::simulation;
  sim::Simulation water(sim::make_scene(sim::SceneKind::dam_break, 1000), {}, workspace);
  for (int frame = 0; frame < 3; ++frame) water.step(1.0 / 60);
  pointskin::Mesh mesh;
  water.surface({}, mesh);
  require(pointskin::measure(mesh).watertight(), "the water is not closed");
  require(same(mesh, pointskin::download(workspace, water.surface_on_device({}))), "the water is another one");
}

/// Points to mesh where both are on the device, as the benchmarks measure it.
void time_resident(const pointskin::Workspace& workspace, const pointskin::Cloud& cloud) {
  const pointskin::UploadedCloud points = pointskin::upload(workspace, cloud);
  pointskin::Reconstructor reconstructor(workspace);
  std::vector<double> ms;
  for (int i = 0; i < 300; ++i) {
    workspace.synchronize();
    const auto start = std::chrono::steady_clock::now();
    const pointskin::DeviceMesh mesh = reconstructor.reconstruct(points, {{.depth = 8}});
    workspace.synchronize();
    ms.push_back(std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count());
  }
  std::sort(ms.begin(), ms.end());
  std::cout << "resident, depth 8: median " << ms[ms.size() / 2] << " ms\n";
}

}  // namespace

int main(int argc, char** argv) try {
  const pointskin::Cloud cloud = sphere();
  require_sphere(pointskin::Reconstructor(pointskin::Device::cpu()).reconstruct(cloud, {{.depth = 6}}));
  Memory memory;
  const pointskin::Workspace workspace = memory.workspace();
  std::cout << "device data on " << workspace.device().name() << '\n';
  try_resident(workspace, cloud, memory);
  try_water(workspace);
  if (argc > 1) time_resident(workspace, pointskin::read_cloud(argv[1]));
  return 0;
} catch (const std::exception& error) {
  std::cerr << error.what() << '\n';
  return 1;
}
