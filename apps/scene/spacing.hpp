// How far apart the points of a cloud are.
#pragma once

#include <vector>

#include <pointskin/vector.hpp>

namespace pointskin::scene {

/// Median distance from a point to its nearest neighbour, in world units, over up to `samples` points taken at equal
/// steps of the order along the longest axis; 0 for fewer than two points. Exact for each sample.
/// O(n log n) and about n^(1/2) a sample for points on a surface. Deterministic, independent of the order of the
/// points.
double median_spacing(const std::vector<Vec3f>& positions, int samples = 1000);

}  // namespace pointskin::scene
