// The octree on the CPU; keys and tables, which are the same everywhere; and the checker itself.
#include "unit/octree/octree_tests.hpp"

#include <functional>
#include <limits>

#include "octree/neighbourhood.hpp"
#include "octree/tables.hpp"

namespace pointskin::test {

INSTANTIATE_TYPED_TEST_SUITE_P(OnCpu, OctreeOn, CpuSpaces);

namespace {

using octree::Coordinates;

TEST(Keys, InterleaveCoordinatesAndGiveThemBack) {
  std::vector<std::int32_t> values{0, 1, 2, 3, 1 << 19, (1 << 20) - 1, 1 << 20, (1 << 20) + 1, (1 << 21) - 1};
  Random random(kSeed);
  for (int i = 0; i < 20; ++i) values.push_back(static_cast<std::int32_t>(random.below(1 << 21)));
  for (const std::int32_t x : values)
    for (const std::int32_t y : values)
      for (const std::int32_t z : values) {
        const std::uint64_t key = octree::encode({x, y, z});
        ASSERT_EQ(key, morton({x, y, z}));
        ASSERT_EQ(octree::decode(key), (Coordinates{x, y, z}));
      }
}

TEST(Keys, OfSiblingsDifferInTheLowestThreeBits) {
  for (int slot = 0; slot < 8; ++slot) {
    const int x = octree::slot_x(slot);
    const int y = octree::slot_y(slot);
    const int z = octree::slot_z(slot);
    EXPECT_EQ(octree::slot_of(x, y, z), slot);
    EXPECT_EQ(octree::encode({10 + x, 20 + y, 30 + z}), octree::encode({5, 10, 15}) << 3 | static_cast<unsigned>(slot));
  }
}

/// Key of a point whose coordinates are all v, as one coordinate.
std::int32_t cell_on_axis(float v) {
  const Coordinates c = octree::decode(octree::point_key(v, v, v));
  EXPECT_TRUE(c.x == c.y && c.y == c.z);
  return c.x;
}

TEST(Keys, OfPointsRoundDownExactly) {
  Random random(kSeed);
  std::vector<float> values{0.0F, -0.0F, std::numeric_limits<float>::denorm_min(), 0.5F, std::nextafterf(1, 0)};
  for (int i = 0; i < 10'000; ++i) {
    const auto border = static_cast<float>(std::ldexp(static_cast<double>(random.below(1 << 21)), -21));
    values.insert(values.end(), {border, std::nextafterf(border, 0), std::nextafterf(border, 1),
                                 static_cast<float>(random.unit() * std::ldexp(0.999, -(i % 30)))});
  }
  for (const float v : values)  // all below 1; 2^21 v is exact in double
    ASSERT_EQ(cell_on_axis(v), static_cast<std::int32_t>(std::ldexp(static_cast<double>(v), 21))) << v;
  EXPECT_EQ(octree::point_key(0.25F, 0.5F, 0.75F), morton({1 << 19, 1 << 20, 3 << 19}));
}

TEST(Keys, OfPointsOutsideAreClampedIntoTheCube) {
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  for (const float v : {-std::numeric_limits<float>::denorm_min(), -1e-9F, -1.0F, -1e30F, -kInfinity})
    EXPECT_EQ(cell_on_axis(v), 0) << v;
  for (const float v : {1.0F, std::nextafterf(1, 2), 2.0F, 1e30F, kInfinity})
    EXPECT_EQ(cell_on_axis(v), (1 << 21) - 1) << v;
}

TEST(Keys, OfCellsAreThePrefixesOfPointKeys) {
  Random random(kSeed);
  for (int i = 0; i < 1000; ++i) {
    const Vec3f p{static_cast<float>(random.unit()), static_cast<float>(random.unit()),
                  static_cast<float>(random.unit())};
    for (int d = 0; d <= octree::kMaxDepth; ++d)
      ASSERT_EQ(octree::cell_key(octree::point_key(p.x, p.y, p.z), d), morton(cell_of(p, d)));
  }
}

TEST(NeighbourTables, SayWhereTheNeighbourOfAChildLies) {
  const Cell parent{4, 4, 4};
  for (int slot = 0; slot < 8; ++slot)
    for (int dx = -1; dx <= 1; ++dx)
      for (int dy = -1; dy <= 1; ++dy)
        for (int dz = -1; dz <= 1; ++dz) {
          const Cell node{8 + (slot >> 2) + dx, 8 + (slot >> 1 & 1) + dy, 8 + (slot & 1) + dz};
          const Cell above{node[0] / 2 - parent[0], node[1] / 2 - parent[1], node[2] / 2 - parent[2]};
          const int j = (dx + 1) * 9 + (dy + 1) * 3 + dz + 1;
          EXPECT_EQ(octree::neighbour_index(dx, dy, dz), j);
          EXPECT_EQ(octree::kNeighbourTables.parent[slot][j], (above[0] + 1) * 9 + (above[1] + 1) * 3 + above[2] + 1);
          EXPECT_EQ(octree::kNeighbourTables.child[slot][j], node[0] % 2 * 4 + node[1] % 2 * 2 + node[2] % 2);
        }
}

/// A graded octree of all features in a few thousand bricks.
BuiltOctree example() {
  exec::Cpu ex(2);
  return build(ex, all_clouds(kSeed).at(7).points, 7);
}

TEST(LevelView, ReachesNodesUpToTwoStepsAway) {
  const BuiltOctree built = example();
  const octree::OctreeView tree = built.host.view();
  for (int d = 0; d <= tree.depth; ++d) {
    const octree::LevelView& level = tree.levels[d];
    std::map<Cell, std::int32_t> node_at;
    for (std::int32_t n = 0; n < level.nodes(); ++n) node_at[node_position(level, n)] = n;
    const auto expected = [&](const Cell& c) { return node_at.count(c) > 0 ? node_at[c] : -1; };
    for (std::int32_t n = 0; n < level.nodes(); n += 3)
      for (int i = 0; i < 125; ++i) {
        const Cell offset{i / 25 - 2, i / 5 % 5 - 2, i % 5 - 2};
        ASSERT_EQ(level.neighbour(n, offset[0], offset[1], offset[2]), expected(sum(node_position(level, n), offset)));
      }
  }
}

TEST(Neighbourhood, HoldsTheValuesAroundABrick) {
  const BuiltOctree built = example();
  const octree::OctreeView tree = built.host.view();
  const octree::LevelView& level = tree.finest();
  std::map<Cell, float> value_at;
  std::vector<float> values;
  for (std::int32_t n = 0; n < level.nodes(); ++n) {
    values.push_back(static_cast<float>(n + 1));
    value_at[node_position(level, n)] = values.back();
  }
  for (std::int32_t b = 0; b < level.bricks; ++b) {
    const octree::Neighbourhood around = octree::load_neighbourhood(level, b, values.data());
    for (int i = 0; i < 64; ++i) {
      const Cell offset{i / 16 - 1, i / 4 % 4 - 1, i % 4 - 1};
      const auto hit = value_at.find(sum(node_position(level, std::int64_t{8} * b), offset));
      ASSERT_EQ(around.at(offset[0], offset[1], offset[2]), hit == value_at.end() ? 0 : hit->second) << "brick " << b;
    }
  }
}

TEST(OctreeView, KnowsTheLevelOfANode) {
  const BuiltOctree built = example();
  const octree::OctreeView tree = built.host.view();
  for (int d = 0; d <= tree.depth; ++d) {
    EXPECT_EQ(tree.level_of(tree.levels[d].first_node), d);
    EXPECT_EQ(tree.level_of(tree.levels[d].first_node + tree.levels[d].nodes() - 1), d);
  }
}

ArrayView<const std::uint64_t> keys_of(const BuiltOctree& built) { return {built.keys.data(), std::ssize(built.keys)}; }

/// Adds `amount` to one random entry of a random array of `level`. False if the array has none.
bool spoil(octree::HostLevel& level, int array, int amount, Random& random) {
  const auto change = [&](auto& entries) {
    if (entries.empty()) return false;
    auto& entry = entries[static_cast<std::size_t>(random.below(std::ssize(entries)))];
    entry = static_cast<std::decay_t<decltype(entry)>>(entry + static_cast<std::decay_t<decltype(entry)>>(amount));
    return true;
  };
  const std::function<bool()> changes[] = {
      [&] { return change(level.brick_key); },  [&] { return change(level.parent); },
      [&] { return change(level.neighbours); }, [&] { return change(level.child_brick); },
      [&] { return change(level.unknowns); },   [&] { return change(level.point_begin); }};
  return changes[array]();
}

TEST(FindViolations, NoticesAnyEntryThatIsWrong) {
  const BuiltOctree built = example();
  ASSERT_TRUE(octree::find_violations(built.host, keys_of(built)).empty());
  Random random(kSeed);
  for (std::size_t d = 0; d < built.host.levels.size(); ++d)
    for (int array = 0; array < 6; ++array)
      for (const int amount : {1, -1, 1'000'000}) {
        octree::HostOctree wrong = built.host;
        if (!spoil(wrong.levels[d], array, amount, random) || wrong == built.host) continue;
        EXPECT_FALSE(octree::find_violations(wrong, keys_of(built)).empty())
            << "level " << d << ", array " << array << ", amount " << amount << ", seed " << kSeed;
      }
}

TEST(FindViolations, NoticesArraysOfTheWrongShape) {
  const BuiltOctree built = example();
  const std::function<void(octree::HostOctree&)> faults[] = {
      [](auto& tree) { tree.levels.pop_back(); },        [](auto& tree) { tree.depth = 21; },
      [](auto& tree) { --tree.levels[5].cell_bricks; },  [](auto& tree) { --tree.levels[5].bricks; },
      [](auto& tree) { tree.levels[6].bricks = -1; },    [](auto& tree) { tree.levels[6].neighbours.clear(); },
      [](auto& tree) { tree.levels[7].parent.clear(); }, [](auto& tree) { tree.levels[7].point_begin.pop_back(); }};
  for (const auto& fault : faults) {
    octree::HostOctree wrong = built.host;
    fault(wrong);
    EXPECT_FALSE(octree::find_violations(wrong, keys_of(built)).empty()) << "fault " << &fault - faults;
  }
}

TEST(FindViolations, NoticesPointsThatTheOctreeWasNotBuiltOf) {
  const BuiltOctree built = example();
  BuiltOctree other;
  other.keys = built.keys;
  other.keys.back() = 0;
  EXPECT_FALSE(octree::find_violations(built.host, keys_of(other)).empty());
  other.keys.pop_back();
  EXPECT_FALSE(octree::find_violations(built.host, keys_of(other)).empty());
}

}  // namespace
}  // namespace pointskin::test
