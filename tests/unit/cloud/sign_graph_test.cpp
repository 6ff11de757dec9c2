// Patches of consistent signs against the true normals.
#include <gtest/gtest.h>

#include <cstdint>
#include <set>
#include <vector>

#include "cloud/estimate_normals.hpp"
#include "cloud/neighbours.hpp"
#include "cloud/sign_graph.hpp"
#include "exec/cpu_primitives.hpp"
#include "normals/prepared_cloud.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

/// True normals with signs turned at random, and the graph over them.
struct Graph {
  explicit Graph(const Cloud& cloud, std::uint64_t seed) : ex(2), points(detail::prepare_cloud(ex, cloud)) {
    test::Random random(seed);
    const octree::SearchView search{points.tree.view(), points.positions.cview(), {}};
    ids = cloud::find_neighbours(ex, search);
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
  detail::PreparedCloud points;
  exec::Buffer<std::int32_t> ids;
  exec::Buffer<float> flatness, noise;
  std::vector<std::int32_t> turned;
  cloud::LinkedLines lines;
};

/// Expects that signs times turned is the same within every patch.
void expect_consistent(const Graph& graph, const cloud::SignPatches& patches) {
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
  cloud::SignPatches patches = cloud::start_patches(graph.ex, graph.lines);
  EXPECT_GT(patches.count, 100);
  expect_consistent(graph, patches);
  cloud::merge_patches(graph.ex, {0, 0}, patches);
  EXPECT_EQ(patches.count, 1);
  EXPECT_TRUE(patches.pairs.empty());
  EXPECT_EQ(patches.sizes.data()[0], 8'000U);
  expect_consistent(graph, patches);
}

TEST(SignGraph, CrossesSharpEdges) {
  Graph graph(test::box_cloud(8'000, 3), 4);
  cloud::SignPatches patches = cloud::start_patches(graph.ex, graph.lines);
  cloud::merge_patches(graph.ex, {0, 0}, patches);
  EXPECT_EQ(patches.count, 1);
  expect_consistent(graph, patches);
}

TEST(SignGraph, KeepsSeparateSurfacesApart) {
  Graph graph(test::linked_tori_cloud(10'000, 5), 6);
  cloud::SignPatches patches = cloud::start_patches(graph.ex, graph.lines);
  cloud::merge_patches(graph.ex, {0, 0}, patches);
  EXPECT_EQ(patches.count, 2);
  expect_consistent(graph, patches);
}

TEST(SignGraph, DoesNotJoinTheSheetsOfAPlate) {
  Graph graph(test::thin_plate_cloud(20'000, 7, 0.06), 8);
  cloud::SignPatches patches = cloud::start_patches(graph.ex, graph.lines);
  cloud::merge_patches(graph.ex, {0.6, 32}, patches);
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
  cloud::measure_agreement(graph.ex, graph.lines, signs.cview(), share.view());
  for (std::int64_t i = 0; i < n; ++i) ASSERT_EQ(share.data()[i], 1);
  signs.data()[7] = -signs.data()[7];
  cloud::measure_agreement(graph.ex, graph.lines, signs.cview(), share.view());
  EXPECT_EQ(share.data()[7], 0);
}

}  // namespace
}  // namespace pointskin
