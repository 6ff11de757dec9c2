#include "poisson/outliers.hpp"

#include <algorithm>
#include <cstdint>

#include "exec/atomic.hpp"
#include "exec/this_space.hpp"

namespace pointskin::poisson {
namespace {

constexpr const char* kLabel = "density.outliers";

struct DensityOf {
  ArrayView<const float> areas;
  PSK_HD double operator()(std::int64_t i) const { return 1.0 / areas[i]; }
};

struct Add {
  PSK_HD double operator()(double a, double b) const { return a + b; }
};

/// The neighbours of a sample.
struct Around {
  ArrayView<const Vec3f> positions, normals;
  ArrayView<const float> splat_depths;

  /// Calls visit(j, step) for every neighbour, with its place and the way to it.
  template <class Visit>
  PSK_HD void operator()(std::int64_t i, const Visit& visit) const {
    const float near = kNearCells / static_cast<float>(std::int64_t{1} << static_cast<int>(splat_depths[i]));
    const std::int64_t first = i > kWindow ? i - kWindow : 0;
    const std::int64_t end = i + kWindow < positions.size ? i + kWindow + 1 : positions.size;
    for (std::int64_t j = first; j < end; ++j) {
      const Vec3f step = positions[j] - positions[i];
      if (j != i && squared_length(step) < near * near) visit(j, step);
    }
  }

  [[nodiscard]] PSK_HD bool is_confirmed(std::int64_t i) const {
    int neighbours = 0;
    int confirming = 0;
    (*this)(i, [&](std::int64_t j, const Vec3f& step) {
      const float cosine = dot(normals[i], normals[j]);
      if (cosine < kOtherSideCosine) return;
      ++neighbours;
      const float across = 0.5F * dot(normals[i] + normals[j], step);
      if (cosine > kLeastCosine && across * across <= kMostBend * squared_length(step)) ++confirming;
    });
    return confirming >= kFewestConfirming &&
           static_cast<float>(confirming) >= kLeastConfirming * static_cast<float>(neighbours);
  }

  [[nodiscard]] PSK_HD bool faces_like_others(std::int64_t i) const {
    int neighbours = 0;
    int alike = 0;
    (*this)(i, [&](std::int64_t j, const Vec3f& /*step*/) {
      ++neighbours;
      if (dot(normals[i], normals[j]) > kAlikeCosine) ++alike;
    });
    return neighbours < kManyNeighbours || alike >= kFewestAlike;
  }
};

struct CountAlike {
  Around around;
  std::int64_t looked_at;
  std::uint64_t* alike;
  PSK_HD void operator()(std::int64_t s) const {
    if (around.faces_like_others(s * around.positions.size / looked_at)) exec::add(alike, 1);
  }
};

struct DropOutlier {
  Around around;
  ArrayView<const double> total_density;  // one element
  const std::uint64_t* alike;
  double needed;  // of the looked at
  ArrayView<const float> own_side;
  ArrayView<float> areas;
  std::uint64_t* lonely;

  PSK_HD void operator()(std::int64_t i) const {
    const auto largest = static_cast<float>(kUnusualArea * (static_cast<double>(areas.size) / total_density[0]));
    const bool is_usual = !(own_side[i] > largest);
    if (own_side[i] > kLonely * largest) exec::add(lonely, 1);
    if ((!is_usual && !around.is_confirmed(i)) ||
        (static_cast<double>(*alike) >= needed && !around.faces_like_others(i))) {
      areas[i] = 0;
    } else if (is_usual) {
      areas[i] = own_side[i];
    } else if (areas[i] < largest) {
      areas[i] = largest;
    }
  }
};

}  // namespace

template <exec::Space Exec>
void drop_outliers(Exec& ex, ArrayView<const float> own_side, Samples& samples) {
  const std::int64_t n = samples.areas.size();
  const Around around{samples.positions.cview(), samples.normals.cview(), samples.splat_depths.cview()};
  const std::int64_t looked_at = std::min(kLookedAt, n);
  auto alike = exec::make_buffer<std::uint64_t>(ex, 1);
  samples.lonely = exec::make_buffer<std::uint64_t>(ex, 1);
  exec::fill(ex, alike.view(), std::uint64_t{0});
  exec::fill(ex, samples.lonely.view(), std::uint64_t{0});
  for_each(ex, kLabel, looked_at, CountAlike{around, looked_at, alike.data()});
  const exec::Buffer<double> density = exec::reduce_in_space<double>(ex, kLabel, n, DensityOf{own_side}, Add{});
  for_each(ex, kLabel, n,
           DropOutlier{around, density.cview(), alike.data(), kMostlyAlike * static_cast<double>(looked_at), own_side,
                       samples.areas.view(), samples.lonely.data()});
}

PSK_INSTANTIATE(drop_outliers);

}  // namespace pointskin::poisson
