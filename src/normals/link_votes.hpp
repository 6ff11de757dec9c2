// What neighbours say of the signs of each other's normals: links that vote for equal or opposite ones.
// Source: Xie, Wang, Hua, Qin & Kaufman, "Piecewise C1 continuous surface reconstruction of noisy point clouds via
// local implicit quadric regression", IEEE Visualization 2003 (a neighbour's normal is the mirror image, so sharp edges
// do not turn it over). Differs: votes are integers, and less where a link may be noise or join two sheets
// (docs/algorithm.md, section 19).
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "core/vec3.hpp"
#include "normals/neighbours.hpp"

namespace pointskin::normals {

/// A vote of full weight.
inline constexpr std::int64_t kFullVote = 1024;

/// Samples in the order of the tree, and their neighbours (find_neighbours).
struct LinkedLines {
  ArrayView<const Vec3f> positions;   ///< in the unit cube
  ArrayView<const Vec3f> normals;     ///< unit length, of any sign
  ArrayView<const float> flatness;    ///< NormalLines::flatness
  ArrayView<const float> noise;       ///< NormalLines::noise
  ArrayView<const std::int32_t> ids;  ///< (n, kNeighbours)
};

/// Votes between two patches, of all links between them.
struct PatchVotes {
  std::int64_t net = 0;    ///< for equal signs minus for opposite ones
  std::int64_t gross = 0;  ///< for either
  std::int64_t count = 0;  ///< links

  PSK_HD PatchVotes operator+(const PatchVotes& other) const {
    return {net + other.net, gross + other.gross, count + other.count};
  }
};

namespace sign_graph {

/// Nearest neighbours that have a vote.
inline constexpr int kLinks = 12;

/// Votes below this are none.
inline constexpr std::int64_t kLeastVote = kFullVote / 32;

PSK_HD inline std::int64_t size_of(std::int64_t vote) { return vote < 0 ? -vote : vote; }

/// How far the two ends may be from a common circle, as the sum of their normals' slopes along the link.
inline constexpr double kSkew = 0.35;

/// Standard deviations of a sample that count as noise between two.
inline constexpr double kNoise = 2;

/// What is left of a distance across the surface beyond what noise makes of it.
PSK_HD inline double beyond_noise(double along, double noise) {
  if (along > noise) return along - noise;
  return along < -noise ? along + noise : 0.0;
}

/// The vote of a link for the product of its ends' signs: the agreement of one normal with the mirror image of the
/// other in the plane between them. Less where the link runs along the normals: it may be noise; and where no circle
/// has these normals at these places: it may join two sheets.
PSK_HD inline std::int64_t vote_of(const LinkedLines& lines, std::int64_t i, std::int32_t j) {
  const Vec3d a = to_double(lines.normals[i]);
  const Vec3d b = to_double(lines.normals[j]);
  const Vec3d d = to_double(lines.positions[j]) - to_double(lines.positions[i]);
  const double squared = dot(d, d);
  double agreement = dot(a, b);
  double level = 1;
  if (squared > 0) {
    const float more = lines.noise[i] > lines.noise[j] ? lines.noise[i] : lines.noise[j];
    const double noise = kNoise * static_cast<double>(more);
    const double along_a = beyond_noise(dot(a, d), noise);
    const double along_b = beyond_noise(dot(b, d), noise);
    agreement -= 2 * along_a * along_b / squared;
    const double steepest = along_a * along_a > along_b * along_b ? along_a * along_a : along_b * along_b;
    const double skew = along_a + (agreement < 0 ? -along_b : along_b);
    const double share = skew * skew / (squared * kSkew * kSkew);
    level = (1 - steepest / squared) / (1 + share * share);
    if (level < 0) level = 0;
  }
  const double trust = static_cast<double>(lines.flatness[i]) * static_cast<double>(lines.flatness[j]);
  const double vote = agreement * level * trust * static_cast<double>(kFullVote);
  const auto whole = static_cast<std::int64_t>(vote < 0 ? vote - 0.5 : vote + 0.5);
  return size_of(whole) < kLeastVote ? 0 : whole;
}

}  // namespace sign_graph
}  // namespace pointskin::normals
