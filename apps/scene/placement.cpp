// Solids moved to their place.
#include <array>
#include <cmath>
#include <utility>

#include <pointskin/error.hpp>

#include "scene/sources.hpp"

namespace pointskin::scene {
namespace {

Vec3d turned(const std::array<double, 9>& r, const Vec3d& v) {
  return {r[0] * v.x + r[1] * v.y + r[2] * v.z, r[3] * v.x + r[4] * v.y + r[5] * v.z,
          r[6] * v.x + r[7] * v.y + r[8] * v.z};
}

bool is_identity(const Similarity& placement) {
  const Similarity none;
  return placement.scale == none.scale && placement.rotation == none.rotation &&
         placement.translation == none.translation;
}

void check(const Similarity& placement) {
  const std::array<double, 9>& r = placement.rotation;
  const Vec3d rows[3] = {{r[0], r[1], r[2]}, {r[3], r[4], r[5]}, {r[6], r[7], r[8]}};
  constexpr double kTolerance = 1e-6;
  bool proper = dot(cross(rows[0], rows[1]), rows[2]) > 0;
  for (std::size_t i = 0; i < 3; ++i)
    for (std::size_t j = 0; j <= i; ++j)
      proper = proper && std::abs(dot(rows[i], rows[j]) - (i == j ? 1 : 0)) < kTolerance;
  const Vec3d& t = placement.translation;
  const bool moves = std::isfinite(t.x) && std::isfinite(t.y) && std::isfinite(t.z);
  if (!proper || !moves || !(placement.scale > 0) || !std::isfinite(placement.scale))
    throw Error(ErrorCode::usage,
                "the place of a solid needs a scale above 0, a proper rotation and a finite translation");
}

/// Where the solid's origin comes to lie becomes the new origin, so that places near it keep their digits.
template <class Points>
void move(const Similarity& placement, Vec3d& origin, Points& positions, std::vector<Vec3f>& normals) {
  const auto to_float = [](const Vec3d& v) {
    return Vec3f{static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z)};
  };
  const auto to_double = [](const Vec3f& v) { return Vec3d{v.x, v.y, v.z}; };
  for (Vec3f& p : positions) p = to_float(turned(placement.rotation, to_double(p)) * placement.scale);
  for (Vec3f& n : normals) n = to_float(turned(placement.rotation, to_double(n)));
  origin = turned(placement.rotation, origin) * placement.scale + placement.translation;
}

}  // namespace

Solid placed(const Solid& solid, const Similarity& placement) {
  check(placement);
  Solid moved = solid;
  if (is_identity(placement)) return moved;
  if (auto* cloud = std::get_if<Cloud>(&moved)) move(placement, cloud->origin, cloud->positions, cloud->normals);
  if (auto* mesh = std::get_if<Mesh>(&moved)) move(placement, mesh->origin, mesh->vertices, mesh->normals);
  return moved;
}

}  // namespace pointskin::scene
