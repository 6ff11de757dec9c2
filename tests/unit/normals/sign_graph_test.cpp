// Patches of consistent signs against the true normals.
#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <vector>

#include "exec/algorithms.hpp"
#include "exec/cpu_primitives.hpp"
#include "normals/estimate_normals.hpp"
#include "normals/likely_signs.hpp"
#include "normals/neighbours.hpp"
#include "normals/prepared_cloud.hpp"
#include "normals/sign_graph.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

/// True normals with signs turned at random, and the graph over them.
struct Graph {
  explicit Graph(const Cloud& cloud, std::uint64_t seed) : ex(2), points(normals::prepare_cloud(ex, cloud)) {
    test::Random random(seed);
    const octree::SearchView search{points.tree.view(), points.positions.cview(), {}};
    ids = normals::find_neighbours(ex, search);
    const std::int64_t n = points.positions.size();
    turned.resize(static_cast<std::size_t>(n));
    flatness = exec::make_buffer<float>(ex, n);
    noise = exec::make_buffer<float>(ex, n);
    exec::fill(ex, flatness.view(), 1.0F);
    exec::fill(ex, noise.view(), 0.0F);
    for (std::int64_t i = 0; i < n; ++i) {
      const bool turn = random.unit() < 0.5;
      turned[static_cast<std::size_t>(i)] = turn ? -1 : 1;
      Vec3f& normal = points.given.data()[i];
      if (turn) normal = {-normal.x, -normal.y, -normal.z};
    }
    lines = {points.positions.cview(), points.given.cview(), flatness.cview(), noise.cview(), ids.cview()};
  }

  exec::Cpu ex;
  normals::PreparedCloud points;
  exec::Buffer<std::int32_t> ids;
  exec::Buffer<float> flatness, noise;
  std::vector<std::int32_t> turned;
  normals::LinkedLines lines;
};

/// Expects that signs times turned is the same within every patch.
void expect_consistent(const Graph& graph, const normals::SignPatches& patches) {
  std::vector<int> of_patch(static_cast<std::size_t>(patches.count), 0);
  for (std::size_t i = 0; i < graph.turned.size(); ++i) {
    const int sign = patches.signs.data()[i] * graph.turned[i];
    int& expected = of_patch[static_cast<std::size_t>(patches.labels.data()[i])];
    if (expected == 0) expected = sign;
    ASSERT_EQ(sign, expected) << "point " << i;
  }
}

TEST(SignGraph, MakesOneConsistentPatchOfATorus) {
  Graph graph(test::torus_cloud(8'000, 1), 2);
  normals::SignPatches patches = normals::start_patches(graph.ex, graph.lines);
  EXPECT_GT(patches.count, 100);
  expect_consistent(graph, patches);
  normals::merge_patches(graph.ex, {0, 0}, patches);
  EXPECT_EQ(patches.count, 1);
  EXPECT_TRUE(patches.pairs.empty());
  EXPECT_EQ(patches.sizes.data()[0], 8'000U);
  expect_consistent(graph, patches);
}

TEST(SignGraph, CrossesSharpEdges) {
  Graph graph(test::box_cloud(8'000, 3), 4);
  normals::SignPatches patches = normals::start_patches(graph.ex, graph.lines);
  normals::merge_patches(graph.ex, {0, 0}, patches);
  EXPECT_EQ(patches.count, 1);
  expect_consistent(graph, patches);
}

TEST(SignGraph, KeepsSeparateSurfacesApart) {
  Graph graph(test::linked_tori_cloud(10'000, 5), 6);
  normals::SignPatches patches = normals::start_patches(graph.ex, graph.lines);
  normals::merge_patches(graph.ex, {0, 0}, patches);
  EXPECT_EQ(patches.count, 2);
  expect_consistent(graph, patches);
}

TEST(SignGraph, DoesNotJoinTheSheetsOfAPlate) {
  Graph graph(test::thin_plate_cloud(20'000, 7, 0.06), 8);
  normals::SignPatches patches = normals::start_patches(graph.ex, graph.lines);
  normals::merge_patches(graph.ex, {0.6, 32}, patches);
  std::int64_t wrong = 0;
  std::vector<std::int64_t> net(static_cast<std::size_t>(patches.count), 0);
  for (std::size_t i = 0; i < graph.turned.size(); ++i)
    net[static_cast<std::size_t>(patches.labels.data()[i])] += patches.signs.data()[i] * graph.turned[i];
  for (std::size_t i = 0; i < graph.turned.size(); ++i)
    wrong += patches.signs.data()[i] * graph.turned[i] * net[static_cast<std::size_t>(patches.labels.data()[i])] < 0;
  EXPECT_LT(wrong, 20);
}

TEST(SignGraph, AgreementIsTheShareOfVotes) {
  Graph graph(test::sphere_cloud(2'000, 9), 10);
  const auto n = static_cast<std::int64_t>(graph.turned.size());
  auto signs = exec::make_buffer<std::int32_t>(graph.ex, n);
  copy_to_device(graph.ex, graph.turned.data(), signs.view());
  auto share = exec::make_buffer<float>(graph.ex, n);
  normals::measure_agreement(graph.ex, graph.lines, signs.cview(), share.view());
  for (std::int64_t i = 0; i < n; ++i) ASSERT_EQ(share.data()[i], 1);
  signs.data()[7] = -signs.data()[7];
  normals::measure_agreement(graph.ex, graph.lines, signs.cview(), share.view());
  EXPECT_EQ(share.data()[7], 0);
}

/// The true signs of a graph's lines, a share of them wrong.
exec::Buffer<std::int32_t> evidence_of(Graph& graph, double wrong, std::uint64_t seed) {
  test::Random random(seed);
  auto evidence = exec::make_buffer<std::int32_t>(graph.ex, graph.points.positions.size());
  for (std::size_t i = 0; i < graph.turned.size(); ++i)
    evidence.data()[i] = graph.turned[i] * (random.unit() < wrong ? -1 : 1);
  return evidence;
}

TEST(LikelySigns, CorrectWhatNeighboursContradict) {
  Graph graph(test::torus_cloud(8'000, 21), 22);
  for (const double wrong : {0.0, 0.1, 0.3, 0.9}) {
    SCOPED_TRACE(wrong);
    const exec::Buffer<std::int32_t> evidence = evidence_of(graph, wrong, 23);
    const normals::LikelySigns likely = normals::spread_evidence(graph.ex, graph.lines, evidence.cview());
    ASSERT_EQ(likely.signs.size(), evidence.size());
    EXPECT_GT(likely.typical, 0.8);
    std::int64_t right = 0;
    for (std::size_t i = 0; i < graph.turned.size(); ++i)
      right += likely.signs.data()[i] == graph.turned[i] * (wrong > 0.5 ? -1 : 1) ? 1 : 0;
    EXPECT_GE(right, wrong == 0.3 ? 7'900 : 7'990);
  }
}

TEST(LikelySigns, AreNoneWhereTheInputIsChance) {
  Graph graph(test::torus_cloud(8'000, 24), 25);
  const exec::Buffer<std::int32_t> chance = evidence_of(graph, 0.5, 26);
  EXPECT_TRUE(normals::spread_evidence(graph.ex, graph.lines, chance.cview()).signs.empty());
  auto nothing = exec::make_buffer<std::int32_t>(graph.ex, chance.size());
  exec::fill(graph.ex, nothing.view(), 0);
  EXPECT_TRUE(normals::spread_evidence(graph.ex, graph.lines, nothing.cview()).signs.empty());
}

TEST(SignGraph, TurnsWhatHasLikelySignsOverLongBordersAlone) {
  // Signs that are right but for a hemisphere, and for single points.
  Graph graph(test::sphere_cloud(8'000, 27), 28);
  for (std::size_t i = 0; i < graph.turned.size(); ++i) {
    Vec3f& n = graph.points.given.data()[i];
    const int wanted = graph.points.positions.data()[i].x > 0.5F ? -1 : 1;
    if (graph.turned[i] != wanted) n = {-n.x, -n.y, -n.z};
    graph.turned[i] = wanted;
  }
  normals::SignPatches patches = normals::start_patches(graph.ex, graph.lines, true);
  for (std::size_t i = 0; i < graph.turned.size(); ++i) ASSERT_EQ(patches.signs.data()[i], 1);
  normals::merge_patches(graph.ex, {0.9, 0, 0.9}, patches);
  EXPECT_EQ(patches.count, 1);
  expect_consistent(graph, patches);
}

}  // namespace
}  // namespace pointskin
