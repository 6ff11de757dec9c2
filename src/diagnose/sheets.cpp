#include "diagnose/sheets.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "core/eigen3.hpp"
#include "core/matrix3.hpp"
#include "diagnose/spread.hpp"
#include "exec/this_space.hpp"
#include "octree/access.hpp"

namespace pointskin::diagnose {
namespace {

/// Levels that are tried, from the finest on.
constexpr int kLevels = 5;

/// Moments of the samples around one, in cells of a level, relative to it.
struct Moments {
  double count = 0;
  Vec3d sum{};
  Symmetric3 squares;

  PSK_HD void add(const Vec3d& d) {
    count += 1;
    sum = sum + d;
    squares = squares + outer(d);
  }
  [[nodiscard]] PSK_HD Vec3d mean() const { return sum * (1 / count); }
  [[nodiscard]] PSK_HD Symmetric3 covariance() const { return squares * (1 / count) + outer(mean()) * -1; }
};

/// Standard deviation across the plane of the samples around a sample, in cells of the level; below 0: too few samples,
/// or they lie on two sheets.
struct MeasureThickness {
  static constexpr std::int32_t kFewest = 6;
  static constexpr std::int32_t kFewestForPlane = 12;
  static constexpr std::int32_t kMost = 512;

  octree::OctreeView tree;
  ArrayView<const Vec3f> positions, normals;
  Spread spread;
  ArrayView<float> out;  // (samples, kLevels)

  PSK_HD void operator()(std::int64_t index) const {
    const int above = static_cast<int>(index % kLevels);
    const std::int64_t i = spread(index / kLevels);
    out[index] = above < tree.depth ? thickness(i, tree.depth - above) : -1.0F;
  }

 private:
  /// Ranges of the samples in the cells around that of sample i on level `depth`.
  template <class Visit>
  PSK_HD void for_cells_around(std::int64_t i, int depth, const Visit& visit) const {
    const octree::LevelView& level = tree.levels[depth];
    const Vec3f p = positions[i];
    const octree::Leaf leaf = octree::locate(tree, octree::point_key(p.x, p.y, p.z), depth);
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const std::int32_t cell = level.neighbour(leaf.cell, dx, dy, dz);
          if (level.is_cell(cell)) visit(level.point_begin[cell], level.point_begin[cell + 1]);
        }
  }

  /// Those samples, or every `step`th of them: index and place relative to sample i, in cells.
  template <class Visit>
  PSK_HD void for_samples_around(std::int64_t i, int depth, std::int32_t step, const Visit& visit) const {
    const auto scale = static_cast<double>(std::int64_t{1} << depth);
    for_cells_around(i, depth, [&](std::int32_t first, std::int32_t end) {
      for (std::int32_t j = first; j < end; ++j)
        if (j % step == 0) visit(j, (to_double(positions[j]) - to_double(positions[i])) * scale);
    });
  }

  [[nodiscard]] PSK_HD float thickness(std::int64_t i, int depth) const {
    std::int32_t all = 0;
    for_cells_around(i, depth, [&](std::int32_t first, std::int32_t end) { all += end - first; });
    if (all < kFewest) return -1;
    const std::int32_t step = (all + kMost - 1) / kMost;
    return normals.empty() ? across_plane(i, depth, step) : across_normals(i, depth, step);
  }

  /// Half the squared distances along the mean of two normals, to which even curvature does not add
  /// (poisson/trust.hpp).
  [[nodiscard]] PSK_HD float across_normals(std::int64_t i, int depth, std::int32_t step) const {
    constexpr double kAgreement = 0.75;  // what faces elsewhere is another sheet, or bends away
    constexpr double kTypical = 1.18;    // the median sample lies 2/3 of a standard deviation off itself
    const Vec3d n = to_double(normals[i]);
    double count = 0;
    double sum = 0;
    for_samples_around(i, depth, step, [&](std::int32_t j, const Vec3d& d) {
      const Vec3d m = to_double(normals[j]);
      if (!(dot(n, m) > kAgreement)) return;
      const double across = 0.5 * dot(n + m, d);
      sum += 0.5 * across * across;
      count += 1;
    });
    return count < kFewest ? -1.0F : static_cast<float>(kTypical * std::sqrt(sum / count));
  }

  [[nodiscard]] PSK_HD float across_plane(std::int64_t i, int depth, std::int32_t step) const {
    Moments moments;
    for_samples_around(i, depth, step, [&](std::int32_t, const Vec3d& d) { moments.add(d); });
    if (moments.count < kFewestForPlane) return -1;
    const Eigen3 axes = eigen_of(moments.covariance());
    const double variance = axes.values[0] > 0 ? axes.values[0] : 0;
    const double mean = dot(axes.vectors[0], moments.mean());
    double third = 0;
    double fourth = 0;
    for_samples_around(i, depth, step, [&](std::int32_t, const Vec3d& d) {
      const double height = dot(axes.vectors[0], d) - mean;
      third += height * height * height;
      fourth += height * height * height * height;
    });
    if (are_two_sheets(variance, third / moments.count, fourth / moments.count)) return -1;
    return static_cast<float>(std::sqrt(variance));
  }

  /// Kurtosis less squared skewness is 1 for any two values (Pearson), 1.8 for the flattest noise, 3 for a normal
  /// distribution.
  PSK_HD static bool are_two_sheets(double variance, double third, double fourth) {
    constexpr double kTwoSheets = 1.5;
    return fourth * variance - third * third < kTwoSheets * variance * variance * variance;
  }
};

/// Of the thicknesses on one level; below 0 where most samples have none.
double median_on(const std::vector<float>& all, int above) {
  std::vector<float> values;
  for (std::size_t i = static_cast<std::size_t>(above); i < all.size(); i += kLevels)
    if (all[i] >= 0) values.push_back(all[i]);
  if (2 * values.size() * kLevels < all.size()) return -1;
  const auto middle = values.begin() + static_cast<std::ptrdiff_t>((values.size() - 1) / 2);
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace

template <exec::Space Exec>
double measure_noise(Exec& ex, const octree::OctreeView& tree, ArrayView<const Vec3f> positions,
                     ArrayView<const Vec3f> normals) {
  const double widest = normals.empty() ? 0.35 : 0.5;  // of a cell: thicker ones look like volumes; to few points less
  const std::int64_t some = std::min(positions.size, kSheetSamples);
  auto out = exec::make_buffer<float>(ex, some * kLevels);
  for_each(ex, "look.sheets", out.size(),
           MeasureThickness{tree, positions, normals, {some, positions.size}, out.view()});
  std::vector<float> all(static_cast<std::size_t>(out.size()));
  copy_to_host(ex, out.cview(), all.data());
  for (int above = 0; above < kLevels; ++above) {
    const double thickness = median_on(all, above);
    if (thickness >= 0 && thickness <= widest) return std::ldexp(thickness, above);
  }
  return 0;
}

PSK_INSTANTIATE(measure_noise);

}  // namespace pointskin::diagnose
