// Clouds with the faults of real ones: outliers, holes, uneven densities, coarse numbers, normals that point the wrong way.
#pragma once

#include <pointskin/cloud.hpp>

#include <cstdint>

namespace pointskin::bench {

/// Lengths are in units of the diagonal of the box of the points; shares are of 1. Faults come in this order.
struct SpoilOptions {
  bool outside = false;      ///< only points that look away from the middle of the box, as a scanner sees a thin wall
  double density_ratio = 1;  ///< along the longest side, the densest end to the thinnest, >= 1; exponential between
  double holes = 0;          ///< share of the points that is cut out, in [0, 1)
  int hole_count = 5;        ///< balls that are cut out, of equal numbers of points, > 0
  double lines = 0;  ///< distance of scan lines: planes across the longest side, to which points are moved; 0: none
  std::int64_t keep = 0;    ///< points that are left, drawn at random; 0: all
  double sigma = 0;         ///< of the Gaussian added to each coordinate, >= 0
  double normal_noise = 0;  ///< sigma on each component of the unit normal, >= 0
  double flipped = 0;       ///< share of the normals that is turned round, in [0, 1]
  double quantum = 0;       ///< coordinates are multiples of it; 0: as they are
  double outliers = 0;      ///< share of the result that is outliers with random normals, in [0, 1)
  int clusters = 0;         ///< outliers lie in so many balls of a fiftieth, else evenly in the box enlarged by a fifth
  std::uint64_t seed = 1;
};

/// Spoils `cloud`, whose attributes are dropped. O(n (hole_count + log n)). The same on every machine.
/// @throws Error usage if an option is out of range; empty_result if no point is left
Cloud spoil(const Cloud& cloud, const SpoilOptions& options);

}  // namespace pointskin::bench
