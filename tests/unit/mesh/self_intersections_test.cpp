// Self-intersections of whole meshes: against all pairs, and of shapes where they are known.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <set>
#include <string>
#include <vector>

#include "mesh/triangle_contact.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using mesh_detail::Contact;
using mesh_detail::MeshTriangle;
using test::Random;

MeshTriangle triangle_of(const Mesh& mesh, std::size_t id) {
  const Triangle& t = mesh.triangles[id];
  const auto corner = [&](std::size_t k) { return mesh.vertices[static_cast<std::size_t>(t[k])]; };
  return {{corner(0), corner(1), corner(2)}, t};
}

/// By looking at every pair.
SelfIntersections searched(const Mesh& mesh) {
  SelfIntersections found;
  std::set<std::size_t> involved;
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t j = i + 1; j < mesh.triangles.size(); ++j) {
      const Contact contact = contact_of(triangle_of(mesh, i), triangle_of(mesh, j));
      if (contact == Contact::none) continue;
      ++found.pairs;
      if (contact == Contact::touching) ++found.touching;
      involved.insert({i, j});
      found.listed.push_back(
          {{static_cast<std::int32_t>(i), static_cast<std::int32_t>(j)}, contact == Contact::touching, {}});
    }
  found.triangles = static_cast<std::int64_t>(involved.size());
  return found;
}

void expect_same(const SelfIntersections& found, const SelfIntersections& expected) {
  EXPECT_EQ(found.pairs, expected.pairs);
  EXPECT_EQ(found.touching, expected.touching);
  EXPECT_EQ(found.triangles, expected.triangles);
  ASSERT_LE(found.listed.size(), expected.listed.size());
  for (std::size_t i = 0; i < found.listed.size(); ++i) {
    EXPECT_EQ(found.listed[i].triangles, expected.listed[i].triangles) << i;
    EXPECT_EQ(found.listed[i].touching, expected.listed[i].touching) << i;
  }
}

/// Triangles between vertices at random, on a grid that makes all coincidences common, or anywhere.
Mesh random_mesh(Random& random, int vertices, int triangles, bool on_grid) {
  Mesh mesh;
  const auto coordinate = [&] {
    return on_grid ? static_cast<float>(random.below(12)) : static_cast<float>(random.in(0, 12));
  };
  for (int v = 0; v < vertices; ++v) mesh.vertices.push_back({coordinate(), coordinate(), coordinate()});
  for (int t = 0; t < triangles; ++t) {
    const auto corner = [&] { return static_cast<std::int32_t>(random.below(vertices)); };
    mesh.triangles.push_back({corner(), corner(), corner()});
  }
  return mesh;
}

TEST(SelfIntersections, AreThoseOfAllPairs) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    Random random(seed);
    const Mesh mesh = random_mesh(random, 60, 1 + static_cast<int>(random.below(120)), seed % 2 == 0);
    SCOPED_TRACE("seed " + std::to_string(seed));
    expect_same(find_self_intersections(mesh, {.listed = 1'000'000}), searched(mesh));
  }
}

TEST(SelfIntersections, OfSoundMeshesAreNone) {
  for (const Mesh& mesh : {test::box_mesh(), test::tetrahedron_mesh(), test::icosphere_mesh(4),
                           test::torus_mesh(40, 20), test::patch_mesh(30), test::moebius_mesh(12)}) {
    const SelfIntersections found = find_self_intersections(mesh);
    EXPECT_EQ(found.pairs, 0);
    EXPECT_EQ(found.triangles, 0);
    EXPECT_TRUE(found.listed.empty());
  }
  EXPECT_EQ(find_self_intersections(Mesh{}).pairs, 0);
}

TEST(SelfIntersections, OfTwoBoxesThroughEachOtherAreCrossings) {
  Mesh mesh = test::box_mesh();
  test::append(mesh, test::box_mesh({0.25, 0.375, 0.5}, {2, 2, 2}));
  const SelfIntersections found = find_self_intersections(mesh, {.listed = 1000});
  expect_same(found, searched(mesh));
  EXPECT_GT(found.pairs, 6);
  EXPECT_EQ(found.touching, 0);
  for (const IntersectingPair& pair : found.listed) {
    EXPECT_LT(pair.triangles[0], 12);
    EXPECT_GE(pair.triangles[1], 12);
  }
}

TEST(SelfIntersections, OfBoxesThatTouchAreTouches) {
  Mesh corners = test::box_mesh();
  test::append(corners, test::box_mesh({1, 1, 1}, {2, 2, 2}));
  const SelfIntersections at_corner = find_self_intersections(corners);
  EXPECT_GT(at_corner.pairs, 0);
  EXPECT_EQ(at_corner.touching, at_corner.pairs);
  ASSERT_FALSE(at_corner.listed.empty());
  EXPECT_EQ(at_corner.listed[0].place_world, (Vec3d{1, 1, 1}));

  Mesh sides = test::box_mesh();
  test::append(sides, test::box_mesh({1, 0, 0}, {2, 1, 1}));  // overlapping faces
  EXPECT_GT(find_self_intersections(sides).pairs, find_self_intersections(sides).touching);
}

TEST(SelfIntersections, AreTheSamePairsFarFromTheOrigin) {
  Mesh mesh = test::box_mesh();
  test::append(mesh, test::box_mesh({0.25, 0.375, 0.5}, {2, 2, 2}));
  const SelfIntersections near = find_self_intersections(mesh);
  mesh.origin = {5e6, -4e5, 300};
  const SelfIntersections far = find_self_intersections(mesh);
  expect_same(far, near);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_DOUBLE_EQ(far.listed[0].place_world[axis], near.listed[0].place_world[axis] + mesh.origin[axis]);
}

TEST(SelfIntersections, CountVerticesAtOnePlaceAsDifferent) {
  Mesh mesh = test::patch_mesh(1);  // two triangles that share an edge
  ASSERT_EQ(find_self_intersections(mesh).pairs, 0);
  for (std::int32_t& id : mesh.triangles[1]) {
    mesh.vertices.push_back(mesh.vertices[static_cast<std::size_t>(id)]);
    id = static_cast<std::int32_t>(mesh.vertices.size()) - 1;
  }
  EXPECT_EQ(find_self_intersections(mesh).touching, 1);
}

TEST(SelfIntersections, ListTheFirstPairsByIds) {
  Random random(3);
  const Mesh mesh = random_mesh(random, 40, 400, false);
  const SelfIntersections all = find_self_intersections(mesh, {.listed = 1'000'000});
  ASSERT_EQ(static_cast<std::int64_t>(all.listed.size()), all.pairs);
  ASSERT_GT(all.pairs, 1000);
  for (const std::int64_t listed : {0, 1, 10, 500}) {
    const SelfIntersections some = find_self_intersections(mesh, {.listed = listed});
    ASSERT_EQ(static_cast<std::int64_t>(some.listed.size()), listed);
    expect_same(some, all);
  }
}

TEST(SelfIntersections, AreTheSameForAnyNumberOfThreads) {
  Random random(4);
  const Mesh mesh = random_mesh(random, 800, 1500, false);
  const SelfIntersections one = find_self_intersections(mesh, {.threads = 1});
  ASSERT_GT(one.pairs, 10'000);
  for (const int threads : {2, 5}) {
    const SelfIntersections many = find_self_intersections(mesh, {.threads = threads});
    expect_same(many, one);
    for (std::size_t i = 0; i < one.listed.size(); ++i)
      EXPECT_EQ(many.listed[i].place_world, one.listed[i].place_world) << i;
  }
}

TEST(SelfIntersections, AreRefusedForWhatIsNoMesh) {
  const auto code_of = [](const Mesh& mesh, const SelfIntersectionOptions& options) {
    try {
      find_self_intersections(mesh, options);
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode{0};
  };
  Mesh bad = test::box_mesh();
  EXPECT_EQ(code_of(bad, {.listed = -1}), ErrorCode::usage);
  EXPECT_EQ(code_of(bad, {.threads = -1}), ErrorCode::usage);
  bad.triangles[5][1] = 8;
  EXPECT_EQ(code_of(bad, {}), ErrorCode::invalid_input);
  bad = test::box_mesh();
  bad.vertices[2].z = std::numeric_limits<float>::infinity();
  EXPECT_EQ(code_of(bad, {}), ErrorCode::invalid_input);
}

}  // namespace
}  // namespace pointskin
