// Attributes of samples at any point, against sums over hats found by coordinates instead of by the octree's tables.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "field/attributes.hpp"
#include "support/attributes.hpp"
#include "unit/poisson/small_tree.hpp"

namespace pointskin {
namespace {

using test::SmallTree;

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
constexpr float kInfinity = std::numeric_limits<float>::infinity();

using Corner = std::array<int, 3>;

/// Calls f(corner, weight) for the 8 corners of the cell of level `depth` around p.
template <class F>
void for_hats(const Vec3f& p, int depth, const F& f) {
  const std::array<double, 3> x = {std::ldexp(p.x, depth), std::ldexp(p.y, depth), std::ldexp(p.z, depth)};
  for (int s = 0; s < 8; ++s) {
    Corner c{};
    double weight = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const auto cell = std::min(static_cast<int>(x[a]), (1 << depth) - 1);
      const int upper = s >> a & 1;
      c[a] = cell + upper;
      weight *= upper != 0 ? x[a] - cell : 1 - (x[a] - cell);
    }
    f(c, weight);
  }
}

/// Pull-push of one attribute in double, over maps of the corners that samples reach.
class BruteForce {
 public:
  BruteForce(const SmallTree& tree, const std::vector<float>& weights, const std::vector<float>& values)
      : view_(tree.view), levels_(static_cast<std::size_t>(tree.view.depth) + 1) {
    for (std::size_t i = 0; i < values.size(); ++i) {
      if (!std::isfinite(values[i])) continue;
      for_hats(tree.samples.positions.data()[i], view_.depth, [&](const Corner& c, double hat) {
        Mean& mean = level(view_.depth)[c];
        const double weight = hat * (weights.empty() ? 1.0 : weights[i]);
        mean.weight += weight;
        mean.sum += weight * values[i];
      });
    }
    for (int d = view_.depth; d > 0; --d)
      for (const auto& [c, mean] : level(d)) pull(c, mean, level(d - 1));
  }

  double at(const Vec3f& p) {
    const octree::Leaf leaf = octree::locate(view_, octree::point_key(p.x, p.y, p.z), view_.depth);
    double sum = 0;
    for_hats(p, leaf.depth, [&](const Corner& c, double hat) { sum += hat * value(leaf.depth, c); });
    return sum;
  }

 private:
  struct Mean {
    double weight = 0, sum = 0;
    [[nodiscard]] double cap() const { return weight > 1 ? 1 / weight : 1; }
  };
  using Level = std::map<Corner, Mean>;

  Level& level(int depth) { return levels_[static_cast<std::size_t>(depth)]; }

  /// Adds a corner to those of the level above whose hats reach it.
  static void pull(const Corner& c, const Mean& mean, Level& above) {
    for (int s = 0; s < 8; ++s) {
      Corner to{};
      double weight = mean.cap();
      bool reaches = true;
      for (std::size_t a = 0; a < 3; ++a) {
        const bool odd = c[a] % 2 != 0;
        const int side = s >> a & 1;
        to[a] = c[a] / 2 + side;
        if (odd) weight /= 2;
        reaches = reaches && (odd || side == 0);
      }
      if (!reaches) continue;
      above[to].weight += weight * mean.weight;
      above[to].sum += weight * mean.sum;
    }
  }

  double value(int depth, const Corner& c) {
    const auto [known, is_new] = values_.try_emplace({depth, c}, 0);
    if (!is_new) return known->second;
    const auto found = level(depth).find(c);
    const Mean mean = found == level(depth).end() ? Mean{} : found->second;
    constexpr auto kAbove = double{field::kSamplesAbove};
    const double result = (mean.sum + kAbove * above(depth, c)) / (mean.weight + kAbove);
    return values_[{depth, c}] = result;
  }

  double above(int depth, const Corner& c) {
    double sum = 0;
    double weight = 0;
    if (depth == 0) {
      for (const auto& [at, mean] : level(0)) {
        weight += mean.cap() * mean.weight;
        sum += mean.cap() * mean.sum;
      }
      return sum / weight;
    }
    for (int s = 0; s < 8; ++s) {
      Corner at{};
      for (std::size_t a = 0; a < 3; ++a) at[a] = (c[a] + (s >> a & 1)) / 2;
      sum += value(depth - 1, at) / 8;
    }
    return sum;
  }

  octree::OctreeView view_;
  std::vector<Level> levels_;
  std::map<std::pair<int, Corner>, double> values_;
};

exec::Buffer<float> buffer_of(exec::Cpu& ex, const std::vector<float>& values) {
  auto buffer = exec::make_buffer<float>(ex, static_cast<std::int64_t>(values.size()));
  copy_to_device(ex, values.data(), buffer.view());
  return buffer;
}

std::string name_of(std::size_t channel) { return std::string(1, static_cast<char>('a' + channel)); }

/// What interpolate() hands on, in its order.
struct Taken {
  std::vector<std::string> names;
  std::vector<std::vector<float>> values;
};

/// The attributes of the tree's samples.
field::AttributeSamples samples_of(SmallTree& tree, const std::vector<AttributeValues>& values) {
  field::AttributeSamples samples;
  samples.positions = exec::make_buffer<Vec3f>(tree.ex, tree.samples.positions.size());
  copy(tree.ex, tree.samples.positions.cview(), samples.positions.view());
  const exec::Buffer<std::int32_t> order = exec::iota(tree.ex, samples.positions.size());
  for (const AttributeValues& v : values) {
    const std::size_t place = samples.names.size();
    samples.names.push_back(name_of(place));
    exec::TypedBuffer uploaded = exec::upload_typed(tree.ex, v);
    if (v.type() == AttributeType::float32 || v.type() == AttributeType::float64 || size_of(v.type()) < 4) {
      const field::ValueRange range = field::find_range(tree.ex, uploaded.view(), {});
      samples.channels.push_back(field::make_channel(tree.ex, place, uploaded.view(), range, order.cview()));
    } else {
      samples.labels.push_back({place, std::move(uploaded)});
    }
  }
  return samples;
}

ArrayView<const Vec3f> view_of(const std::vector<Vec3f>& points) {
  return {points.data(), static_cast<std::int64_t>(points.size())};
}

/// The attributes a, b, ... of the tree's samples at `points`.
Taken interpolated(SmallTree& tree, const std::vector<float>& weights, const std::vector<std::vector<float>>& values,
                   const std::vector<Vec3f>& points, AttributeType type = AttributeType::float32) {
  std::vector<AttributeValues> typed;
  for (const std::vector<float>& v : values) typed.push_back(AttributeValues(v).converted(type));
  field::AttributeSamples samples = samples_of(tree, typed);
  samples.weights = buffer_of(tree.ex, weights);
  Taken taken;
  field::interpolate(tree.ex, tree.tree, samples, view_of(points), [&](std::size_t place, exec::TypedBuffer at) {
    EXPECT_EQ(at.type, type);
    taken.names.push_back(samples.names[place]);
    taken.values.push_back(test::floats_of(exec::download_typed(tree.ex, std::move(at))));
  });
  return taken;
}

/// The same for a single attribute without weights.
std::vector<float> interpolated(SmallTree& tree, const std::vector<float>& values, const std::vector<Vec3f>& points,
                                AttributeType type = AttributeType::float32) {
  return interpolated(tree, {}, std::vector<std::vector<float>>{values}, points, type).values[0];
}

std::vector<float> random_values(test::Random& random, std::int64_t n, double lower, double upper) {
  std::vector<float> values;
  for (std::int64_t i = 0; i < n; ++i) values.push_back(static_cast<float>(random.in(lower, upper)));
  return values;
}

std::vector<Vec3f> random_points(test::Random& random, int n) {
  return test::clustered_points(random, n, 1, 0, 0, 0.9999999);
}

TEST(Attributes, AreTheSumsOverHatsThatTheirHeaderStates) {
  for (const int depth : {1, 2, 4, 6, 8})
    for (const std::size_t count : {1U, 2U, 3U, 5U}) {
      test::Random random(10 * static_cast<std::uint64_t>(depth) + count);
      SmallTree tree(test::clustered_points(random, 12, 15, 0.03), {}, depth);
      const std::int64_t n = tree.samples.positions.size();
      const std::vector<float> weights = count == 2 ? random_values(random, n, 0, 3) : std::vector<float>();
      std::vector<std::vector<float>> values;
      for (std::size_t c = 0; c < count; ++c) values.push_back(random_values(random, n, -5, 20));
      const std::vector<Vec3f> near = test::clustered_points(random, 12, 15, 0.03);
      std::vector<Vec3f> points = random_points(random, 100);
      points.insert(points.end(), near.begin(), near.end());
      points.insert(points.end(), tree.samples.positions.data(), tree.samples.positions.data() + n);
      const Taken taken = interpolated(tree, weights, values, points);
      ASSERT_EQ(taken.values.size(), count);
      for (std::size_t c = 0; c < count; ++c) {
        SCOPED_TRACE("depth " + std::to_string(depth) + ", attribute " + name_of(c));
        EXPECT_EQ(taken.names[c], name_of(c));
        BruteForce expected(tree, weights, values[c]);
        for (std::size_t i = 0; i < points.size(); ++i) ASSERT_NEAR(taken.values[c][i], expected.at(points[i]), 1e-4);
      }
    }
}

TEST(Attributes, LeaveOutSamplesWhoseValueIsNotFinite) {  // each attribute others, so that none can share a weight
  test::Random random(3);
  SmallTree tree(test::clustered_points(random, 12, 15, 0.03), {}, 5);
  const std::int64_t n = tree.samples.positions.size();
  std::vector<std::vector<float>> values;
  const std::array<float, 4> missing = {kNan, kInfinity, -kInfinity, kNan};
  for (std::size_t c = 0; c < missing.size(); ++c) {
    values.push_back(random_values(random, n, 0, 1));
    for (std::size_t i = 0; i < values[c].size(); ++i)
      if (i % 4 == c || c == 2) values[c][i] = i == 7 && c == 2 ? 0.5F : missing[c];  // c: one sample counts
  }
  values.push_back(values[1]);  // misses the same samples as the one before
  const std::vector<Vec3f> points = random_points(random, 200);
  const Taken taken = interpolated(tree, {}, values, points);
  for (std::size_t c = 0; c < values.size(); ++c) {
    SCOPED_TRACE("attribute " + name_of(c));
    BruteForce expected(tree, {}, values[c]);
    for (std::size_t i = 0; i < points.size(); ++i) ASSERT_NEAR(taken.values[c][i], expected.at(points[i]), 1e-5);
  }
}

TEST(Attributes, OfNoSamplesAreNone) {
  test::Random random(4);
  SmallTree tree(random_points(random, 50), {}, 4);
  EXPECT_TRUE(interpolated(tree, {}, std::vector<std::vector<float>>{}, random_points(random, 20)).values.empty());
}

TEST(Attributes, WithoutWeightAnywhereAreFiniteAndInTheRange) {
  test::Random random(5);
  SmallTree tree(random_points(random, 50), {}, 4);
  const std::vector<float> none(50, 0.0F);
  const Taken taken = interpolated(tree, none, {random_values(random, 50, 3, 4)}, random_points(random, 20));
  for (const float v : taken.values[0]) EXPECT_TRUE(v >= 3 && v <= 4) << v;
}

TEST(Attributes, ThatAreTheSameEverywhereComeBackExactly) {
  test::Random random(6);
  SmallTree tree(test::clustered_points(random, 30, 15, 0.02), {}, 7);
  const std::vector<Vec3f> points = random_points(random, 500);
  for (const float value : {0.0F, 0.1F, -7.3e-30F, 1.7e9F, 3.4e38F}) {
    const std::vector<float> same(static_cast<std::size_t>(tree.samples.positions.size()), value);
    for (const float v : interpolated(tree, same, points)) ASSERT_EQ(v, value);
  }
}

TEST(Attributes, StayInTheRangeOfTheInputHoweverLargeOrCloseItsValuesAre) {
  test::Random random(7);
  SmallTree tree(test::clustered_points(random, 30, 15, 0.02), {}, 7);
  const std::int64_t n = tree.samples.positions.size();
  const std::vector<Vec3f> points = random_points(random, 500);
  const std::array<std::pair<double, double>, 4> ranges = {
      {{-3.4e38, 3.4e38}, {1e9, 1e9 + 200}, {-1e-42, 1e-42}, {-1, 0}}};
  for (const auto& [lower, upper] : ranges) {
    const std::vector<float> values = random_values(random, n, lower, upper);
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    const std::vector<float> at = interpolated(tree, values, points);
    for (const float v : at) ASSERT_TRUE(v >= *low && v <= *high) << v << " not in " << *low << ", " << *high;
    EXPECT_NE(*std::min_element(at.begin(), at.end()), *std::max_element(at.begin(), at.end()));
  }
}

TEST(Attributes, HaveTheSameRangeWhicheverOfTwoZerosComesFirst) {
  test::Random random(13);
  SmallTree tree(random_points(random, 2), {}, 2);
  for (const std::vector<double>& values : {std::vector<double>{-0.0, 0.0, 1}, {0.0, -0.0, 1}, {-0.0, 0.0, -1}}) {
    const exec::TypedBuffer uploaded = exec::upload_typed(tree.ex, AttributeValues(values));
    const field::ValueRange range = field::find_range(tree.ex, uploaded.view(), {});
    EXPECT_FALSE(std::signbit(range.lowest == 0 ? range.lowest : range.highest));
    EXPECT_EQ(range.counted, 3);
  }
}

TEST(Attributes, OfIntegersAreRoundedWholeNumbers) {
  test::Random random(8);
  SmallTree tree(test::clustered_points(random, 30, 15, 0.02), {}, 6);
  const std::int64_t n = tree.samples.positions.size();
  std::vector<float> values;
  for (std::int64_t i = 0; i < n; ++i) values.push_back(static_cast<float>(random.below(256)));
  const std::vector<Vec3f> points = random_points(random, 500);
  const std::vector<float> exact = interpolated(tree, values, points);
  const std::vector<float> bytes = interpolated(tree, values, points, AttributeType::uint8);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_EQ(bytes[i], std::floor(exact[i] + 0.5F));
  for (float& v : values) v *= 257;
  const std::vector<float> shorts = interpolated(tree, values, points, AttributeType::uint16);
  for (std::size_t i = 0; i < points.size(); ++i) ASSERT_NEAR(shorts[i], 257 * exact[i], 0.51);
}

/// Half-way between two levels' cells, values must agree: leaves of different depth meet there.
TEST(Attributes, AreContinuousAcrossLeavesOfDifferentDepth) {
  test::Random random(9);
  SmallTree tree(test::clustered_points(random, 6, 10, 0.02), {}, 8);
  const std::vector<float> values = random_values(random, tree.samples.positions.size(), 0, 1);
  std::vector<Vec3f> points;
  for (int i = 0; i < 30'000; ++i) {  // pairs at both sides of a cell's face of level 8
    const float face = static_cast<float>(1 + random.below(255)) / 256;
    const auto y = static_cast<float>(random.unit());
    const auto z = static_cast<float>(random.unit());
    points.push_back({std::nextafter(face, 0.0F), y, z});
    points.push_back({face, y, z});
  }
  const std::vector<float> at = interpolated(tree, values, points);
  int borders = 0;
  for (std::size_t i = 0; i < points.size(); i += 2) {
    const auto depth = [&](const Vec3f& p) {
      return octree::locate(tree.view, octree::point_key(p.x, p.y, p.z), 8).depth;
    };
    borders += depth(points[i]) != depth(points[i + 1]) ? 1 : 0;
    ASSERT_NEAR(at[i], at[i + 1], 1e-4);
  }
  EXPECT_GT(borders, 20);
}

/// Place of the nearest sample that is not missing, the first of several; -1 if there is none.
std::int32_t nearest_by_hand(const SmallTree& tree, const AttributeValues& values, const Vec3f& p) {
  float best = kInfinity;
  std::int32_t found = -1;
  for (std::int64_t i = 0; i < tree.samples.positions.size(); ++i) {
    const Vec3f q = tree.samples.positions.data()[i];
    const float x = p.x - q.x, y = p.y - q.y, z = p.z - q.z;
    const float squared = x * x + y * y + z * z;
    if (!(squared < best) || values.is_missing(static_cast<std::size_t>(i))) continue;
    best = squared;
    found = static_cast<std::int32_t>(i);
  }
  return found;
}

/// Numbers of the samples, from `first` on.
AttributeValues numbers(std::int64_t n, std::int64_t first) {
  std::vector<std::int64_t> values(static_cast<std::size_t>(n));
  std::iota(values.begin(), values.end(), first);
  return values;
}

TEST(Labels, AreThoseOfTheNearestSampleThatHasOne) {
  constexpr std::int64_t kFirst = (std::int64_t{1} << 60) + 1;  // beyond what doubles tell apart
  for (const int depth : {1, 3, 6, 9}) {
    test::Random random(100 + static_cast<std::uint64_t>(depth));
    SmallTree tree(test::clustered_points(random, 20, 40, 0.02), {}, depth);
    const std::int64_t n = tree.samples.positions.size();
    std::vector<AttributeValues> values(5, numbers(n, kFirst));
    for (std::size_t i = 0; i < static_cast<std::size_t>(n); ++i) {
      if (i % 3 != 0) values[1].set_missing(i);
      if (i % 3 != 0) values[3].set_missing(i);  // misses the same samples
      if (i != 7) values[4].set_missing(i);
    }
    std::vector<Vec3f> points = random_points(random, 300);
    for (std::int64_t i = 0; i < n; ++i) points.push_back(tree.samples.positions.data()[i]);
    for (const Vec3f& p : test::clustered_points(random, 20, 10, 0.02)) points.push_back(p);
    const field::AttributeSamples samples = samples_of(tree, values);
    ASSERT_EQ(samples.labels.size(), 5U);
    std::size_t taken = 0;
    field::find_labels(tree.ex, tree.tree, samples, view_of(points), [&](std::size_t place, exec::TypedBuffer at) {
      ++taken;
      const AttributeValues labels = exec::download_typed(tree.ex, std::move(at));
      ASSERT_FALSE(labels.has_mask());
      for (std::size_t i = 0; i < points.size(); ++i)
        ASSERT_EQ(labels.as<std::int64_t>()[i] - kFirst, nearest_by_hand(tree, values[place], points[i]))
            << "depth " << depth << ", label " << place << ", point " << i;
    });
    EXPECT_EQ(taken, 5U);
  }
}

TEST(Labels, OfSamplesAsNearAreTheFirst) {
  SmallTree tree({{0.25F, 0.5F, 0.5F}, {0.75F, 0.5F, 0.5F}, {0.25F, 0.5F, 0.5F}, {0.5F, 0.25F, 0.5F}}, {}, 3);
  const std::vector<Vec3f> points{{0.5F, 0.5F, 0.5F}};
  const field::AttributeSamples samples = samples_of(tree, {numbers(4, 0)});
  field::find_labels(tree.ex, tree.tree, samples, view_of(points), [&](std::size_t, exec::TypedBuffer at) {
    EXPECT_EQ(exec::download_typed(tree.ex, std::move(at)).at(0), 0);
  });
}

TEST(Labels, ThatNoSampleHasAreMissing) {
  test::Random random(4);
  SmallTree tree(random_points(random, 50), {}, 4);
  const std::vector<Vec3f> points = random_points(random, 20);
  const field::AttributeSamples samples =
      samples_of(tree, {AttributeValues::missing(AttributeType::int32, 50), numbers(50, 0)});
  field::find_labels(tree.ex, tree.tree, samples, view_of(points), [&](std::size_t place, exec::TypedBuffer at) {
    const AttributeValues labels = exec::download_typed(tree.ex, std::move(at));
    for (std::size_t i = 0; i < points.size(); ++i) EXPECT_EQ(labels.is_missing(i), place == 0);
  });
}

TEST(Attributes, OfDoublesKeepWhatFloatsCannotTellApart) {
  test::Random random(12);
  SmallTree tree(test::clustered_points(random, 30, 15, 0.02), {}, 7);
  const auto n = static_cast<std::size_t>(tree.samples.positions.size());
  const std::vector<Vec3f> points = random_points(random, 500);
  const std::array<std::pair<double, double>, 4> ranges = {
      {{4e8, 4e8 + 0.005}, {-1.7e308, 1.7e308}, {-1e-300, 1e-300}, {1e15, 1e15 + 1000}}};
  for (const auto& [lower, upper] : ranges) {
    const double rounding = std::max(std::abs(lower), std::abs(upper)) * 0x1p-52 / (upper / 2 - lower / 2);
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i)
      values.push_back(lower / 2 + upper / 2 + random.in(-1, 1) * (upper / 2 - lower / 2));
    std::vector<float> shares;
    for (const double v : values) shares.push_back(static_cast<float>((v / 2 - lower / 2) / (upper / 2 - lower / 2)));
    const field::AttributeSamples samples = samples_of(tree, {values, shares});
    std::array<AttributeValues, 2> at;
    field::interpolate(tree.ex, tree.tree, samples, view_of(points), [&](std::size_t place, exec::TypedBuffer taken) {
      at[place] = exec::download_typed(tree.ex, std::move(taken));
    });
    const auto [low, high] = std::minmax_element(values.begin(), values.end());
    std::set<double> distinct;
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double v = at[0].as<double>()[i];
      ASSERT_TRUE(v >= *low && v <= *high) << v;
      ASSERT_NEAR(((v / 2 - lower / 2) / (upper / 2 - lower / 2)), at[1].at(i), 1e-6 + rounding);
      distinct.insert(v);
    }
    EXPECT_GT(distinct.size(), 400U);
  }
  const std::vector<double> same(n, 400000000.000001);
  const field::AttributeSamples samples = samples_of(tree, {same});
  field::interpolate(tree.ex, tree.tree, samples, view_of(points), [&](std::size_t, exec::TypedBuffer taken) {
    for (const double v : exec::download_typed(tree.ex, std::move(taken)).as<double>()) ASSERT_EQ(v, 400000000.000001);
  });
}

}  // namespace
}  // namespace pointskin
