#include "deform_reach.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <variant>

#include <fmt/format.h>

namespace pointskin::cli {
namespace {

/// Whether a region holds the point x.
struct Holds {
  const Vec3d& x;

  bool operator()(const HalfSpace& region) const { return dot(x - region.point, region.normal) >= 0; }
  bool operator()(const Ball& region) const {
    const Vec3d away = x - region.centre;
    return dot(away, away) <= region.radius * region.radius;
  }
  bool operator()(const AxisBox& region) const {
    for (std::size_t a = 0; a < 3; ++a)
      if (x[a] < region.lower[a] || x[a] > region.upper[a]) return false;
    return true;
  }
  bool operator()(const Capsule& region) const {
    const Vec3d axis = region.to - region.from;
    const Vec3d way = x - region.from;
    const double length2 = dot(axis, axis);
    const double share = length2 > 0 ? std::clamp(dot(way, axis) / length2, 0.0, 1.0) : 0;
    const Vec3d away = {way[0] - share * axis[0], way[1] - share * axis[1], way[2] - share * axis[2]};
    return dot(away, away) <= region.radius * region.radius;
  }
  bool operator()(const PointSet& /*region*/) const { return true; }  // a valid one has points
};

/// Whether x lies in the block of a lattice: its coordinates along the three axes are in [0, 1].
bool is_in_block(const Lattice& lattice, const Vec3d& x) {
  const std::array<Vec3d, 3>& axes = lattice.axes;
  const Vec3d way = x - lattice.origin;
  const double volume = dot(axes[0], cross(axes[1], axes[2]));
  for (std::size_t a = 0; a < 3; ++a) {
    const double share = dot(way, cross(axes[(a + 1) % 3], axes[(a + 2) % 3])) / volume;
    if (!(share >= 0 && share <= 1)) return false;
  }
  return true;
}

template <class Predicate>
bool any_point(const Cloud& cloud, const Predicate& holds) {
  return std::any_of(cloud.positions.begin(), cloud.positions.end(), [&](const Vec3f& p) {
    return holds(Vec3d{cloud.origin[0] + p.x, cloud.origin[1] + p.y, cloud.origin[2] + p.z});
  });
}

bool moves(const RigidMotion& motion) { return motion.angle != 0 || motion.translation != Vec3d{0, 0, 0}; }
bool moves(const AffineMap& map) { return map.matrix != AffineMap().matrix; }

bool moves(const Lattice& lattice) {
  Lattice rest = lattice;
  rest.reset();
  return lattice.control != rest.control;
}

}  // namespace

bool moves_anything(const Deformation& deformation) {
  return std::any_of(deformation.handles.begin(), deformation.handles.end(),
                     [](const Handle& handle) {
                       return std::visit([](const auto& transform) { return moves(transform); }, handle.transform);
                     }) ||
         std::any_of(deformation.lattices.begin(), deformation.lattices.end(),
                     [](const Lattice& lattice) { return moves(lattice); });
}

std::vector<std::string> idle_parts(const Deformation& deformation, const Cloud& rest) {
  std::vector<std::string> idle;
  for (std::size_t i = 0; i < deformation.handles.size(); ++i) {
    const HandleRegion& region = deformation.handles[i].region;
    if (!any_point(rest, [&region](const Vec3d& x) { return std::visit(Holds{x}, region); }))
      idle.push_back(fmt::format("handles[{}]: no point lies in its region", i));
  }
  // Behind handles, and behind other lattices, points are no longer where they were at rest.
  if (!deformation.handles.empty() || deformation.lattices.empty()) return idle;
  const Lattice& first = deformation.lattices.front();
  if (!any_point(rest, [&first](const Vec3d& x) { return is_in_block(first, x); }))
    idle.push_back("lattices[0]: no point lies in its block");
  return idle;
}

}  // namespace pointskin::cli
