// Signed distance against a search through all triangles and the winding number.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "exec/cpu.hpp"
#include "mesh/signed_distance.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using namespace mesh_detail;
using test::Random;

double searched_distance(const Mesh& mesh, const Vec3d& p) {
  double best = std::numeric_limits<double>::infinity();
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
    best = std::min(best, squared_distance(p, edged_triangle(mesh, Vec3d{0, 0, 0}, static_cast<std::int64_t>(t))));
  return std::sqrt(best);
}

/// Solid angle of the mesh seen from p, over 4 pi (van Oosterom & Strackee 1983): 1 inside, 0 outside.
double winding_number(const Mesh& mesh, const Vec3d& p) {
  double sum = 0;
  for (const Triangle& t : mesh.triangles) {
    const auto corner = [&](std::size_t k) { return to_double(mesh.vertices[static_cast<std::size_t>(t[k])]) - p; };
    const Vec3d a = corner(0), b = corner(1), c = corner(2);
    const double la = length(a), lb = length(b), lc = length(c);
    sum += 2 * std::atan2(dot(a, cross(b, c)), la * lb * lc + dot(a, b) * lc + dot(b, c) * la + dot(c, a) * lb);
  }
  return sum / (4 * std::numbers::pi);
}

struct NamedMesh {
  std::string name;
  Mesh mesh;
};
std::vector<NamedMesh> closed_meshes() {
  Mesh hollow = test::box_mesh({-1, -1, -1}, {1, 1, 1});
  test::append(hollow, test::flipped(test::box_mesh({-0.5, -0.5, -0.5}, {0.25, 0.5, 0.75})));
  Mesh spike = test::tetrahedron_mesh();
  spike.vertices[3] = {0.01F, 0.02F, 40};  // needles
  return {{"box", test::box_mesh()},
          {"sphere", test::icosphere_mesh(3)},
          {"torus", test::torus_mesh(24, 12)},
          {"hollow box", hollow},
          {"spike", spike},
          {"tetrahedron", test::tetrahedron_mesh()}};
}

/// Points everywhere, and close to vertices, edges and faces.
std::vector<Vec3d> points_around(const Mesh& mesh, std::uint64_t seed) {
  Random random(seed);
  std::vector<Vec3d> points;
  const auto corner = [&](std::size_t t, std::size_t k) {
    return to_double(mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][k % 3])]);
  };
  for (int i = 0; i < 400; ++i) points.push_back({random.in(-2, 2), random.in(-2, 2), random.in(-2, 2)});
  for (int i = 0; i < 400; ++i) {
    const auto t = static_cast<std::size_t>(random.below(static_cast<std::int64_t>(mesh.triangles.size())));
    const auto k = static_cast<std::size_t>(random.below(3));
    const double s = random.unit();
    const Vec3d on_edge = (1 - s) * corner(t, k) + s * corner(t, k + 1);
    const Vec3d on_face = 0.7 * on_edge + 0.3 * corner(t, k + 2);
    for (const double distance : {1e-1, 1e-3, 1e-6}) {
      points.push_back(corner(t, k) + distance * random.direction());
      points.push_back(on_edge + distance * random.direction());
      points.push_back(on_face + distance * random.direction());
    }
  }
  return points;
}

TEST(SignedDistance, EqualsTheSearchThroughAllTrianglesWithTheSignOfTheWindingNumber) {
  exec::Cpu ex(2);
  for (const auto& [name, mesh] : closed_meshes()) {
    SCOPED_TRACE(name);
    const SignedDistance signed_distance(ex, mesh, {0, 0, 0});
    int inside = 0, outside = 0;
    std::int32_t hint = -1;
    for (const Vec3d& p : points_around(mesh, 1)) {
      const SurfacePlace place = signed_distance.at(p, hint);
      hint = place.slot;
      const double expected = searched_distance(mesh, p);
      ASSERT_NEAR(std::abs(place.distance), expected, 1e-12);
      ASSERT_NEAR(length(p - place.position), expected, 1e-12);
      ASSERT_NEAR(searched_distance(mesh, place.position), 0, 1e-12);
      if (expected < 1e-9) continue;
      const bool is_inside = winding_number(mesh, p) > 0.5;
      ASSERT_EQ(place.distance > 0, is_inside) << p[0] << " " << p[1] << " " << p[2] << ", distance " << expected;
      ++(is_inside ? inside : outside);
    }
    EXPECT_GT(inside, 100);
    EXPECT_GT(outside, 100);
  }
}

TEST(SignedDistance, OfABoxIsThatOfItsFormula) {
  exec::Cpu ex(1);
  const Mesh mesh = test::box_mesh({-1, -1, -1}, {1, 1, 1});
  const SignedDistance signed_distance(ex, mesh, {0, 0, 0});
  Random random(2);
  for (int i = 0; i < 5000; ++i) {
    const Vec3d p{random.in(-2, 2), random.in(-2, 2), random.in(-2, 2)};
    const Vec3d q{std::abs(p[0]) - 1, std::abs(p[1]) - 1, std::abs(p[2]) - 1};
    const Vec3d beyond{std::max(q[0], 0.0), std::max(q[1], 0.0), std::max(q[2], 0.0)};
    const double expected = length(beyond) > 0 ? -length(beyond) : -std::max({q[0], q[1], q[2]});
    ASSERT_NEAR(signed_distance.at(p).distance, expected, 1e-14);
  }
}

TEST(SignedDistance, IsMeasuredWithTheOffsetInDouble) {
  exec::Cpu ex(1);
  const Mesh mesh = test::icosphere_mesh(2);
  const Vec3d offset{4.1e6, -5e5, 321.125};
  const SignedDistance here(ex, mesh, {0, 0, 0}), there(ex, mesh, offset);
  for (const Vec3d& p : points_around(mesh, 3))
    ASSERT_NEAR(there.at(p + offset).distance, here.at(p).distance, 3e-9);  // as far as doubles of 4e6 can
}

TEST(SignedDistance, OnTheSurfaceIsZero) {
  exec::Cpu ex(1);
  const Mesh mesh = test::torus_mesh(20, 10);
  const SignedDistance signed_distance(ex, mesh, {0, 0, 0});
  for (const Vec3f& v : mesh.vertices) EXPECT_EQ(signed_distance.at(to_double(v)).distance, 0);
}

}  // namespace
}  // namespace pointskin
