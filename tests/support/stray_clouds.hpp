// Clouds with stray points, clouds that only look as if they had some, and strays found the slow way.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

#include <cstdint>
#include <string>
#include <vector>

namespace pointskin::test {

struct NamedCloud {
  std::string name;
  Cloud cloud;
};

/// Clouds without a stray point: shapes, rods, clusters of unlike size and distance, scenes with sparse far parts,
/// planes and lines, blobs, densities over 1000 to 1, duplicates, and all clouds of up to 50 points.
std::vector<NamedCloud> clouds_without_strays();

/// Adds points at `places` with arbitrary normals, spread over the order of the others.
Cloud with_points_at(const Cloud& cloud, const std::vector<Vec3f>& places);

/// `count` places in random directions, log-uniform in [nearest, farthest] from `centre`.
std::vector<Vec3f> places_around(int count, std::uint64_t seed, double nearest, double farthest, Vec3d centre = {});

/// Sets of places that are strays of a cloud about the origin of diameter 2: one at 10^6 and at 10^30, several at
/// once, 20 at 3 to 100 diameters, many in a large cloud.
struct NamedPlaces {
  std::string name;
  std::vector<Vec3f> places;
};
std::vector<NamedPlaces> stray_places();

/// The definition of Strays word for word, over all points and by sorting them. Indices ascending.
std::vector<std::int64_t> brute_strays(const std::vector<Vec3f>& positions);

}  // namespace pointskin::test
