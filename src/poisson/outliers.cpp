#include "poisson/outliers.hpp"

#include <cstdint>

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

struct DropOutlier {
  ArrayView<const Vec3f> positions, normals;
  ArrayView<const float> splat_depths;
  ArrayView<const double> total_density;  // one element
  ArrayView<float> areas;

  PSK_HD void operator()(std::int64_t i) const {
    const double usual = static_cast<double>(areas.size) / total_density[0];
    if (areas[i] > kUnusualArea * usual && !is_confirmed(i)) areas[i] = 0;
  }

  [[nodiscard]] PSK_HD bool is_confirmed(std::int64_t i) const {
    const float near = kNearCells / static_cast<float>(std::int64_t{1} << static_cast<int>(splat_depths[i]));
    const std::int64_t first = i > kWindow ? i - kWindow : 0;
    const std::int64_t end = i + kWindow < positions.size ? i + kWindow + 1 : positions.size;
    int neighbours = 0;
    int confirming = 0;
    for (std::int64_t j = first; j < end; ++j) {
      const Vec3f step = positions[j] - positions[i];
      const float distance2 = squared_length(step);
      if (j == i || !(distance2 < near * near)) continue;
      const float cosine = dot(normals[i], normals[j]);
      if (cosine < kOtherSideCosine) continue;
      ++neighbours;
      const float across = 0.5F * dot(normals[i] + normals[j], step);
      if (cosine > kLeastCosine && across * across <= kMostBend * distance2) ++confirming;
    }
    return confirming >= kFewestConfirming &&
           static_cast<float>(confirming) >= kLeastConfirming * static_cast<float>(neighbours);
  }
};

}  // namespace

template <exec::Space Exec>
void drop_outliers(Exec& ex, Samples& samples) {
  const std::int64_t n = samples.areas.size();
  const exec::Buffer<double> density =
      exec::reduce_in_space<double>(ex, kLabel, n, DensityOf{samples.areas.cview()}, Add{});
  for_each(ex, kLabel, n,
           DropOutlier{samples.positions.cview(), samples.normals.cview(), samples.splat_depths.cview(),
                       density.cview(), samples.areas.view()});
}

PSK_INSTANTIATE(drop_outliers);

}  // namespace pointskin::poisson
