// The scores of a comparison out of what was measured from either surface to the other.
#pragma once

#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace pointskin::mesh_detail {

/// From samples on one surface to the nearest points of the other.
struct Direction {
  DistanceStatistics distances;   ///< world units
  double normal_consistency = 0;  ///< mean of |n . n'|, in [0, 1]
  double share_near = 0;          ///< samples within the threshold, in [0, 1]
  std::int64_t samples = 0;
};

/// @param diagonal  of the reference's bounding box, world units
inline MeshComparison both_ways(const Direction& to_reference, const Direction& from_reference, double diagonal) {
  const DistanceStatistics& a = to_reference.distances;
  const DistanceStatistics& b = from_reference.distances;
  MeshComparison result;
  result.reference_diagonal = diagonal;
  result.samples = to_reference.samples;
  result.reference_samples = from_reference.samples;
  result.to_reference = a;
  result.from_reference = b;
  result.two_sided = {(a.mean + b.mean) / 2, std::sqrt((a.rms * a.rms + b.rms * b.rms) / 2), std::max(a.p95, b.p95),
                      std::max(a.max, b.max)};
  result.normal_consistency = (to_reference.normal_consistency + from_reference.normal_consistency) / 2;
  result.precision = to_reference.share_near;
  result.recall = from_reference.share_near;
  const double sum = result.precision + result.recall;
  result.f_score = sum > 0 ? 2 * result.precision * result.recall / sum : 0;
  return result;
}

}  // namespace pointskin::mesh_detail
