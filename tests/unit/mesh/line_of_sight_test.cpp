// Triangles in the way of a line, by the tree and one by one.
#include <gtest/gtest.h>

#include <cmath>

#include "exec/cpu.hpp"
#include "mesh/triangle_tree.hpp"
#include "support/shapes.hpp"

namespace pointskin::mesh_detail {
namespace {

/// Signed volume of a tetrahedron, times 6.
double volume(const Vec3d& a, const Vec3d& b, const Vec3d& c, const Vec3d& d) {
  return dot(b - a, cross(c - a, d - a));
}

/// A line passes a triangle if its ends are on both sides of it and it runs past its three sides the same way round.
bool crosses(const Vec3d& from, const Vec3d& to, const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  if ((volume(from, a, b, c) > 0) == (volume(to, a, b, c) > 0)) return false;
  const bool first = volume(from, to, a, b) > 0;
  return (volume(from, to, b, c) > 0) == first && (volume(from, to, c, a) > 0) == first;
}

TEST(TriangleTree, FindsWhetherSomethingIsInTheWay) {
  exec::Cpu ex(2);
  const Mesh mesh = test::torus_mesh(40, 20);
  const TriangleTree tree(ex, mesh, {0, 0, 0});
  constexpr std::uint64_t kSeed = 11;
  SCOPED_TRACE(kSeed);
  test::Random random(kSeed);
  int blocked = 0;
  for (int i = 0; i < 2000; ++i) {
    Vec3d from = random.in(0, 2) * random.direction(), to = random.in(0, 2) * random.direction();
    if (i % 10 == 0) to = {from[0], from[1], to[2]};  // along an axis
    bool expected = false;
    for (const Triangle& t : mesh.triangles) {
      const auto corner = [&](std::size_t k) { return to_double(mesh.vertices[static_cast<std::size_t>(t[k])]); };
      expected = expected || crosses(from, to, corner(0), corner(1), corner(2));
    }
    blocked += expected ? 1 : 0;
    ASSERT_EQ(tree.is_between(from, to), expected) << i;
  }
  EXPECT_GT(blocked, 400);
  EXPECT_LT(blocked, 1600);
}

TEST(TriangleTree, LooksNoFartherThanTheLine) {
  exec::Cpu ex(1);
  const TriangleTree tree(ex, test::patch_mesh(3), {0, 0, 0});
  EXPECT_TRUE(tree.is_between({0.4, 0.3, 1}, {0.4, 0.3, -1}));
  EXPECT_FALSE(tree.is_between({0.4, 0.3, 1}, {0.4, 0.3, 0.1}));
  EXPECT_FALSE(tree.is_between({0.4, 0.3, -0.1}, {0.4, 0.3, -1}));
  EXPECT_FALSE(tree.is_between({1.4, 0.3, 1}, {1.4, 0.3, -1}));
}

}  // namespace
}  // namespace pointskin::mesh_detail
