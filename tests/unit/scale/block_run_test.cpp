// Clouds reconstructed in blocks, against the whole.
#include <gtest/gtest.h>

#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include "exec/cpu.hpp"
#include "io/cloud_parts.hpp"
#include "octree/frame.hpp"
#include "scale/block_run.hpp"
#include "scale/cloud_extent.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

/// A cloud in a file, sorted, and its surface in memory.
class BlockRun : public testing::Test {
 protected:
  void start(const Cloud& cloud, const Options& options) {
    const std::string path = folder_.file("cloud.ply");
    write_cloud(path, cloud);
    parts_ = io::CloudParts::open(path);
    ASSERT_NE(parts_, nullptr);
    parts_->choose_origin(ex_, std::nullopt);
    scale::CloudExtent extent = scale::find_extent(ex_, *parts_, false);
    std::sort(extent.strays.indices.begin(), extent.strays.indices.end());
    frame_ = octree::frame_around(extent.strays.core, options.scale);
    place_ = std::filesystem::path(path).parent_path().string();
    sorted_ = std::make_unique<scale::SortedCloud>(
        ex_, *parts_, scale::SortedCloud::Setup{place_, 1 << 20, frame_, extent.strays.indices});
    whole_ = Reconstructor(Device::cpu(2)).reconstruct(read_cloud(path), options);
    options_ = options;
    ASSERT_GT(whole_.triangles.size(), 0U);
  }

  [[nodiscard]] scale::BlockOptions block_options(int coarse_level, int blocks) const {
    scale::BlockOptions options;
    options.folder = place_;
    options.depth = options_.depth;
    options.coarse_level = coarse_level;
    options.blocks = blocks;
    options.part_samples = 7001;
    options.screening = options_.screening;
    options.iterations = options_.iterations;
    return options;
  }

  void expect_as_whole(int coarse_level, int blocks) {
    SCOPED_TRACE("K " + std::to_string(coarse_level) + ", " + std::to_string(blocks) + " blocks");
    scale::BlockReport report;
    const scale::BlockMeshes meshes =
        scale::reconstruct_blocks(ex_, *sorted_, block_options(coarse_level, blocks), report);
    EXPECT_EQ(report.blocks, blocks);
    ASSERT_EQ(meshes.vertices(), std::ssize(whole_.vertices));
    ASSERT_EQ(meshes.triangles(), std::ssize(whole_.triangles));
    std::vector<Vec3f> positions(whole_.vertices.size()), normals(whole_.vertices.size());
    std::vector<Triangle> triangles(whole_.triangles.size());
    meshes.read_column(0, 0, meshes.vertices(), reinterpret_cast<std::byte*>(positions.data()));
    meshes.read_column(1, 0, meshes.vertices(), reinterpret_cast<std::byte*>(normals.data()));
    meshes.read_triangles(0, meshes.triangles(), reinterpret_cast<scale::BlockMeshes::Indices*>(triangles.data()));
    for (Vec3f& position : positions) position = frame_.to_world(position);
    EXPECT_EQ(differing(positions, whole_.vertices), 0);
    EXPECT_EQ(differing(normals, whole_.normals), 0);
    EXPECT_EQ(differing(triangles, whole_.triangles), 0);
  }

  template <class T>
  static std::int64_t differing(const std::vector<T>& a, const std::vector<T>& b) {
    std::int64_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], sizeof(T)) != 0 ? 1 : 0;
    return count;
  }

 private:
  exec::Cpu ex_{2};
  TemporaryFolder folder_;
  std::string place_;
  std::unique_ptr<io::CloudParts> parts_;
  std::unique_ptr<scale::SortedCloud> sorted_;
  octree::Frame frame_;
  Mesh whole_;
  Options options_;
};

Options at_depth(int depth) {
  Options options;
  options.depth = depth;
  return options;
}

TEST_F(BlockRun, GivesTheBytesOfTheWholeForAnyBlocks) {
  start(sphere_cloud(30000, 1), at_depth(8));
  for (const int blocks : {1, 2, 3, 7}) expect_as_whole(5, blocks);
  expect_as_whole(6, 3);
}

}  // namespace
}  // namespace pointskin::test
