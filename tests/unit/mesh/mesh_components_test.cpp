#include <gtest/gtest.h>

#include <pointskin/components.hpp>
#include <pointskin/error.hpp>

#include <algorithm>
#include <map>
#include <numeric>
#include <utility>

#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::box_mesh;
using test::icosphere_mesh;
using test::moebius_mesh;
using test::Random;
using test::torus_mesh;

/// Three closed pieces apart from each other: volumes 1, 8 and about 4.19.
Mesh three_pieces() {
  Mesh mesh = box_mesh();
  test::append(mesh, box_mesh({2, 0, 0}, {4, 2, 2}));
  Mesh ball = icosphere_mesh(3, 1, {0, 0, 5});
  ball.normals.clear();
  test::append(mesh, ball);
  return mesh;
}

/// Triangles of vertices drawn at random: few enough vertices that some are shared, some triangles are degenerate.
Mesh random_soup(std::uint64_t seed, std::int64_t vertices, std::int64_t triangles) {
  Random random(seed);
  Mesh mesh;
  for (std::int64_t v = 0; v < vertices; ++v) {
    const auto draw = [&random] { return static_cast<float>(random.in(-1, 1)); };
    mesh.vertices.push_back({draw(), draw(), draw()});
  }
  const auto draw = [&] { return static_cast<std::int32_t>(random.below(vertices)); };
  for (std::int64_t t = 0; t < triangles; ++t) mesh.triangles.push_back({draw(), draw(), draw()});
  return mesh;
}

/// The same by spreading the smallest label until nothing changes.
std::vector<std::int32_t> labels_by_spreading(const Mesh& mesh) {
  std::vector<std::int32_t> least(mesh.vertices.size());
  std::iota(least.begin(), least.end(), 0);
  std::vector<bool> used(mesh.vertices.size());
  for (bool changed = true; changed;) {
    changed = false;
    for (const Triangle& t : mesh.triangles) {
      std::int32_t label = least[static_cast<std::size_t>(t[0])];
      for (const std::int32_t v : t) label = std::min(label, least[static_cast<std::size_t>(v)]);
      for (const std::int32_t v : t) {
        used[static_cast<std::size_t>(v)] = true;
        changed = changed || least[static_cast<std::size_t>(v)] != label;
        least[static_cast<std::size_t>(v)] = label;
      }
    }
  }
  std::map<std::int32_t, std::int32_t> numbers;
  std::vector<std::int32_t> labels(least.size(), -1);
  for (std::size_t v = 0; v < least.size(); ++v) {
    if (!used[v]) continue;
    labels[v] = numbers.try_emplace(least[v], static_cast<std::int32_t>(numbers.size())).first->second;
  }
  return labels;
}

TEST(LabelComponents, NumbersPiecesByTheirSmallestVertex) {
  const MeshComponents pieces = label_components(three_pieces());
  ASSERT_EQ(pieces.count, 3);
  EXPECT_EQ(pieces.of_vertex.front(), 0);
  EXPECT_EQ(pieces.of_vertex[8], 1);
  EXPECT_EQ(pieces.of_vertex.back(), 2);
  EXPECT_EQ(pieces.triangles, (std::vector<std::int64_t>{12, 12, 20 * 64}));
}

TEST(LabelComponents, MeasuresEveryPiece) {
  const Mesh mesh = three_pieces();
  const MeshComponents pieces = label_components(mesh);
  EXPECT_NEAR(pieces.areas[0], 6, 1e-12);
  EXPECT_NEAR(pieces.areas[1], 24, 1e-12);
  EXPECT_NEAR(pieces.volumes[0], 1, 1e-12);
  EXPECT_NEAR(pieces.volumes[1], 8, 1e-12);
  const MeshReport whole = measure(mesh);
  EXPECT_NEAR(std::accumulate(pieces.areas.begin(), pieces.areas.end(), 0.0), whole.area, 1e-9);
  EXPECT_NEAR(std::accumulate(pieces.volumes.begin(), pieces.volumes.end(), 0.0), whole.volume, 1e-9);
}

TEST(LabelComponents, AgreesWithSpreadingLabelsOnRandomSoups) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    const auto size = static_cast<std::int64_t>(seed);
    const Mesh mesh = random_soup(seed, 20 * size, 7 * size);
    const MeshComponents pieces = label_components(mesh, 3);
    EXPECT_EQ(pieces.of_vertex, labels_by_spreading(mesh)) << "seed " << seed;
    EXPECT_EQ(pieces.count, measure(mesh).components) << "seed " << seed;
    EXPECT_EQ(glance_at(mesh).components, pieces.count) << "seed " << seed;
    EXPECT_EQ(std::accumulate(pieces.triangles.begin(), pieces.triangles.end(), std::int64_t{0}), 7 * size);
  }
}

TEST(LabelComponents, IsTheSameToTheBitForAnyNumberOfThreads) {
  Mesh mesh = random_soup(7, 60'000, 40'000);
  test::append(mesh, three_pieces());
  const MeshComponents one = label_components(mesh, 1);
  for (const int threads : {2, 5, 16}) {
    const MeshComponents many = label_components(mesh, threads);
    EXPECT_EQ(many.of_vertex, one.of_vertex);
    EXPECT_EQ(many.triangles, one.triangles);
    EXPECT_EQ(many.areas, one.areas);
    EXPECT_EQ(many.volumes, one.volumes);
  }
}

TEST(LabelComponents, LeavesVerticesWithoutTrianglesOut) {
  Mesh mesh = box_mesh();
  mesh.vertices.insert(mesh.vertices.begin(), {9, 9, 9});
  for (Triangle& t : mesh.triangles)
    for (std::int32_t& v : t) ++v;
  const MeshComponents pieces = label_components(mesh);
  EXPECT_EQ(pieces.count, 1);
  EXPECT_EQ(pieces.of_vertex.front(), -1);
  EXPECT_EQ(pieces.of_vertex.back(), 0);
  EXPECT_EQ(label_components(Mesh{}).count, 0);
}

TEST(LabelComponents, RefusesATriangleOfVerticesThatDoNotExist) {
  Mesh mesh = box_mesh();
  mesh.triangles[3][1] = 8;
  EXPECT_THROW(label_components(mesh), Error);
  EXPECT_THROW(glance_at(mesh), Error);
}

TEST(GlanceAt, SeesThatClosedMeshesAreClosed) {
  for (const Mesh& mesh : {three_pieces(), torus_mesh(40, 20), test::flipped(box_mesh())}) {
    const MeshGlance glance = glance_at(mesh);
    EXPECT_TRUE(glance.closed);
    EXPECT_TRUE(glance.oriented);
    EXPECT_EQ(glance.components, measure(mesh).components);
  }
}

TEST(GlanceAt, SeesAnySingleTriangleThatIsMissing) {
  const Mesh whole = torus_mesh(12, 9);
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    Mesh mesh = whole;
    mesh.triangles.erase(mesh.triangles.begin() + static_cast<std::ptrdiff_t>(t));
    EXPECT_FALSE(glance_at(mesh).closed) << t;
    EXPECT_FALSE(glance_at(mesh).oriented) << t;
  }
}

TEST(GlanceAt, SeesAnySingleTriangleThatIsTurnedOver) {
  const Mesh whole = torus_mesh(12, 9);
  for (std::size_t t = 0; t < whole.triangles.size(); ++t) {
    Mesh mesh = whole;
    std::swap(mesh.triangles[t][0], mesh.triangles[t][1]);
    EXPECT_TRUE(glance_at(mesh).closed) << t;
    EXPECT_FALSE(glance_at(mesh).oriented) << t;
  }
}

/// Whether every edge has an even number of triangles, edge by edge.
bool has_even_edges(const Mesh& mesh) {
  std::map<std::pair<std::int32_t, std::int32_t>, int> counts;
  for (const Triangle& t : mesh.triangles) {
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) ++counts[std::minmax({t[k], t[(k + 1) % 3]})];
  }
  return std::all_of(counts.begin(), counts.end(), [](const auto& edge) { return edge.second % 2 == 0; });
}

TEST(GlanceAt, AgreesWithCountingTheEdgesOfRandomSoups) {
  int closed = 0;
  for (std::uint64_t seed = 1; seed <= 3000; ++seed) {
    const Mesh mesh = random_soup(seed, 4, 4);
    EXPECT_EQ(glance_at(mesh, 1).closed, has_even_edges(mesh)) << "seed " << seed;
    closed += glance_at(mesh, 1).closed ? 1 : 0;
  }
  EXPECT_GT(closed, 30) << "the soups say nothing if none is closed";
  EXPECT_LT(closed, 2970);
}

TEST(GlanceAt, SeesThatMeshesWithABorderAreOpen) {
  EXPECT_FALSE(glance_at(test::patch_mesh(5)).closed);
  EXPECT_FALSE(glance_at(moebius_mesh(12)).closed);
  EXPECT_FALSE(glance_at(Mesh{}).closed);
}

TEST(GlanceAt, IgnoresTheEdgesOfDegenerateTriangles) {
  Mesh mesh = box_mesh();
  mesh.triangles.push_back({0, 0, 1});
  EXPECT_TRUE(glance_at(mesh).closed);
  EXPECT_TRUE(glance_at(mesh).oriented);
}

}  // namespace
}  // namespace pointskin
