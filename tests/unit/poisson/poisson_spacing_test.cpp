// Distances between samples, against sums over all samples.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"
#include "poisson/spacing.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::Random;
using test::SmallTree;

float spacing_at(SmallTree& tree, const poisson::Density& density, const Vec3f& p, const Vec3f& n) {
  return poisson::SpacingView{density.depth, density.counts.data()}.cells(tree.view, p, n);
}

/// Sum over the samples of sum_i phi_i(p) phi_i(q), hats of one level.
double hats_between(const SmallTree& tree, const Vec3f& p, int level) {
  const double scale = std::ldexp(1.0, level);
  const auto along = [&](double a, double b) {
    const double base = std::floor(a * scale);
    double sum = 0;
    for (int i = 0; i <= 1; ++i)
      sum += std::max(0.0, 1 - std::abs(a * scale - base - i)) * std::max(0.0, 1 - std::abs(b * scale - base - i));
    return sum;
  };
  double sum = 0;
  for (std::int64_t i = 0; i < tree.samples.positions.size(); ++i) {
    const Vec3f& q = tree.samples.positions.data()[i];
    sum += along(p.x, q.x) * along(p.y, q.y) * along(p.z, q.z);
  }
  return sum;
}

/// The documented formula, in double and without the octree.
double reference_spacing(const SmallTree& tree, int depth, const Vec3f& p, const Vec3f& n) {
  const auto on_face = [&](int level) {
    const auto stretched = [&](double normal, double x) {
      const double t = x * std::ldexp(1.0, level) - std::floor(x * std::ldexp(1.0, level));
      return normal / (t * t + (1 - t) * (1 - t));
    };
    const double length = std::hypot(stretched(n.x, p.x), stretched(n.y, p.y), stretched(n.z, p.z));
    return hats_between(tree, p, level) * (length > 0 ? length : 1.5);
  };
  int level = depth;
  double finer = 0;
  double here = on_face(level);
  while (level > 0 && here < 8) {
    finer = here;
    here = std::max(on_face(--level), 2 * finer);
  }
  const double face = std::pow(4.0, tree.view.depth - level);
  if (here < 8 || level == depth) return std::sqrt(face / here);
  const double t = (8 - finer) / (here - finer);
  return std::sqrt(face / 4 * (1 + 3 * t) / 8);
}

TEST(Spacing, IsTheDocumentedFormulaOfSumsOverAllSamples) {
  for (const int depth : {3, 5, 8}) {
    Random random(static_cast<std::uint64_t>(depth));
    SmallTree tree(test::clustered_points(random, 6, 60, 0.05, 0.1, 0.9), {}, depth);
    const poisson::Density density = poisson::splat_density(tree.ex, tree.tree, tree.samples.positions.cview());
    for (int i = 0; i < 400; ++i) {
      const Vec3f near_a_sample = tree.samples.positions.data()[random.below(tree.samples.positions.size())];
      const Vec3d step = random.direction();
      const auto reach = static_cast<float>(0.1 * random.unit());
      const Vec3f p = i % 2 == 0 ? Vec3f{std::clamp(near_a_sample.x + reach * static_cast<float>(step[0]), 0.F, 1.F),
                                         std::clamp(near_a_sample.y + reach * static_cast<float>(step[1]), 0.F, 1.F),
                                         std::clamp(near_a_sample.z + reach * static_cast<float>(step[2]), 0.F, 1.F)}
                                 : to_float({random.unit(), random.unit(), random.unit()});
      const Vec3f n = i % 5 == 0 ? Vec3f{} : to_float(random.direction());
      const double expected = reference_spacing(tree, density.depth, p, n);
      ASSERT_NEAR(spacing_at(tree, density, p, n), expected, 2e-3 * expected) << "depth " << depth << ", point " << i;
    }
  }
}

/// Samples of the half z < 1/2 of a tilted plane.
SmallTree half_plane(std::int64_t n, int depth) {
  Random random(7);
  std::vector<Vec3f> points;
  std::vector<Vec3f> normals;
  for (std::int64_t i = 0; i < n; ++i) {
    const double x = random.in(0.1, 0.5);
    points.push_back(to_float({x, random.in(0.1, 0.9), 0.3 + 0.25 * x}));
    normals.push_back({-0.2425356F, 0, 0.9701425F});
  }
  return {points, normals, depth};
}

TEST(Spacing, IsContinuousAlongAnyLine) {
  SmallTree tree = half_plane(2'000, 8);
  const poisson::Density density = poisson::splat_density(tree.ex, tree.tree, tree.samples.positions.cview());
  Random random(8);
  for (int line = 0; line < 200; ++line) {
    const Vec3d from = {random.unit(), random.unit(), random.unit()};
    const Vec3d to = {random.unit(), random.unit(), random.unit()};
    const Vec3f n = to_float(random.direction());
    constexpr int kSteps = 4000;
    float last = 0;
    for (int i = 0; i <= kSteps; ++i) {
      const double t = static_cast<double>(i) / kSteps;
      const float here = spacing_at(
          tree, density,
          to_float({from[0] + t * (to[0] - from[0]), from[1] + t * (to[1] - from[1]), from[2] + t * (to[2] - from[2])}),
          n);
      // Steps are at most 1/2300 of the cube, 1/36 of a cell of the finest counted level; the smallest jump between
      // levels would be of 41 %.
      if (i > 0) {
        ASSERT_LT(std::abs(here - last), 0.15F * std::min(here, last)) << "line " << line << ", step " << i;
      }
      last = here;
    }
  }
}

TEST(Spacing, OfEvenSamplesIsTheirDistanceAndGrowsBeyondTheBorder) {
  constexpr std::int64_t kSamples = 20'000;
  SmallTree tree = half_plane(kSamples, 8);
  const poisson::Density density = poisson::splat_density(tree.ex, tree.tree, tree.samples.positions.cview());
  const double area = 0.4 * 0.8 * std::hypot(1, 0.25) * std::ldexp(1, 16);
  const double distance = std::sqrt(area / kSamples);  // in finest cells
  const auto mean_at = [&](double x) {
    double sum = 0;
    for (int i = 0; i < 200; ++i) {
      const double y = 0.2 + 0.6 * i / 199;
      sum += spacing_at(tree, density, to_float({x, y, 0.3 + 0.25 * x}), {-0.2425356F, 0, 0.9701425F}) / 200;
    }
    return sum;
  };
  for (const double x : {0.17, 0.2, 0.2345, 0.3, 0.4}) EXPECT_NEAR(mean_at(x), distance, 0.08 * distance) << x;
  double last = mean_at(0.49);
  for (const double x : {0.5, 0.505, 0.51, 0.52, 0.55, 0.6, 0.7, 0.9}) {
    EXPECT_GT(mean_at(x), last) << x;
    last = mean_at(x);
  }
  EXPECT_NEAR(mean_at(0.5), std::sqrt(2) * distance, 0.12 * distance) << "half of the neighbours are missing";
}

TEST(Spacing, OfTheSparsestIsTheOrderStatistic) {
  Random random(9);
  std::vector<Vec3f> points = test::clustered_points(random, 5, 101, 0.04, 0.2, 0.8);
  std::vector<Vec3f> normals;
  for (std::size_t i = 0; i < points.size(); ++i) normals.push_back(to_float(random.direction()));
  SmallTree tree(points, normals, 7);
  const poisson::Density density = poisson::splat_density(tree.ex, tree.tree, tree.samples.positions.cview());
  std::vector<float> all;
  for (std::int64_t i = 0; i < tree.samples.positions.size(); ++i)
    all.push_back(spacing_at(tree, density, tree.samples.positions.data()[i], tree.samples.normals.data()[i]));
  std::sort(all.rbegin(), all.rend());
  for (const double share : {0.0, 1e-6, 0.01, 0.5, 0.999, 0.9999999})
    EXPECT_EQ(poisson::spacing_of_sparsest(tree.ex, tree.tree, density, tree.samples.positions.cview(),
                                           tree.samples.normals.cview(), share),
              all[static_cast<std::size_t>(share * static_cast<double>(all.size()))])
        << share;
}

}  // namespace
}  // namespace pointskin
