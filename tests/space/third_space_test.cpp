// The steps of a reconstruction compiled for a third space, which is plain loops: the same bytes as in the others.
#include <gtest/gtest.h>

#include <pointskin/reconstruct.hpp>

#include <cstddef>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "reconstruct/mesh_of_field.hpp"
#include "reconstruct/points.hpp"
#include "space/serial.hpp"

namespace pointskin {
namespace {

/// As Reconstructor::reconstruct, with the normals as they are.
Mesh reconstructed_serially(const Cloud& cloud, const Options& options) {
  exec::Serial ex;
  RunReport report;
  detail::PointBuffers points = detail::upload(ex, cloud);
  if (options.attributes) points.attributes = detail::upload_attributes(ex, cloud);
  detail::FieldData field = detail::fit_field(ex, points, {.look = true}, options, report);
  Mesh mesh;
  detail::extract_and_release(ex, field, options, cloud.origin, mesh, report);
  return mesh;
}

void expect_same_bytes_as_on_the_cpu(const Cloud& cloud, const Options& options) {
  test::expect_same_bytes(reconstructed_serially(cloud, options), test::reconstructed(cloud, options));
}

TEST(ThirdSpace, GivesTheBytesOfTheCpu) {
  for (const int depth : {3, 6, 8}) {
    SCOPED_TRACE("depth " + std::to_string(depth));
    expect_same_bytes_as_on_the_cpu(test::torus_cloud(20'000, 1), {{.depth = depth}});
    expect_same_bytes_as_on_the_cpu(test::linked_tori_cloud(4'000, 2), {{.depth = depth}, {.density = true}});
  }
}

TEST(ThirdSpace, GivesTheBytesOfTheCpuWithOptions) {
  const Cloud cloud = test::sphere_cloud(8'000, 3);
  const std::vector<Options> all = {{{.depth = 6}, {.trim = 0.1}},
                                    {{.depth = 6, .boundary = Boundary::dirichlet}, {.weakness = true}},
                                    {{.depth = 6, .field = FieldKind::distance, .offset = 0.1}},
                                    {{.depth = 6, .confidence = true}, {.largest = true}}};
  for (std::size_t i = 0; i < all.size(); ++i) {
    SCOPED_TRACE("options " + std::to_string(i));
    expect_same_bytes_as_on_the_cpu(cloud, all[i]);
  }
}

}  // namespace
}  // namespace pointskin
