// What src/octree promises, against octree::find_violations and an octree made of sets, on any space.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <map>
#include <numeric>
#include <string>
#include <utility>
#include <vector>

#include "octree/access.hpp"
#include "octree/check.hpp"
#include "octree/octree_data.hpp"
#include "unit/octree/brute_octree.hpp"

namespace pointskin::test {

inline constexpr std::uint64_t kSeed = 20240611;

/// An octree in its space, and everything about it on the host.
struct BuiltOctree {
  octree::SortedPoints sorted;
  octree::OctreeData data;
  octree::HostOctree host;
  std::vector<std::uint64_t> keys;
};

template <exec::Space S>
octree::SortedPoints sort_cloud(S& ex, const std::vector<Vec3f>& points, const std::vector<std::uint64_t>& ties) {
  return octree::sort_points(ex, upload(ex, points).cview(), upload(ex, ties).cview());
}

template <exec::Space S>
BuiltOctree build(S& ex, const std::vector<Vec3f>& points, int depth) {
  BuiltOctree built;
  built.sorted = sort_cloud(ex, points, std::vector<std::uint64_t>(points.size(), 0));
  built.keys = to_host(ex, built.sorted.keys);
  built.data = octree::build_octree(ex, built.sorted.keys.cview(), depth);
  built.host = octree::download(ex, built.data);
  return built;
}

/// Calls use(cloud, depth, built) for all clouds at all of `depths`, and for the sparse ones at depth 20.
template <exec::Space S, class Use>
void for_each_octree(S& ex, const std::vector<int>& depths, const Use& use) {
  const auto run = [&](const TestCloud& cloud, int depth) {
    SCOPED_TRACE(::testing::Message() << "cloud '" << cloud.name << "', depth " << depth << ", seed " << kSeed);
    use(cloud, depth, build(ex, cloud.points, depth));
  };
  for (const TestCloud& cloud : all_clouds(kSeed))
    for (const int depth : depths) run(cloud, depth);
  for (const TestCloud& cloud : sparse_clouds(kSeed)) run(cloud, 20);
}

inline Cell to_cell(const octree::Coordinates& c) { return {c.x, c.y, c.z}; }

/// Position of a node among those of its level.
inline Cell node_position(const octree::LevelView& level, std::int64_t node) {
  return to_cell(octree::decode(level.node_key(static_cast<std::int32_t>(node))));
}

/// The cloud's points, random ones, and the cube's corners.
inline std::vector<Vec3f> probes(const TestCloud& cloud) {
  std::vector<Vec3f> points(cloud.points.begin(),
                            cloud.points.begin() + std::min<std::ptrdiff_t>(std::ssize(cloud.points), 100));
  Random random(kSeed + 1);
  for (int i = 0; i < 200; ++i)
    points.push_back(
        {static_cast<float>(random.unit()), static_cast<float>(random.unit()), static_cast<float>(random.unit())});
  for (int s = 0; s < 8; ++s)
    points.push_back({static_cast<float>(s >> 2), static_cast<float>(s >> 1 & 1), static_cast<float>(s & 1)});
  return points;
}

/// value(level, position) for the nodes of all levels, level-major.
template <class Value>
std::vector<float> node_values(const octree::OctreeView& tree, const Value& value) {
  std::vector<float> values;
  for (int d = 0; d <= tree.depth; ++d)
    for (std::int64_t n = 0; n < tree.levels[d].nodes(); ++n)
      values.push_back(value(d, node_position(tree.levels[d], n)));
  return values;
}

/// Random multiple of 1/64 in [-1, 1]: sums of thousands of products of these and of 1, 1/2, 1/4, 1/8 are exact.
inline float random_value(std::uint64_t seed, int depth, const Cell& c) {
  const std::uint64_t h = hash(seed ^ hash(morton(c) * 32 + static_cast<std::uint64_t>(depth)));
  return static_cast<float>(static_cast<int>(h % 129) - 64) / 64;
}

// ---- Functors of the functions of access.hpp

struct LocateAll {
  octree::OctreeView tree;
  ArrayView<const Vec3f> points;
  int last;
  ArrayView<octree::Leaf> leaves;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f p = points[i];
    leaves[i] = octree::locate(tree, octree::point_key(p.x, p.y, p.z), last);
  }
};

struct EvaluateAll {
  octree::OctreeView tree;
  ArrayView<const float> values;
  ArrayView<const Vec3f> points;
  int last;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = octree::value_at(tree, values.data, points[i], last); }
};

struct ProlongAll {
  octree::LevelView above, level;
  ArrayView<const float> values;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t n) const {
    out[n] = octree::prolonged(above, values.data, level.parent[n >> 3], static_cast<int>(n & 7));
  }
};

struct RestrictAll {
  octree::LevelView level, below;
  ArrayView<const float> values;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t n) const {
    out[n] = octree::restricted(level, below, values.data, static_cast<std::int32_t>(n));
  }
};

template <exec::Space S>
std::vector<float> evaluate(S& ex, const octree::OctreeData& tree, const std::vector<float>& values,
                            const std::vector<Vec3f>& points, int last) {
  const auto device_values = upload(ex, values);
  const auto device_points = upload(ex, points);
  auto out = exec::make_buffer<float>(ex, device_points.size());
  for_each(ex, "test", out.size(),
           EvaluateAll{tree.view(), device_values.cview(), device_points.cview(), last, out.view()});
  return to_host(ex, out);
}

/// `values` of the nodes of level d - 1, prolonged to level d.
template <exec::Space S>
std::vector<float> prolong(S& ex, const octree::OctreeData& tree, int d, const std::vector<float>& values) {
  const octree::OctreeView view = tree.view();
  const auto in = upload(ex, values);
  auto out = exec::make_buffer<float>(ex, view.levels[d].nodes());
  for_each(ex, "test", out.size(), ProlongAll{view.levels[d - 1], view.levels[d], in.cview(), out.view()});
  return to_host(ex, out);
}

/// `values` of the nodes of level d, restricted to level d - 1.
template <exec::Space S>
std::vector<float> restrict_to_above(S& ex, const octree::OctreeData& tree, int d, const std::vector<float>& values) {
  const octree::OctreeView view = tree.view();
  const auto in = upload(ex, values);
  auto out = exec::make_buffer<float>(ex, view.levels[d - 1].nodes());
  for_each(ex, "test", out.size(), RestrictAll{view.levels[d - 1], view.levels[d], in.cview(), out.view()});
  return to_host(ex, out);
}

/// The part of level-major values that belongs to level d.
inline std::vector<float> of_level(const octree::OctreeView& tree, int d, const std::vector<float>& values) {
  const auto first = values.begin() + tree.levels[d].first_node;
  return {first, first + tree.levels[d].nodes()};
}

// ---- Tests

template <class S>
class OctreeOn : public OnSpace<S> {};
TYPED_TEST_SUITE_P(OctreeOn);

TYPED_TEST_P(OctreeOn, HoldsTheCellsOfItsDefinition) {
  for_each_octree(this->space(), {1, 2, 3, 4, 5, 6, 7, 8, 9, 10},
                  [&](const TestCloud& cloud, int depth, const BuiltOctree& built) {
                    const BruteOctree brute(cloud.points, depth);
                    for (int d = 0; d <= depth; ++d) {
                      std::vector<std::uint64_t> expected;
                      for (const Cell& brick : brute.bricks(d)) expected.push_back(morton(brick));
                      std::sort(expected.begin(), expected.end());
                      const octree::HostLevel& level = built.host.levels[static_cast<std::size_t>(d)];
                      expect_same({level.brick_key.begin(), level.brick_key.begin() + level.cell_bricks}, expected);
                    }
                  });
}

TYPED_TEST_P(OctreeOn, CountsThePointsOfEveryCell) {
  for_each_octree(this->space(), {1, 4, 6, 10}, [&](const TestCloud& cloud, int depth, const BuiltOctree& built) {
    const octree::OctreeView tree = built.host.view();
    for (int d = 0; d <= depth; ++d) {
      std::map<Cell, std::int32_t> left;
      for (const Vec3f& p : cloud.points) ++left[cell_of(p, d)];
      const octree::LevelView& level = tree.levels[d];
      for (std::int64_t cell = 0; cell < level.cells(); ++cell)
        left[node_position(level, cell)] -= level.point_begin[cell + 1] - level.point_begin[cell];
      for (const auto& [cell, count] : left) ASSERT_EQ(count, 0) << "level " << d << ", key " << morton(cell);
    }
  });
}

TYPED_TEST_P(OctreeOn, KeepsEveryInvariant) {
  for_each_octree(this->space(), {1, 2, 3, 4, 5, 6, 7, 8, 9, 10}, [&](const TestCloud&, int, const BuiltOctree& built) {
    const ArrayView<const std::uint64_t> keys(built.keys.data(), std::ssize(built.keys));
    for (const std::string& violation : octree::find_violations(built.host, keys)) ADD_FAILURE() << violation;
  });
}

TYPED_TEST_P(OctreeOn, CountsItsNodesAndCells) {
  for_each_octree(this->space(), {1, 4, 7}, [&](const TestCloud&, int, const BuiltOctree& built) {
    std::int64_t nodes = 0;
    std::int64_t cells = -7;  // the root's brick holds one cell
    const octree::OctreeView tree = built.data.view();
    for (const octree::HostLevel& level : built.host.levels) {
      EXPECT_EQ(tree.levels[&level - built.host.levels.data()].first_node, nodes);
      nodes += std::int64_t{8} * level.bricks;
      cells += std::int64_t{8} * level.cell_bricks;
    }
    EXPECT_EQ(built.data.nodes(), nodes);
    EXPECT_EQ(built.data.cells(), cells);
  });
}

TYPED_TEST_P(OctreeOn, LocatesTheDeepestCellOfAPoint) {
  auto& ex = this->space();
  for_each_octree(ex, {1, 5, 9}, [&](const TestCloud& cloud, int depth, const BuiltOctree& built) {
    const BruteOctree brute(cloud.points, depth);
    const octree::OctreeView tree = built.host.view();
    const std::vector<Vec3f> points = probes(cloud);
    const auto device_points = upload(ex, points);
    for (const int last : {0, depth / 2, depth}) {
      auto leaves = exec::make_buffer<octree::Leaf>(ex, device_points.size());
      for_each(ex, "test", leaves.size(), LocateAll{built.data.view(), device_points.cview(), last, leaves.view()});
      const std::vector<octree::Leaf> found = to_host(ex, leaves);
      for (std::size_t i = 0; i < points.size(); ++i) {
        const int expected = brute.leaf_depth(points[i], last);
        ASSERT_EQ(found[i].depth, expected) << "point " << i;
        ASSERT_EQ(node_position(tree.levels[expected], found[i].cell), cell_of(points[i], expected)) << "point " << i;
      }
    }
  });
}

/// Trilinear interpolation of random_value() in the cell of level d that holds p.
inline double interpolated_by_hand(const Vec3f& p, int d) {
  const Cell c = cell_of(p, d);
  const double at[3] = {p.x, p.y, p.z};
  double sum_of_corners = 0;
  for (int s = 0; s < 8; ++s) {
    const Cell corner{s >> 2, s >> 1 & 1, s & 1};
    double weight = 1;
    for (std::size_t a = 0; a < 3; ++a) {
      const double local = std::ldexp(at[a], d) - c[a];
      weight *= corner[a] == 1 ? local : 1 - local;
    }
    sum_of_corners += weight * random_value(kSeed, d, sum(c, corner));
  }
  return sum_of_corners;
}

TYPED_TEST_P(OctreeOn, InterpolatesInTheDeepestCellOfAPoint) {
  // Values are at most 1. A weight has two rounded differences and two products, a term one product more, and the sum
  // seven additions: less than 13 roundings of 2^-24 each on sums of at most 1.
  constexpr double kTolerance = 13 * 0x1p-24;
  for_each_octree(this->space(), {1, 5, 9}, [&](const TestCloud& cloud, int depth, const BuiltOctree& built) {
    const BruteOctree brute(cloud.points, depth);
    const auto value = [](int d, const Cell& c) { return random_value(kSeed, d, c); };
    const std::vector<float> values = node_values(built.host.view(), value);
    const std::vector<Vec3f> points = probes(cloud);
    for (const int last : {0, depth - 1, depth}) {
      const std::vector<float> found = evaluate(this->space(), built.data, values, points, last);
      for (std::size_t i = 0; i < points.size(); ++i)
        ASSERT_NEAR(found[i], interpolated_by_hand(points[i], brute.leaf_depth(points[i], last)), kTolerance)
            << "point " << i << ", last " << last;
    }
  });
}

TYPED_TEST_P(OctreeOn, ReproducesLinearFunctions) {
  // |f| <= 4 in the cube; one rounding of the corner values on top of the 13 of the interpolation.
  constexpr double kTolerance = 14 * 0x1p-24 * 4;
  const auto f = [](double x, double y, double z) { return 0.5 + 2 * x - 1.25 * y + 0.75 * z; };
  for_each_octree(this->space(), {1, 5, 10}, [&](const TestCloud& cloud, int depth, const BuiltOctree& built) {
    const std::vector<float> values = node_values(built.host.view(), [&](int d, const Cell& c) {
      return static_cast<float>(f(std::ldexp(c[0], -d), std::ldexp(c[1], -d), std::ldexp(c[2], -d)));
    });
    const std::vector<Vec3f> points = probes(cloud);
    const std::vector<float> found = evaluate(this->space(), built.data, values, points, depth);
    for (std::size_t i = 0; i < points.size(); ++i)
      ASSERT_NEAR(found[i], f(points[i].x, points[i].y, points[i].z), kTolerance) << "point " << i;
  });
}

TYPED_TEST_P(OctreeOn, ProlongsLinearFunctionsExactly) {
  // Coefficients and coordinates of few bits: down to level 10 every sum of eight values is a float. Only corners of
  // cells have all the corners above that they are interpolated from.
  const auto f = [](int d, const Cell& c) {
    return static_cast<float>(1 + std::ldexp(2.0 * c[0] - 3.0 * c[1] + 0.5 * c[2], -d));
  };
  for (const TestCloud& cloud : all_clouds(kSeed)) {
    SCOPED_TRACE(::testing::Message() << "cloud '" << cloud.name << "', seed " << kSeed);
    const BuiltOctree built = build(this->space(), cloud.points, 10);
    const octree::OctreeView tree = built.host.view();
    const std::vector<float> values = node_values(tree, f);
    for (int d = 1; d <= tree.depth; ++d) {
      const octree::LevelView& level = tree.levels[d];
      const std::vector<float> found = prolong(this->space(), built.data, d, of_level(tree, d - 1, values));
      for (std::int64_t cell = 0; cell < level.cells(); ++cell)
        for (int s = 0; s < 8; ++s) {
          const std::int32_t n = level.neighbour(static_cast<std::int32_t>(cell), s >> 2, s >> 1 & 1, s & 1);
          ASSERT_EQ(found[static_cast<std::size_t>(n)], f(d, node_position(level, n)))
              << "level " << d << ", node " << n;
        }
    }
  }
}

inline double dot(const std::vector<float>& a, const std::vector<float>& b) {
  double total = 0;
  for (std::size_t i = 0; i < a.size(); ++i) total += static_cast<double>(a[i]) * b[i];
  return total;
}

TYPED_TEST_P(OctreeOn, RestrictsByTheTransposeOfProlongation) {
  // <P u, v> = <u, R v>. All values are multiples of 1/64 below 32, all sums exact: so are the dot products in double.
  for_each_octree(this->space(), {1, 5, 9}, [&](const TestCloud&, int depth, const BuiltOctree& built) {
    const octree::OctreeView tree = built.host.view();
    const auto any = [](int d, const Cell& c) { return random_value(kSeed + 2, d, c); };
    const std::vector<float> values = node_values(tree, any);
    for (int d = 1; d <= depth; ++d) {
      const std::vector<float> u = of_level(tree, d - 1, values);
      const std::vector<float> v = of_level(tree, d, values);
      const double prolonged = dot(prolong(this->space(), built.data, d, u), v);
      EXPECT_EQ(prolonged, dot(u, restrict_to_above(this->space(), built.data, d, v))) << "level " << d;
      EXPECT_TRUE(v.empty() || prolonged != 0) << "level " << d << ": says nothing";
    }
  });
}

TYPED_TEST_P(OctreeOn, SortsPointsByKeyAndTieBreakFromAnyOrder) {
  auto& ex = this->space();
  for (const TestCloud& cloud : all_clouds(kSeed)) {
    SCOPED_TRACE(::testing::Message() << "cloud '" << cloud.name << "', seed " << kSeed);
    using Point = std::pair<Vec3f, std::uint64_t>;  // position and tie break; some ties have equal ones
    std::vector<Point> points;
    for (const Vec3f& p : cloud.points) points.emplace_back(p, hash(points.size() / 2));
    std::vector<Point> expected;
    for (std::uint64_t round = 0; round < 4; ++round) {
      const std::vector<Point> shuffled = round == 0 ? points : reordered(points, kSeed + round);
      std::vector<Vec3f> positions;
      std::vector<std::uint64_t> ties;
      for (const auto& [position, tie] : shuffled) {
        positions.push_back(position);
        ties.push_back(tie);
      }
      const octree::SortedPoints sorted = sort_cloud(ex, positions, ties);
      const std::vector<std::uint64_t> keys = to_host(ex, sorted.keys);
      std::vector<std::int32_t> order = to_host(ex, sorted.order);
      std::vector<Point> found;
      for (const std::int32_t i : order) found.push_back(shuffled.at(static_cast<std::size_t>(i)));
      std::sort(order.begin(), order.end());
      ASSERT_EQ(std::unique(order.begin(), order.end()) - order.begin(), std::ssize(points)) << "every point once";
      ASSERT_EQ(found.size(), keys.size());
      for (std::size_t i = 0; i < keys.size(); ++i) {
        ASSERT_EQ(keys[i], morton(cell_of(found[i].first, octree::kPointBits)));
        ASSERT_LE(keys[i > 0 ? i - 1 : 0], keys[i]);
      }
      if (round == 0) expected = found;
      expect_same(found, expected);
    }
  }
}

/// Groups of 1, 2, ... `most` points so close that only the lowest bits of their keys differ, some with equal keys.
inline std::vector<Vec3f> tight_groups(int most, Random& random) {
  std::vector<Vec3f> points;
  for (int size = 1; size <= most; ++size) {
    const double at[3] = {random.in(0.1, 0.9), random.in(0.1, 0.9), random.in(0.1, 0.9)};
    const auto near = [&](double x) { return static_cast<float>(x + static_cast<double>(random.below(5)) * 0x1p-21); };
    for (int i = 0; i < size; ++i) points.push_back({near(at[0]), near(at[1]), near(at[2])});
  }
  return points;
}

TYPED_TEST_P(OctreeOn, SortsPointsThatAreNearlyTheSame) {
  auto& ex = this->space();
  for (const int most : {1, 2, 31, 32, 33, 34, 80}) {
    SCOPED_TRACE(::testing::Message() << "groups of up to " << most << ", seed " << kSeed);
    Random random(kSeed);
    const std::vector<Vec3f> points = reordered(tight_groups(most, random), kSeed);
    std::vector<std::uint64_t> ties;
    for (std::size_t i = 0; i < points.size(); ++i) ties.push_back(hash(i / 2));
    const auto key = [&](std::int32_t i) {
      return morton(cell_of(points[static_cast<std::size_t>(i)], octree::kPointBits));
    };
    std::vector<std::int32_t> expected(points.size());
    std::iota(expected.begin(), expected.end(), 0);
    std::stable_sort(expected.begin(), expected.end(), [&](std::int32_t a, std::int32_t b) {
      return std::pair(key(a), ties[static_cast<std::size_t>(a)]) <
             std::pair(key(b), ties[static_cast<std::size_t>(b)]);
    });
    const octree::SortedPoints sorted = sort_cloud(ex, points, ties);
    EXPECT_EQ(to_host(ex, sorted.order), expected);
    const std::vector<std::uint64_t> keys = to_host(ex, sorted.keys);
    ASSERT_EQ(keys.size(), points.size());
    for (std::size_t i = 0; i < keys.size(); ++i) ASSERT_EQ(keys[i], key(expected[i]));
  }
}

/// The cell bricks of a level, which come before its ghosts.
inline std::vector<std::uint64_t> cell_brick_keys(const octree::HostLevel& level) {
  return {level.brick_key.begin(), level.brick_key.begin() + level.cell_bricks};
}

TYPED_TEST_P(OctreeOn, FindsTheBricksOfPoints) {
  auto& ex = this->space();
  for_each_octree(ex, {6, 8, 9, 11, 13}, [&](const TestCloud&, int depth, const BuiltOctree& built) {
    for (const int last : {octree::kCompleteDepth, depth - 3, depth - 1}) {
      if (last < octree::kCompleteDepth) continue;
      const auto bricks = octree::bricks_of_points(ex, built.sorted.keys.cview(), depth, last);
      for (int d = last + 1; d <= depth; ++d)
        EXPECT_EQ(to_host(ex, bricks[static_cast<std::size_t>(d)]),
                  cell_brick_keys(built.host.levels[static_cast<std::size_t>(d)]))
            << "level " << d << " below " << last;
    }
  });
}

/// All points, or without the finest level, whose children then nobody sees.
TYPED_TEST_P(OctreeOn, BuildsLevelsBelowGivenOnes) {
  auto& ex = this->space();
  for_each_octree(ex, {8, 10}, [&](const TestCloud&, int depth, const BuiltOctree& built) {
    const int coarse = depth - 2;
    std::vector<ArrayView<const std::uint64_t>> given;
    for (int d = 0; d <= coarse; ++d) {
      const octree::LevelData& level = built.data.levels[static_cast<std::size_t>(d)];
      given.push_back(level.brick_key.cview().part(0, level.cell_bricks));
    }
    for (const int finest : {depth, depth - 1}) {
      const octree::OctreeData below = octree::build_octree_below(ex, built.sorted.keys.cview(), depth, given, finest);
      const octree::HostOctree host = octree::download(ex, below);
      EXPECT_EQ(below.depth, depth);
      for (int d = 0; d <= finest; ++d) {
        const octree::HostLevel& level = host.levels[static_cast<std::size_t>(d)];
        const octree::HostLevel& whole = built.host.levels[static_cast<std::size_t>(d)];
        if (d < depth - 1 || finest == depth) {
          EXPECT_EQ(cell_brick_keys(level), cell_brick_keys(whole)) << "level " << d;
          EXPECT_EQ(level.point_begin, whole.point_begin) << "level " << d;
        }
        EXPECT_LE(level.cell_bricks, whole.cell_bricks) << "level " << d;
      }
      if (finest < depth) {
        EXPECT_EQ(host.levels.back().bricks, 0);
        const std::vector<std::int32_t>& children = host.levels[static_cast<std::size_t>(finest)].child_brick;
        EXPECT_TRUE(std::all_of(children.begin(), children.end(), [](std::int32_t child) { return child < 0; }));
      }
    }
  });
}

REGISTER_TYPED_TEST_SUITE_P(OctreeOn, HoldsTheCellsOfItsDefinition, CountsThePointsOfEveryCell, KeepsEveryInvariant,
                            CountsItsNodesAndCells, LocatesTheDeepestCellOfAPoint, InterpolatesInTheDeepestCellOfAPoint,
                            ReproducesLinearFunctions, ProlongsLinearFunctionsExactly,
                            RestrictsByTheTransposeOfProlongation, SortsPointsByKeyAndTieBreakFromAnyOrder,
                            SortsPointsThatAreNearlyTheSame, FindsTheBricksOfPoints, BuildsLevelsBelowGivenOnes);

}  // namespace pointskin::test
