// Which points of two solids are part of a set operation's surface.
// Source: Zhou et al. 2010, section 5 (P13). Coincident surfaces follow regularised set operations: Requicha &
// Voelcker, "Boolean operations in solid modeling: boundary evaluation and merging algorithms", Proc. IEEE 73, 1985.
#pragma once

#include <pointskin/boolean.hpp>

#include <cstdint>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "exec/space.hpp"
#include "field/surface_distance.hpp"

namespace pointskin::boolean {

/// Where a point of one solid's surface lies with respect to the other solid.
enum class Place : std::uint8_t {
  outside,
  inside,
  agrees,   ///< on its surface, with the same outside
  opposes,  ///< on its surface, each solid being the outside of the other
};

/// What becomes of a point.
enum class Fate : std::uint8_t { dropped, kept, flipped };

/// Cosine of the largest angle between normals, 26 degrees, at which surfaces that are near each other coincide. At
/// larger angles they cross, and the sign decides.
inline constexpr float kCoincidentCosine = 0.9F;

/// @param own         of the point to the surface of its own solid: how far the point scatters
/// @param coincident  cells that a point on both surfaces may be farther from the other one than from its own
PSK_HD inline Place place_of(const field::SurfaceDistance& own, const field::SurfaceDistance& other, float coincident) {
  const float from_own = own.cells < 0 ? -own.cells : own.cells;
  const float from_other = other.cells < 0 ? -other.cells : other.cells;
  const float cosine = own.normal.x * other.normal.x + own.normal.y * other.normal.y + own.normal.z * other.normal.z;
  if (from_other <= from_own + coincident) {
    if (cosine >= kCoincidentCosine) return Place::agrees;
    if (cosine <= -kCoincidentCosine) return Place::opposes;
  }
  return other.cells > 0 ? Place::outside : Place::inside;
}

/// What becomes of a point of the first (A) or second (B) solid. Where surfaces coincide, A's points stand for both.
PSK_HD inline Fate fate_of(BooleanOp op, bool is_first, Place place) {
  const bool outside = place == Place::outside;
  const bool inside = place == Place::inside;
  switch (op) {
    case BooleanOp::unite:
      return outside || (is_first && place == Place::agrees) ? Fate::kept : Fate::dropped;
    case BooleanOp::intersect:
      return inside || (is_first && place == Place::agrees) ? Fate::kept : Fate::dropped;
    case BooleanOp::subtract:
      if (is_first) return outside || place == Place::opposes ? Fate::kept : Fate::dropped;
      return inside ? Fate::flipped : Fate::dropped;
    case BooleanOp::symmetric_difference:
      break;
  }
  return outside ? Fate::kept : inside ? Fate::flipped : Fate::dropped;
}

/// Decides on the points of one solid.
/// @param own, other  shape (n), of the points
/// @param places      receives where they are, shape (n)
template <exec::Space Exec>
void find_places(Exec& ex, ArrayView<const field::SurfaceDistance> own, ArrayView<const field::SurfaceDistance> other,
                 float coincident, ArrayView<Place> places);

/// How many points share a fate or a place.
struct FateCounts {
  std::int64_t kept = 0;  ///< with those flipped
  std::int64_t flipped = 0;
  std::int64_t coincident = 0;
};

/// O(n), one wait.
template <exec::Space Exec>
FateCounts count_fates(Exec& ex, ArrayView<const Place> places, BooleanOp op, bool is_first);

/// Where the points of one solid are, and what becomes of them.
struct OrientedPoints {
  ArrayView<const Vec3f> positions, normals;
  ArrayView<const std::int32_t> used;  ///< as PointBuffers::used
};

/// Appends the kept points of one solid, in their order, with normals flipped where they must be.
/// @param places                of the points that are used
/// @param positions, normals    shape (FateCounts::kept)
template <exec::Space Exec>
void gather_kept(Exec& ex, const OrientedPoints& points, ArrayView<const Place> places, BooleanOp op, bool is_first,
                 ArrayView<Vec3f> positions, ArrayView<Vec3f> normals);

}  // namespace pointskin::boolean
