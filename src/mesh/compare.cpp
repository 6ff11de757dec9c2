// Distances between two surfaces, sampled on each and measured to the other, and the scores derived from them.
// Source of the scores: Knapitsch et al., "Tanks and Temples", ACM TOG 36, 2017 (precision, recall, F-score);
// Mescheder et al., "Occupancy Networks", CVPR 2019 (normal consistency).
#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "mesh/both_ways.hpp"
#include "mesh/compared_side.hpp"

namespace pointskin {
namespace {

using exec::Cpu;
using mesh_detail::ComparedSide;
using mesh_detail::Direction;
using mesh_detail::SurfaceSample;

/// Samples per block: neighbours in a block start their search at each other's nearest triangle or point.
constexpr std::int64_t kSampleBlock = 1024;

struct Sums {
  double distance = 0, squared = 0, largest = 0, cosine = 0;
  std::int64_t near = 0;     ///< samples within the threshold
  std::int64_t cosines = 0;  ///< pairs that both have a normal
};

/// Measures samples of one surface to the nearest points of another.
class OneWay {
 public:
  OneWay(const ComparedSide& from, const ComparedSide& to, std::int64_t samples, double threshold)
      : from_(from), to_(to), samples_(from.samples(samples)), threshold_(threshold) {}

  [[nodiscard]] Direction measure(Cpu& ex) const {
    exec::Buffer<double> distances(ex.pool(), samples_);
    std::vector<Sums> parts(static_cast<std::size_t>(exec::block_count(samples_, kSampleBlock)));
    ex.run_blocks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t b) {
      const std::int64_t end = std::min(samples_, (b + 1) * kSampleBlock);
      parts[static_cast<std::size_t>(b)] = measure_block(b * kSampleBlock, end, distances.view());
    });
    Sums all;
    for (const Sums& part : parts) add(part, all);
    return conclude(all, distances.view());
  }

 private:
  [[nodiscard]] Sums measure_block(std::int64_t begin, std::int64_t end, ArrayView<double> distances) const {
    Sums sums;
    std::int32_t hint = -1;
    for (std::int64_t i = begin; i < end; ++i) {
      const SurfaceSample sample = from_.sample(i, samples_);
      const mesh_detail::Nearest nearest = to_.nearest(sample.point, hint);
      hint = nearest.slot;
      const double distance = std::sqrt(nearest.squared_distance);
      distances[i] = distance;
      sums.distance += distance;
      sums.squared += nearest.squared_distance;
      sums.largest = std::max(sums.largest, distance);
      sums.near += distance <= threshold_ ? 1 : 0;
      const Vec3d normal = to_.normal(nearest.slot);
      if (sample.normal == Vec3d{0, 0, 0} || normal == Vec3d{0, 0, 0}) continue;
      sums.cosine += std::min(1.0, std::abs(dot(sample.normal, normal)));
      ++sums.cosines;
    }
    return sums;
  }

  static void add(const Sums& part, Sums& all) {
    all.distance += part.distance;
    all.squared += part.squared;
    all.largest = std::max(all.largest, part.largest);
    all.cosine += part.cosine;
    all.near += part.near;
    all.cosines += part.cosines;
  }

  /// Reorders `distances`.
  [[nodiscard]] Direction conclude(const Sums& all, ArrayView<double> distances) const {
    const auto n = static_cast<double>(samples_);
    // The smallest distance that at least 95 % of the samples do not exceed: rank ceil(0.95 n), counted from one.
    double* const p95 = distances.begin() + (samples_ - samples_ / 20 - 1);
    std::nth_element(distances.begin(), p95, distances.end());
    Direction result;
    result.distances = {all.distance / n, std::sqrt(all.squared / n), *p95, all.largest};
    result.normal_consistency = all.cosines > 0 ? all.cosine / static_cast<double>(all.cosines) : 0;
    result.share_near = static_cast<double>(all.near) / n;
    result.samples = samples_;
    return result;
  }

  const ComparedSide& from_;
  const ComparedSide& to_;
  std::int64_t samples_;
  double threshold_;
};

void check_options(const CompareOptions& options) {
  if (options.samples <= 0) throw Error(ErrorCode::usage, "the number of samples must be positive");
  if (!(options.tau > 0) || !std::isfinite(options.tau))
    throw Error(ErrorCode::usage, "tau must be a positive fraction of the reference's diagonal");
}

bool has_normals(const ComparedSurface& surface) { return surface.mesh() != nullptr || surface.cloud()->has_normals(); }

}  // namespace

MeshComparison compare(const ComparedSurface& surface, const ComparedSurface& reference,
                       const CompareOptions& options) {
  check_options(options);
  Cpu ex(options.threads);
  mesh_detail::checked_diagonal(ex, surface, surface.mesh() != nullptr ? "the mesh" : "the cloud");
  const double diagonal = mesh_detail::checked_diagonal(ex, reference, "the reference");
  if (!(diagonal > 0))
    throw Error(ErrorCode::invalid_input, "the reference has no extent; distances cannot be compared with its size");
  const double threshold = options.tau * diagonal;

  // Both live in the reference's coordinates; only a difference of origins, taken in double, enters them.
  const auto ours = mesh_detail::prepare(ex, surface, surface.origin() - reference.origin());
  const auto theirs = mesh_detail::prepare(ex, reference, Vec3d{0, 0, 0});
  const Direction there = OneWay(*ours, *theirs, options.samples, threshold).measure(ex);
  const Direction back = OneWay(*theirs, *ours, options.samples, threshold).measure(ex);
  MeshComparison result = mesh_detail::both_ways(there, back, diagonal);
  result.has_normals = has_normals(surface) && has_normals(reference);
  return result;
}

}  // namespace pointskin
