// What fluid/particle_tree.hpp promises, against all pairs of particles, on any space.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <vector>

#include "fluid/particle_tree.hpp"
#include "support/shapes.hpp"
#include "support/spaces.hpp"

namespace pointskin::test {

inline constexpr std::uint64_t kTreeSeed = 20250307;
inline constexpr int kMostFound = 1024;

/// Neighbours of one particle, in the order in which they are visited.
struct CollectNeighbours {
  fluid::ParticleTreeView tree;
  ArrayView<const Vec3f> positions;
  float radius;
  ArrayView<std::int32_t> found;  // (n, kMostFound), ended by -1
  PSK_HD void operator()(std::int64_t i) const {
    std::int64_t at = i * kMostFound;
    const Vec3f p = positions[i];
    fluid::for_each_neighbour(tree, tree.cell[i], [&](std::int32_t j) {
      const Vec3f q = positions[j];
      const float d = (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z);
      if (d <= radius * radius) found[at++] = j;
    });
    found[at] = -1;
  }
};

/// The same around places that are no particles.
struct CollectNear {
  fluid::ParticleTreeView tree;
  ArrayView<const Vec3f> positions, places;
  float radius;
  ArrayView<std::int32_t> found;
  PSK_HD void operator()(std::int64_t i) const {
    std::int64_t at = i * kMostFound;
    const Vec3f p = places[i];
    fluid::for_each_range_near(tree, p, p, radius, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t j = first; j < last; ++j) {
        const Vec3f q = positions[j];
        const float d = (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z);
        if (d <= radius * radius) found[at++] = j;
      }
    });
    found[at] = -1;
  }
};

/// All j within the radius of a place, ascending, by looking at every particle.
inline std::vector<std::int32_t> within(const std::vector<Vec3f>& positions, const Vec3f& p, float radius) {
  std::vector<std::int32_t> result;
  for (std::size_t j = 0; j < positions.size(); ++j) {
    const Vec3f q = positions[j];
    const float d = (p.x - q.x) * (p.x - q.x) + (p.y - q.y) * (p.y - q.y) + (p.z - q.z) * (p.z - q.z);
    if (d <= radius * radius) result.push_back(static_cast<std::int32_t>(j));
  }
  return result;
}

inline std::vector<std::int32_t> sorted_found(const std::vector<std::int32_t>& found, std::size_t i) {
  const auto first = found.begin() + static_cast<std::ptrdiff_t>(i * kMostFound);
  std::vector<std::int32_t> result(first, std::find(first, first + kMostFound, -1));
  std::sort(result.begin(), result.end());
  return result;
}

struct ParticleSet {
  const char* name;
  std::vector<Vec3f> positions;
  float radius;
};

inline std::vector<Vec3f> random_positions(std::int64_t n, Vec3d lower, Vec3d upper, Random& random) {
  std::vector<Vec3f> positions;
  for (std::int64_t i = 0; i < n; ++i)
    positions.push_back({static_cast<float>(random.in(lower[0], upper[0])),
                         static_cast<float>(random.in(lower[1], upper[1])),
                         static_cast<float>(random.in(lower[2], upper[2]))});
  return positions;
}

inline std::vector<ParticleSet> particle_sets() {
  Random random(kTreeSeed);
  std::vector<ParticleSet> sets;
  sets.push_back({"one", {{3, -2, 7}}, 0.5F});
  sets.push_back({"two at one place", {{1, 1, 1}, {1, 1, 1}}, 0.1F});
  sets.push_back({"a block", random_positions(3000, {-1, 0, 5}, {1, 1, 6}, random), 0.15F});
  // Two far clusters: the cube is too wide for a table of its bricks.
  std::vector<Vec3f> far = random_positions(500, {0, 0, 0}, {1, 1, 1}, random);
  for (const Vec3f& p : random_positions(500, {900, 900, 900}, {901, 901, 901}, random)) far.push_back(p);
  sets.push_back({"two far clusters", far, 0.2F});
  std::vector<Vec3f> lattice;  // distances of exactly the radius, on the cells' borders
  for (int x = 0; x < 12; ++x)
    for (int y = 0; y < 12; ++y)
      for (int z = 0; z < 12; ++z)
        lattice.push_back(
            {0.25F * static_cast<float>(x), 0.25F * static_cast<float>(y), 0.25F * static_cast<float>(z)});
  sets.push_back({"a lattice", lattice, 0.25F});
  return sets;
}

template <exec::Space S>
class ParticleTreeOn : public OnSpace<S> {
 public:
  struct Built {
    fluid::ParticleTree tree;
    std::vector<Vec3f> sorted;
  };
  Built build(const ParticleSet& set) {
    S& ex = this->space();
    Built built{fluid::build_particle_tree(ex, upload(ex, set.positions).cview(),
                                           fluid::grid_around(bounds_of(set.positions), set.radius)),
                {}};
    for (const std::int32_t i : to_host(ex, built.tree.order))
      built.sorted.push_back(set.positions[static_cast<std::size_t>(i)]);
    return built;
  }
};
TYPED_TEST_SUITE_P(ParticleTreeOn);

TYPED_TEST_P(ParticleTreeOn, FindsEveryNeighbourOnce) {
  auto& ex = this->space();
  for (const ParticleSet& set : particle_sets()) {
    SCOPED_TRACE(set.name);
    const auto built = this->build(set);
    const auto n = static_cast<std::int64_t>(set.positions.size());
    auto found = exec::make_buffer<std::int32_t>(ex, n * kMostFound);
    exec::fill(ex, found.view(), std::int32_t{-1});  // what is not written is copied as well
    const auto positions = upload(ex, built.sorted);
    for_each(ex, "test", n, CollectNeighbours{built.tree.view(), positions.cview(), set.radius, found.view()});
    const std::vector<std::int32_t> host = to_host(ex, found);
    for (std::size_t i = 0; i < built.sorted.size(); ++i)
      ASSERT_EQ(sorted_found(host, i), within(built.sorted, built.sorted[i], set.radius)) << i;
  }
}

TYPED_TEST_P(ParticleTreeOn, FindsWhatIsNearAnyPlace) {
  auto& ex = this->space();
  Random random(kTreeSeed);
  for (const ParticleSet& set : particle_sets()) {
    SCOPED_TRACE(set.name);
    const auto built = this->build(set);
    const Bounds box = bounds_of(set.positions);
    const double margin = 2 * double{set.radius};
    std::vector<Vec3f> places =
        random_positions(300, {box.lower.x - margin, box.lower.y - margin, box.lower.z - margin},
                         {box.upper.x + margin, box.upper.y + margin, box.upper.z + margin}, random);
    for (std::size_t i = 0; i < std::min<std::size_t>(100, set.positions.size()); ++i)
      places.push_back({set.positions[i].x + 0.9F * set.radius, set.positions[i].y, set.positions[i].z});
    const auto n = static_cast<std::int64_t>(places.size());
    auto found = exec::make_buffer<std::int32_t>(ex, n * kMostFound);
    exec::fill(ex, found.view(), std::int32_t{-1});  // what is not written is copied as well
    const auto positions = upload(ex, built.sorted);
    const auto at = upload(ex, places);
    for_each(ex, "test", n, CollectNear{built.tree.view(), positions.cview(), at.cview(), set.radius, found.view()});
    const std::vector<std::int32_t> host = to_host(ex, found);
    for (std::size_t i = 0; i < places.size(); ++i)
      ASSERT_EQ(sorted_found(host, i), within(built.sorted, places[i], set.radius)) << i;
  }
}

TYPED_TEST_P(ParticleTreeOn, KeepsTheCallersOrderWithinACell) {
  for (const ParticleSet& set : particle_sets()) {
    SCOPED_TRACE(set.name);
    const auto built = this->build(set);
    const std::vector<std::uint64_t> keys = to_host(this->space(), built.tree.keys);
    std::vector<std::int32_t> order = to_host(this->space(), built.tree.order);
    for (std::size_t i = 1; i < keys.size(); ++i) {
      ASSERT_LE(keys[i - 1], keys[i]);
      if (keys[i - 1] == keys[i]) {
        ASSERT_LT(order[i - 1], order[i]);
      }
    }
    std::sort(order.begin(), order.end());
    for (std::size_t i = 0; i < order.size(); ++i) ASSERT_EQ(order[i], static_cast<std::int32_t>(i));
  }
}

TYPED_TEST_P(ParticleTreeOn, KnowsTheCellOfEveryParticle) {
  for (const ParticleSet& set : particle_sets()) {
    SCOPED_TRACE(set.name);
    const auto built = this->build(set);
    const auto& tree = built.tree;
    const std::vector<std::uint64_t> keys = to_host(this->space(), tree.keys);
    const std::vector<std::uint64_t> brick_key = to_host(this->space(), tree.brick_key);
    const std::vector<std::int32_t> cell = to_host(this->space(), tree.cell);
    const std::vector<std::int32_t> begin = to_host(this->space(), tree.point_begin);
    for (std::size_t i = 0; i < keys.size(); ++i) {
      const auto c = static_cast<std::size_t>(cell[i]);
      ASSERT_EQ(brick_key[c / 8] << 3 | (c & 7), keys[i]);
      ASSERT_LE(begin[c], static_cast<std::int32_t>(i));
      ASSERT_GT(begin[c + 1], static_cast<std::int32_t>(i));
    }
    ASSERT_EQ(begin.back(), static_cast<std::int32_t>(keys.size()));
    for (std::size_t c = 1; c < begin.size(); ++c) ASSERT_LE(begin[c - 1], begin[c]);
  }
}

TYPED_TEST_P(ParticleTreeOn, IsEmptyWithoutParticles) {
  const auto tree = fluid::build_particle_tree(this->space(), ArrayView<const Vec3f>{}, fluid::CellGrid{{}, 3});
  EXPECT_EQ(tree.view().level.bricks, 0);
  EXPECT_EQ(to_host(this->space(), tree.point_begin), std::vector<std::int32_t>{0});
}

REGISTER_TYPED_TEST_SUITE_P(ParticleTreeOn, FindsEveryNeighbourOnce, FindsWhatIsNearAnyPlace,
                            KeepsTheCallersOrderWithinACell, KnowsTheCellOfEveryParticle, IsEmptyWithoutParticles);

}  // namespace pointskin::test
