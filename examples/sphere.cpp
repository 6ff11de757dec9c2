// Points on a sphere in, watertight mesh out.   sphere [OUT.ply]
#include <pointskin/pointskin.hpp>

#include <cmath>
#include <exception>
#include <iostream>

pointskin::Cloud points_on_sphere(int count) {
  pointskin::Cloud cloud;
  for (int i = 0; i < count; ++i) {  // a Fibonacci spiral covers the sphere evenly
    const double z = 1 - (2 * i + 1.0) / count, angle = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
    const pointskin::Vec3f p{static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)),
                             static_cast<float>(z)};
    cloud.positions.push_back(p);
    cloud.normals.push_back(p);  // outward
  }
  return cloud;
}

int main(int argc, char** argv) try {
  pointskin::Reconstructor reconstructor;  // the first GPU, or the CPU
  const pointskin::Mesh mesh = reconstructor.reconstruct(points_on_sphere(20'000), {.depth = 7});
  pointskin::write_mesh(argc > 1 ? argv[1] : "sphere.ply", mesh);

  const pointskin::MeshReport report = pointskin::measure(mesh);
  std::cout << report.vertices << " vertices, " << report.triangles << " triangles, volume " << report.volume
            << (report.watertight() ? ", watertight\n" : ", NOT closed\n");
  return report.watertight() ? 0 : 1;
} catch (const std::exception& error) {
  std::cerr << "sphere: " << error.what() << '\n';
  return 1;
}
