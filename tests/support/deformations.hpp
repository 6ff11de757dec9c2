// Deformations for tests.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/deform.hpp>

#include <numbers>
#include <variant>

namespace pointskin::test {

/// Bends what lies between x = -0.5 and x = 0.5 by `angle` radians in the plane of x and y.
inline Deformation bend_along_x(double angle) {
  const RigidMotion turn{.axis = {0, 0, 1}, .point = {0, 1.5, 0}, .angle = angle};
  return {{{HalfSpace{{-0.5, 0, 0}, {-1, 0, 0}}}, {HalfSpace{{0.5, 0, 0}, {1, 0, 0}}, turn}}, {}};
}

/// All kinds of regions and transforms and a lattice, in the ball of radius 2 around the origin.
inline Deformation twist_and_pull() {
  Deformation out;
  out.handles.push_back({Ball{{-1.5, 0, 0}, 0.4}});
  out.handles.push_back({Capsule{{1, -0.5, 0}, {1, 0.5, 0}, 0.3},
                         RigidMotion{.axis = {1, 0, 0}, .angle = 1.8, .translation = {0.8, 0, 0.1}}});
  out.handles.push_back({AxisBox{{-0.3, 1, -1}, {0.3, 2, 1}},
                         AffineMap{.matrix = {0.4, 0, 0, 0, 0, 0.5, 0.1, 0, 0, 0, 0.6, 0.3}, .pivot = {0, 1.2, 0}}});
  Lattice lattice;
  lattice.origin = {-2, -2, -1};
  lattice.axes = {{{4, 0, 0}, {0, 4, 0}, {0, 0, 2}}};
  lattice.spans = {2, 3, 1};
  lattice.reset();
  lattice.control[lattice.index(1, 1, 1)][2] += 1;
  lattice.control[lattice.index(2, 3, 0)][0] += 0.7;
  out.lattices.push_back(lattice);
  return out;
}

/// Bends a cloud by 90 degrees about its middle third along y.
inline Deformation bend_upright(const Cloud& cloud) {
  const Bounds box = bounds_of(cloud.positions);
  const double low = double{box.lower.y} + (double{box.upper.y} - double{box.lower.y}) / 3;
  const double high = double{box.lower.y} + (double{box.upper.y} - double{box.lower.y}) * 2 / 3;
  const Vec3d middle{(double{box.lower.x} + double{box.upper.x}) / 2, (low + high) / 2,
                     (double{box.lower.z} + double{box.upper.z}) / 2};
  const auto world = [&](const Vec3d& p) {
    return Vec3d{p[0] + cloud.origin[0], p[1] + cloud.origin[1], p[2] + cloud.origin[2]};
  };
  const RigidMotion turn{.axis = {0, 0, 1}, .point = world(middle), .angle = std::numbers::pi / 2};
  return {{{HalfSpace{world({0, low, 0}), {0, -1, 0}}}, {HalfSpace{world({0, high, 0}), {0, 1, 0}}, turn}}, {}};
}

/// The same deformation of a cloud that lies `offset` away; half-spaces and rigid motions only.
inline Deformation moved(Deformation deformation, const Vec3d& offset) {
  const auto move = [&](Vec3d& p) {
    for (std::size_t a = 0; a < 3; ++a) p[a] += offset[a];
  };
  for (Handle& handle : deformation.handles) {
    move(std::get<HalfSpace>(handle.region).point);
    move(std::get<RigidMotion>(handle.transform).point);
  }
  return deformation;
}

}  // namespace pointskin::test
