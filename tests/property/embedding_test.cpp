// Meshes that do not pass through themselves: what docs/algorithm.md, section 7, says of self-intersections, for whole
// reconstructions. What holds for single cells is in tests/unit/surface/surface_embedding_test.cpp.
#include <gtest/gtest.h>

#include <pointskin/boolean.hpp>
#include <pointskin/deform.hpp>
#include <pointskin/fluid.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <string>
#include <utility>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/deformations.hpp"
#include "support/option_sets.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

/// No two triangles meet beside what they share, not even in a point.
void expect_embedded(const Mesh& mesh) {
  ASSERT_GT(mesh.triangles.size(), 100U);
  const SelfIntersections found = find_self_intersections(mesh);
  EXPECT_EQ(found.pairs, 0);
  for (const IntersectingPair& pair : found.listed)
    ADD_FAILURE() << pair.triangles[0] << " and " << pair.triangles[1] << (pair.touching ? " touch" : " cross");
}

std::vector<std::pair<std::string, Cloud>> clouds() {
  return {{"sphere", test::sphere_cloud(5'000, 1)},
          {"noisy torus", test::jittered(test::torus_cloud(20'000, 2), 3, 0.02)},
          {"linked tori", test::linked_tori_cloud(10'000, 4)},
          {"box", test::box_cloud(8'000, 5)},
          {"thin plate", test::thin_plate_cloud(8'000, 6, 0.05)},
          {"open square", test::plane_cloud(3'000, 7)}};
}

TEST(Embedding, HoldsForAllOptions) {
  for (const auto& [name, cloud] : clouds())
    for (const auto& [set, options] : test::option_sets(6, true)) {
      SCOPED_TRACE(name + ", " + set);
      if (options.envelope != nullptr) continue;  // what is moved promises nothing (docs/algorithm.md, section 7)
      if (options.offset < 0 && (name == "thin plate" || name == "open square")) continue;  // nothing is left
      expect_embedded(test::reconstructed(cloud, options));
    }
}

TEST(Embedding, HoldsAcrossManyLevels) {
  for (const int depth : {3, 8, 10})
    for (const double samples_per_node : {0.0, 1.5})
      expect_embedded(test::reconstructed(test::linked_tori_cloud(6'000, 8),
                                          {{.depth = depth, .samples_per_node = samples_per_node}}));
}

TEST(Embedding, HoldsInSurveyCoordinates) {
  Cloud cloud = test::torus_cloud(10'000, 9);
  cloud.origin = {1e6, 4e6, 250};
  expect_embedded(test::reconstructed(cloud, {{.depth = 7}}));
  // Without an origin of their own: floats near 100 still tell a thousandth of a cell apart.
  expect_embedded(test::reconstructed(test::translated(test::torus_cloud(10'000, 9), {100, -100, 50}), {{.depth = 7}}));
}

TEST(Embedding, FarFromTheOriginOfTheFloatsVerticesTouchAndNothingCrosses) {
  const Mesh mesh =
      test::reconstructed(test::translated(test::torus_cloud(10'000, 9), {1000, -1000, 500}), {{.depth = 7}});
  const SelfIntersections found = find_self_intersections(mesh);
  EXPECT_GT(found.pairs, 0);
  EXPECT_EQ(found.touching, found.pairs);
}

TEST(Embedding, HoldsForBooleansDeformationsAndFluids) {
  BooleanOptions options;
  options.reconstruction.depth = 6;
  const Cloud first = test::sphere_cloud(8'000, 10), second = test::sphere_cloud(8'000, 11, 1, {0.8, 0.6, 0});
  for (const BooleanOp op : {BooleanOp::unite, BooleanOp::intersect, BooleanOp::subtract})
    expect_embedded(Booleans(Device::cpu(2)).combine(first, second, op, options).mesh);

  Deformer deformer(test::torus_cloud(10'000, 12), {{.depth = 6}}, Device::cpu(2));
  deformer.deform(test::bend_along_x(1));
  expect_embedded(deformer.reconstruct());

  const Cloud particles = test::jittered(test::sphere_cloud(3'000, 13, 0.5), 14, 0.02);
  FluidOptions fluid;
  fluid.particle_radius = 0.03;
  expect_embedded(FluidSurfacer(Device::cpu(2)).surface(particles, fluid));
}

class EmbeddedScan : public testing::TestWithParam<const char*> {};

TEST_P(EmbeddedScan, HasNoSelfIntersections) {
  const auto cloud = test::shared_cloud(GetParam());
  if (!cloud) GTEST_SKIP() << "no " << GetParam() << ".ply in " << POINTSKIN_SOURCE_DIR << "/../shared/data";
  Reconstructor r(Device::cpu(2));
  for (const int depth : {6, 8}) {
    SCOPED_TRACE(depth);
    expect_embedded(r.reconstruct(*cloud, {{.depth = depth}}));
    expect_embedded(r.reconstruct(*cloud, {{.depth = depth}, {.trim = 0.05}}));
  }
}

INSTANTIATE_TEST_SUITE_P(Scans, EmbeddedScan,
                         testing::Values("bunny_scans", "armadillo_oriented", "srb_anchor", "srb_dc", "cgal_kitten"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace pointskin
