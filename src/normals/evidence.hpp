// What the input says of sides.
#pragma once

#include <pointskin/normals.hpp>
#include <pointskin/vector.hpp>

#include <cstdint>
#include <vector>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "normals/prepared_cloud.hpp"

namespace pointskin::normals {

/// What is known of sides: where points were seen from, relative to the cloud's origin, and what given normals decide.
struct Views {
  std::vector<Vec3d> sensors;  ///< relative to the cloud's origin
  std::vector<Vec3f> towards;  ///< (n) or none: from the point towards its sensor, any length
  bool turns_given = false;    ///< given normals that point into what the points enclose are turned
  [[nodiscard]] bool empty() const { return sensors.empty() && towards.empty(); }
};

/// What the input says of signs.
struct Evidence {
  ArrayView<const std::int32_t> signs;  ///< (n) 1, -1 or 0: which sign of the line it speaks for; empty: of none
  double typical = 0;                   ///< unless 0, lines have their likely signs (LikelySigns)
  bool may_be_inside_out = false;       ///< all signs of a closed part may be wrong

  /// The input knows more than neighbours do.
  [[nodiscard]] bool is_certain() const { return typical > 1; }
};

/// Evidence::signs, of given normals for the method repair and of views for the method sensor; else empty.
/// @param lines  (n) unit length, of any sign
template <exec::Space Exec>
exec::Buffer<std::int32_t> find_evidence(Exec& ex, const PreparedCloud& points, ArrayView<const Vec3f> lines,
                                         const Views& views, NormalMethod method);

}  // namespace pointskin::normals
