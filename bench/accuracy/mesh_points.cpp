#include "mesh_points.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <vector>

#include "core/vec3.hpp"
#include "random.hpp"

namespace pointskin::bench {
namespace {

struct Corners {
  Vec3d a, b, c;
};

Corners corners_of(const Mesh& mesh, std::size_t triangle) {
  const auto at = [&](std::size_t corner) {
    return to_double(mesh.vertices[static_cast<std::size_t>(mesh.triangles[triangle][corner])]);
  };
  return {at(0), at(1), at(2)};
}

}  // namespace

Cloud points_of(const Mesh& mesh, std::int64_t points, std::uint64_t seed) {
  if (points < 1) throw Error(ErrorCode::usage, "the number of points is not positive");
  std::vector<double> area_until(mesh.triangles.size());
  double area = 0;
  for (std::size_t t = 0; t < area_until.size(); ++t) {
    const Corners corners = corners_of(mesh, t);
    area += 0.5 * length(cross(corners.b - corners.a, corners.c - corners.a));
    area_until[t] = area;
  }
  if (!(area > 0)) throw Error(ErrorCode::empty_result, "the mesh has no area");

  Cloud cloud;
  cloud.origin = mesh.origin;
  for (std::int64_t i = 0; i < points; ++i) {
    Random numbers(seed, static_cast<std::uint64_t>(i));
    const auto place = std::upper_bound(area_until.begin(), area_until.end(), area * numbers.uniform());
    const Corners corners =
        corners_of(mesh, std::min(area_until.size() - 1, static_cast<std::size_t>(place - area_until.begin())));
    const Vec3d u = corners.b - corners.a;
    const Vec3d v = corners.c - corners.a;
    const double root = std::sqrt(numbers.uniform());
    const double share = numbers.uniform();
    cloud.positions.push_back(to_float(corners.a + (root * (1 - share)) * u + (root * share) * v));
    cloud.normals.push_back(to_float(normalized(cross(u, v))));
  }
  return cloud;
}

}  // namespace pointskin::bench
