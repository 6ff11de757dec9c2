// The condition on the faces of the cube: what it changes and what it leaves alone.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::expect_same_bytes;
using test::reconstructed;

Options free_faces() { return {{.depth = 6}}; }
Options dirichlet() { return {{.depth = 6, .boundary = Boundary::dirichlet}}; }

/// Share of the cube's side between the mesh and the nearest face of the cube.
double margin_of(const Cloud& cloud, const Options& options) {
  Reconstructor r(Device::cpu(2));
  const Field field = r.solve(cloud, options, {});
  const Mesh mesh = field.extract({.domain_faces = DomainFaces::open});  // what reaches a face ends there
  double margin = 1;
  for (const Vec3f& v : mesh.vertices) {
    const double p[3] = {v.x, v.y, v.z};
    for (std::size_t a = 0; a < 3; ++a) {
      const double unit = (p[a] + mesh.origin[a] - field.cube_lower_world()[a]) / field.cube_size_world();
      margin = std::min({margin, unit, 1 - unit});
    }
  }
  return margin;
}

Cloud half_sphere(std::int64_t n, std::uint64_t seed) {
  const Cloud sphere = test::sphere_cloud(n, seed);
  Cloud half;
  for (std::size_t i = 0; i < sphere.positions.size(); ++i)
    if (sphere.positions[i].z > 0) {
      half.positions.push_back(sphere.positions[i]);
      half.normals.push_back(sphere.normals[i]);
    }
  return half;
}

TEST(Boundary, IsFreeUnlessAskedOtherwiseAndNeumannIsTheSame) {
  const Cloud cloud = test::torus_cloud(10'000, 1);
  const Mesh plain = reconstructed(cloud, {{.depth = 6}});
  expect_same_bytes(reconstructed(cloud, {{.depth = 6, .boundary = Boundary::free}}), plain);
  expect_same_bytes(reconstructed(cloud, {{.depth = 6, .boundary = Boundary::neumann}}), plain);
}

TEST(Boundary, DirichletClosesOpenScansInsideOfTheCubeWhereFreeOnesRunIntoItsFaces) {
  for (const auto& [name, cloud] : std::vector<std::pair<std::string, Cloud>>{
           {"plane", test::plane_cloud(20'000, 2)}, {"half sphere", half_sphere(40'000, 3)}}) {
    SCOPED_TRACE(name);
    EXPECT_LT(margin_of(cloud, free_faces()), 1e-6);
    EXPECT_GT(margin_of(cloud, dirichlet()), 0.01);
    Options open = dirichlet();
    open.domain_faces = DomainFaces::open;
    const Mesh mesh = reconstructed(cloud, open);
    EXPECT_TRUE(measure(mesh).watertight());
    expect_same_bytes(reconstructed(cloud, dirichlet()), mesh);  // nothing is left for the faces to cap
  }
}

TEST(Boundary, DirichletLeavesClosedShapesAsTheyAre) {
  for (const auto& [name, cloud] :
       std::vector<std::pair<std::string, Cloud>>{{"sphere", test::sphere_cloud(20'000, 4)},
                                                  {"torus", test::torus_cloud(20'000, 5)},
                                                  {"linked tori", test::linked_tori_cloud(30'000, 6)}}) {
    SCOPED_TRACE(name);
    const Mesh free = reconstructed(cloud, free_faces());
    const Mesh held = reconstructed(cloud, dirichlet());
    const MeshReport a = measure(free), b = measure(held);
    EXPECT_TRUE(b.watertight());
    EXPECT_EQ(a.euler, b.euler);
    EXPECT_EQ(a.components, b.components);
    EXPECT_NEAR(b.volume / a.volume, 1, 2e-3);
    EXPECT_LT(compare(held, free).two_sided.max, 0.5 * 2.2 / 64);  // half a finest cell
  }
}

TEST(Boundary, DirichletGivesTheSameBytesForAnyThreadsAndOrder) {
  const Cloud cloud = half_sphere(20'000, 7);
  const Mesh mesh = reconstructed(cloud, dirichlet(), 1);
  expect_same_bytes(reconstructed(cloud, dirichlet(), 3), mesh);
  expect_same_bytes(reconstructed(test::shuffled(cloud, 8), dirichlet(), 2), mesh);
}

TEST(Boundary, DirichletHoldsAtEveryDepthAndWithoutScreening) {
  const Cloud cloud = test::sphere_cloud(3000, 9);
  for (const int depth : {2, 3, 4, 5, 8})
    for (const double screening : {0.0, 2.0}) {
      SCOPED_TRACE(std::to_string(depth) + ", screening " + std::to_string(screening));
      const Mesh mesh =
          reconstructed(cloud, {{.depth = depth, .screening = screening, .boundary = Boundary::dirichlet}});
      EXPECT_TRUE(measure(mesh).watertight());
      EXPECT_EQ(measure(mesh).components, 1);
    }
}

TEST(Boundary, DirichletCountsFewerUnknowns) {
  const Cloud cloud = test::sphere_cloud(3000, 10);
  Options options = dirichlet();
  options.residuals = true;
  Reconstructor r(Device::cpu(2));
  (void)r.reconstruct(cloud, options);
  const std::vector<LevelReport>& levels = r.report().levels;
  for (int d = 0; d <= 5; ++d) {  // complete
    const std::int64_t inner = (1 << d) - 1;
    EXPECT_EQ(levels[static_cast<std::size_t>(d)].unknowns, inner * inner * inner);
    EXPECT_LE(levels[static_cast<std::size_t>(d)].residual_after, levels[static_cast<std::size_t>(d)].residual_before);
  }
}

}  // namespace
}  // namespace pointskin
