// The working cube: where the unit cube of the octree lies in the cloud's coordinates.
#pragma once

#include <cstdint>

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/space.hpp"

namespace pointskin::octree {

/// Unit cube coordinates of a point p are (p - lower) / size.
struct Frame {
  Vec3d lower{0, 0, 0};  ///< lower corner, relative to the cloud's origin, world units
  double size = 1;       ///< side, world units
  friend bool operator==(const Frame&, const Frame&) = default;

  PSK_HD Vec3f to_unit(const Vec3f& p) const {
    const double inverse = 1 / size;
    return {static_cast<float>((static_cast<double>(p.x) - lower[0]) * inverse),
            static_cast<float>((static_cast<double>(p.y) - lower[1]) * inverse),
            static_cast<float>((static_cast<double>(p.z) - lower[2]) * inverse)};
  }
  PSK_HD Vec3f to_world(const Vec3f& unit) const {
    return {static_cast<float>(lower[0] + static_cast<double>(unit.x) * size),
            static_cast<float>(lower[1] + static_cast<double>(unit.y) * size),
            static_cast<float>(lower[2] + static_cast<double>(unit.z) * size)};
  }
};

/// Which elements of an array are meant: those of a list, or all where there is none.
struct Selection {
  ArrayView<const std::int32_t> indices{};
  PSK_HD std::int64_t operator()(std::int64_t i) const { return indices.empty() ? i : indices[i]; }
};

/// Moves the points of a selection into the unit cube.
struct ToUnit {
  Frame frame;
  ArrayView<const Vec3f> in;
  ArrayView<Vec3f> out;
  Selection selection{};
  PSK_HD void operator()(std::int64_t i) const { out[i] = frame.to_unit(in[selection(i)]); }
};

/// Cube around a box, `scale` times as wide as its longest side, with the same centre.
/// @throws Error empty_result if the box is one place, invalid_input if floats do not reach the cube's corners, or if the
/// box is so small and so far from the origin that floats hardly divide it
Frame frame_around(const Bounds& box, double scale);

/// How far apart the floats lie in which places in the cube are kept, where they are largest; world units, > 0.
double float_step(const Frame& frame);

/// Smallest box around `positions`, of which there is at least one. O(n), exact.
template <exec::Space Exec>
Bounds box_around(Exec& ex, ArrayView<const Vec3f> positions);

/// frame_around the bounding box of all `positions`.
/// @throws Error empty_result if there are no points or all are at one place
/// O(n); exact but for the rounding of the cube itself, the same on every device.
template <exec::Space Exec>
Frame fit_frame(Exec& ex, ArrayView<const Vec3f> positions, double scale);

}  // namespace pointskin::octree
