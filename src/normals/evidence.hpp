// What the input says of the side of single points.
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

/// Which sign of its line speaks for every point: 1, -1, or 0 where the input says nothing; shape (n). Empty unless the
/// method is repair (which asks the given normals) or sensor.
/// @param lines  (n) unit length, of any sign
template <exec::Space Exec>
exec::Buffer<std::int32_t> find_evidence(Exec& ex, const PreparedCloud& points, ArrayView<const Vec3f> lines,
                                         const Views& views, NormalMethod method);

}  // namespace pointskin::normals
