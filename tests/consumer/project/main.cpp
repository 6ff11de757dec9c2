// Reconstructs a sphere with the installed library; exit 0 if the mesh is watertight.
#include <pointskin/pointskin.hpp>

#include <cmath>
#include <iostream>

int main() {
  pointskin::Cloud cloud;
  constexpr int kPoints = 10'000;
  for (int i = 0; i < kPoints; ++i) {  // a Fibonacci spiral covers the sphere evenly
    const double z = 1 - (2 * i + 1.0) / kPoints, angle = 2.399963229728653 * i, r = std::sqrt(1 - z * z);
    const pointskin::Vec3f p{static_cast<float>(r * std::cos(angle)), static_cast<float>(r * std::sin(angle)),
                             static_cast<float>(z)};
    cloud.positions.push_back(p);
    cloud.normals.push_back(p);
  }
  pointskin::Options options;
  options.depth = 6;
  pointskin::Reconstructor reconstructor{pointskin::Device::cpu()};
  const pointskin::Mesh mesh = reconstructor.reconstruct(cloud, options);
  const pointskin::MeshReport report = pointskin::measure(mesh);
  std::cout << report.triangles << " triangles, volume " << report.volume << ", Euler number " << report.euler << '\n';
  const bool good = report.watertight() && report.euler == 2 && std::abs(report.volume - 4.18879) < 0.05;
  return good ? 0 : 1;
}
