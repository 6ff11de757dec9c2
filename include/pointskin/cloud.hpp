// Point clouds on the host.
#pragma once

#include <cstdint>
#include <vector>

#include <pointskin/attribute.hpp>
#include <pointskin/export.hpp>
#include <pointskin/vector.hpp>

namespace pointskin PSK_EXPORT {

/// Points with optional unit-free outward normals and named scalars.
///
/// World position of point i = origin + positions[i]. Keeping a double offset apart lets survey coordinates near
/// 1e6 keep their millimetres while everything else works in float.
struct Cloud {
  Vec3d origin{0, 0, 0};              ///< world units; zero unless the reader subtracted an offset
  std::vector<Vec3f> positions;       ///< shape (n), relative to origin, world units, finite
  std::vector<Vec3f> normals;         ///< shape (n) or (0); outward, any length (see Options::confidence)
  std::vector<Attribute> attributes;  ///< each of shape (n)
  std::int64_t dropped = 0;           ///< points of the source that had a non-finite coordinate and were left out

  [[nodiscard]] std::int64_t size() const noexcept { return static_cast<std::int64_t>(positions.size()); }
  [[nodiscard]] bool has_normals() const noexcept { return !positions.empty() && normals.size() == positions.size(); }
};

/// Axis-aligned box in the coordinates of Cloud::positions or Mesh::vertices (relative to origin).
struct Bounds {
  Vec3f lower{}, upper{};
};

/// Smallest box around `positions`; all zero if there are none. O(n), exact.
Bounds bounds_of(const std::vector<Vec3f>& positions);

/// Stray points: so few and so far from all others that a box around all would be made for them.
///
/// At most 32 points, 1 in 1000 of larger clouds (256 at most), 1 in 100 of smaller ones, none below 128 points. All
/// lie farther from the box of the others, along some axis, than its longest side, which is at most 2/3 of that with
/// them. Where more than 32 are outside, they have fewer than 8 others within an eighth of their distance: far parts of
/// a scene are no strays.
struct Strays {
  std::vector<std::int64_t> points;  ///< indices, the farthest first
  Bounds core;                       ///< bounding box of all other points
};

/// Finds the strays among `positions`, which are finite. Independent of the order of the points and of `threads` (CPU
/// threads, 0: all). O(n), no memory worth mentioning. No strays where there are no points.
Strays find_strays(const std::vector<Vec3f>& positions, int threads = 0);

}  // namespace pointskin
