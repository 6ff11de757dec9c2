// Signed distance as the field: closed surfaces through the samples, on every shape; borders; options.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <memory>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::reconstructed;

Options distance_options(int depth) {
  Options options{.depth = depth};
  options.field = FieldKind::distance;
  return options;
}

/// Side of a finest cell.
double cell_of(const Cloud& cloud, const Options& options) {
  return Reconstructor(Device::cpu(2)).solve(cloud, options).cube_size_world() / std::pow(2.0, options.depth);
}

struct Expected {
  std::string name;
  Cloud cloud;
  std::int64_t components, euler;
};

std::vector<Expected> shapes() {
  return {{"sphere", test::sphere_cloud(20'000, 1), 1, 2},
          {"few points", test::sphere_cloud(500, 2), 1, 2},
          {"torus", test::torus_cloud(20'000, 3), 1, 0},
          {"linked tori", test::linked_tori_cloud(30'000, 4), 2, 0},
          {"box", test::box_cloud(20'000, 5), 1, 2},
          {"thin plate", test::thin_plate_cloud(30'000, 6, 0.1), 1, 2},
          {"two spheres", test::two_spheres_cloud(20'000, 7, 0.3), 2, 4}};
}

TEST(DistanceField, GivesOneClosedSurfaceForEveryShape) {
  for (const Expected& e : shapes())
    for (const int depth : {5, 6, 7, 8}) {
      SCOPED_TRACE(e.name + ", depth " + std::to_string(depth));
      const MeshReport measured = measure(reconstructed(e.cloud, distance_options(depth)));
      EXPECT_TRUE(measured.closed());
      EXPECT_TRUE(measured.manifold());
      EXPECT_EQ(measured.components, e.components);
      EXPECT_EQ(measured.euler, e.euler);
    }
}

}  // namespace
}  // namespace pointskin
