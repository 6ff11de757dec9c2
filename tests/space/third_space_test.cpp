// The steps of a reconstruction compiled for a third space, which is plain loops: the same bytes as in the others.
#include <gtest/gtest.h>

#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cstddef>
#include <iterator>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "io/cloud_parts.hpp"
#include "octree/frame.hpp"
#include "property/reconstruction.hpp"
#include "reconstruct/mesh_of_field.hpp"
#include "reconstruct/points.hpp"
#include "scale/block_run.hpp"
#include "scale/block_work.hpp"
#include "scale/cloud_extent.hpp"
#include "scale/write_blocks.hpp"
#include "space/serial.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

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

/// A file of a cloud, reconstructed in blocks.
class BlocksInAThirdSpace : public testing::Test {
 protected:
  void start(const Cloud& cloud) {
    const std::string path = folder_.file("cloud.ply");
    write_cloud(path, cloud);
    parts_ = io::CloudParts::open(host_, path);
    ASSERT_NE(parts_, nullptr);
    parts_->choose_origin(host_, std::nullopt);
    frame_ = octree::frame_around(scale::find_extent(host_, *parts_, true).strays.core, 1.1);
    sorted_ = std::make_unique<scale::SortedCloud>(host_, *parts_,
                                                   scale::SortedCloud::Setup{folder_.file(""), 1 << 20, frame_});
  }

  [[nodiscard]] scale::BlockOptions block_options(int depth, int coarse_level, int blocks) const {
    scale::BlockOptions options;
    options.folder = folder_.file("");
    options.depth = depth;
    options.coarse_level = coarse_level;
    options.blocks = blocks;
    options.iterations = 4;
    return options;
  }

  void expect_same_file_as_on_the_cpu(const scale::BlockOptions& options) {
    scale::BlockReport here, there;
    const std::string expected = file_of(scale::reconstruct_blocks(host_, *sorted_, options, here));
    exec::Serial ex;
    const scale::MakeBlockWork make = [&](scale::SharedOfBlocks& shared) { return make_block_work(ex, shared); };
    EXPECT_TRUE(file_of(scale::reconstruct_blocks(make, host_, *sorted_, options, there)) == expected);
    EXPECT_EQ(there.blocks, options.blocks);
    EXPECT_EQ(there.isovalue, here.isovalue);
    EXPECT_EQ(there.lone_corners, here.lone_corners);
    EXPECT_TRUE(std::equal(std::begin(there.looks.sums), std::end(there.looks.sums), here.looks.sums));
    EXPECT_TRUE(std::equal(std::begin(there.looks.densities), std::end(there.looks.densities), here.looks.densities));
  }

  std::string file_of(const scale::BlockMeshes& meshes) {
    const std::string path = folder_.file("mesh.ply");
    scale::write_ply(host_, meshes, {true, meshes.columns() > 2}, frame_, parts_->origin(), path);
    return test::bytes_of_file(path);
  }

  exec::Cpu host_{2};
  test::TemporaryFolder folder_;
  std::unique_ptr<io::CloudParts> parts_;
  octree::Frame frame_;
  std::unique_ptr<scale::SortedCloud> sorted_;
};

TEST_F(BlocksInAThirdSpace, GiveTheFileOfTheCpu) {
  start(test::torus_cloud(6'000, 1));
  expect_same_file_as_on_the_cpu(block_options(7, 5, 3));
  scale::BlockOptions options = block_options(7, 5, 2);
  options.density_face = 1e-4;
  options.boundary = Boundary::dirichlet;
  expect_same_file_as_on_the_cpu(options);
}

/// Sparse samples, outliers and pieces.
TEST_F(BlocksInAThirdSpace, GiveTheFileOfTheCpuForRoughClouds) {
  Cloud cloud = test::jittered(test::sphere_cloud(6'000, 2), 3, 0.004);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)  // far fewer on one side
    if (cloud.positions[i].x > 0 && i % 100 != 0) cloud.positions[i] = cloud.positions[0];
  test::append(cloud, test::jittered(test::box_cloud(100, 4), 5, 0.3));
  start(cloud);
  expect_same_file_as_on_the_cpu(block_options(8, 6, 3));
}

}  // namespace
}  // namespace pointskin
