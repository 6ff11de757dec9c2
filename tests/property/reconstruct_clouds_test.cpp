// Public scans of ../shared/data, where that folder is present. Depth 10 is left to the command line's tests.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <string>

#include "property/reconstruction.hpp"

namespace pointskin {
namespace {

class SharedCloud : public testing::TestWithParam<const char*> {};

TEST_P(SharedCloud, IsWatertightAtDepthsSixToNine) {
  const auto cloud = test::shared_cloud(GetParam());
  if (!cloud) GTEST_SKIP() << "no " << GetParam() << ".ply in " << POINTSKIN_SOURCE_DIR << "/../shared/data";
  Reconstructor r(Device::cpu(2));
  for (int depth = 6; depth <= 9; ++depth) {
    const MeshReport report = measure(r.reconstruct(*cloud, {{.depth = depth}}));
    SCOPED_TRACE("depth " + std::to_string(depth) + ", " + std::to_string(report.triangles) + " triangles");
    EXPECT_TRUE(report.closed());
    EXPECT_TRUE(report.manifold());
    EXPECT_TRUE(report.oriented());
    EXPECT_GT(report.volume, 0);
    EXPECT_EQ(r.report().points, cloud->size());
    // Finest cells that the surface crosses: between 4^depth / 100 and 4^depth times the faces of the cube.
    EXPECT_GT(report.triangles, (std::int64_t{1} << 2 * depth) / 100);
    EXPECT_LT(report.triangles, std::int64_t{12} << 2 * depth);
  }
}

INSTANTIATE_TEST_SUITE_P(Scans, SharedCloud,
                         testing::Values("bunny_scans", "armadillo_oriented", "srb_anchor", "srb_dc"),
                         [](const auto& info) { return std::string(info.param); });

}  // namespace
}  // namespace pointskin
