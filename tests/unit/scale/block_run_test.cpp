// Clouds reconstructed in blocks, against the whole.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/workspace.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdlib>
#include <cstring>
#include <filesystem>
#include <iterator>
#include <memory>
#include <string>
#include <vector>

#include "diagnose/counts.hpp"
#include "exec/cpu.hpp"
#include "io/cloud_parts.hpp"
#include "octree/frame.hpp"
#include "reconstruct/engine.hpp"
#include "scale/block_run.hpp"
#include "scale/cloud_extent.hpp"
#include "scale/write_blocks.hpp"
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
    parts_ = io::CloudParts::open(ex_, path);
    ASSERT_NE(parts_, nullptr);
    parts_->choose_origin(ex_, std::nullopt);
    scale::CloudExtent extent = scale::find_extent(ex_, *parts_, options.keep_strays);
    std::sort(extent.strays.indices.begin(), extent.strays.indices.end());
    frame_ = octree::frame_around(extent.strays.core, options.scale);
    place_ = std::filesystem::path(path).parent_path().string();
    sorted_ = std::make_unique<scale::SortedCloud>(
        ex_, *parts_, scale::SortedCloud::Setup{place_, 1 << 20, frame_, extent.strays.indices});
    whole_ = Reconstructor(Device::cpu(2)).reconstruct(read_cloud(path), options);
    options_ = options;
    look_at_whole(read_cloud(path));
    ASSERT_GT(whole_.triangles.size(), 0U);
  }

  [[nodiscard]] scale::BlockOptions block_options(int coarse_level, int blocks) const {
    scale::BlockOptions options = scale::block_options_of(options_, frame_);
    options.folder = place_;
    options.coarse_level = coarse_level;
    options.blocks = blocks;
    options.part_samples = 7001;
    return options;
  }

  void expect_as_whole(int coarse_level, int blocks) {
    SCOPED_TRACE("K " + std::to_string(coarse_level) + ", " + std::to_string(blocks) + " blocks");
    EXPECT_EQ(differences(block_options(coarse_level, blocks)), 0);
  }

  /// Vertices, normals and triangles that are not those of the whole, or a count that is not.
  [[nodiscard]] std::int64_t differences(const scale::BlockOptions& options) {
    scale::BlockReport report;
    const scale::BlockMeshes meshes = scale::reconstruct_blocks(ex_, *sorted_, options, report);
    if (options.blocks > 0) {
      EXPECT_EQ(report.blocks, options.blocks);
    }
    blocks_ = report.blocks;
    specks_ = report.lone_corners;
    sums_again_ = std::any_of(report.sweeps.begin(), report.sweeps.end(), [](const scale::BlockReport::Sweep& sweep) {
      return std::string(sweep.name) == "sum again";
    });
    if (options.ring == 0) expect_looks(report.looks);
    const std::int64_t more = std::abs(meshes.vertices() - std::ssize(whole_.vertices)) +
                              std::abs(meshes.triangles() - std::ssize(whole_.triangles));
    if (more > 0) return more;
    std::vector<Vec3f> positions(whole_.vertices.size()), normals(whole_.vertices.size());
    std::vector<Triangle> triangles(whole_.triangles.size());
    meshes.read_column(0, 0, meshes.vertices(), reinterpret_cast<std::byte*>(positions.data()));
    meshes.read_column(1, 0, meshes.vertices(), reinterpret_cast<std::byte*>(normals.data()));
    meshes.read_triangles(0, meshes.triangles(), reinterpret_cast<scale::BlockMeshes::Indices*>(triangles.data()));
    for (Vec3f& position : positions) position = frame_.to_world(position);
    return differing(positions, whole_.vertices) + differing(normals, whole_.normals) +
           differing(triangles, whole_.triangles);
  }

  /// What the first fit of the whole counts, and its surface.
  void look_at_whole(const Cloud& cloud) {
    RunReport report;
    const std::shared_ptr<detail::FieldImpl> field =
        detail::Engine(Workspace(Device::cpu(2))).solve(cloud, options_, false, report);
    Mesh mesh;
    field->extract_and_release(mesh, report);
    looks_ = field->seen();
  }

  void expect_looks(const diagnose::Counts& found) const {
    for (int sum = 0; sum < diagnose::kSums; ++sum) EXPECT_EQ(found.sums[sum], looks_.sums[sum]) << "sum " << sum;
    EXPECT_TRUE(std::equal(std::begin(found.densities), std::end(found.densities), looks_.densities));
  }

  void expect_the_file_of_the_whole(const scale::BlockOptions& options) {
    scale::BlockReport report;
    const scale::BlockMeshes meshes = scale::reconstruct_blocks(ex_, *sorted_, options, report);
    scale::write_ply(ex_, meshes, {}, frame_, parts_->origin(), folder_.file("blocks.ply"));
    write_mesh(folder_.file("whole.ply"), whole_);
    EXPECT_TRUE(bytes_of_file(folder_.file("blocks.ply")) == bytes_of_file(folder_.file("whole.ply")));
  }

  template <class T>
  static std::int64_t differing(const std::vector<T>& a, const std::vector<T>& b) {
    std::int64_t count = 0;
    for (std::size_t i = 0; i < a.size(); ++i) count += std::memcmp(&a[i], &b[i], sizeof(T)) != 0 ? 1 : 0;
    return count;
  }

  exec::Cpu ex_{2};
  TemporaryFolder folder_;
  std::string place_;
  std::unique_ptr<io::CloudParts> parts_;
  std::unique_ptr<scale::SortedCloud> sorted_;
  octree::Frame frame_;
  Mesh whole_;
  diagnose::Counts looks_{};
  Options options_;
  int blocks_ = 0;  ///< of the last run
  std::int64_t specks_ = 0;
  bool sums_again_ = false;
};

Options at_depth(int depth, int iterations = 8, double screening = 2) {
  Options options;
  options.depth = depth;
  options.iterations = iterations;
  options.screening = screening;
  return options;
}

/// One of so many points is left where x is positive, so that some normals are splatted at the coarsest levels.
Cloud thinned(const Cloud& cloud, int of) {
  Cloud result;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    if (cloud.positions[i].x > 0 && i % static_cast<std::size_t>(of) != 0) continue;
    result.positions.push_back(cloud.positions[i]);
    result.normals.push_back(cloud.normals[i]);
  }
  return result;
}

TEST_F(BlockRun, GivesTheBytesOfTheWholeForAnyBlocks) {
  start(torus_cloud(20000, 1), at_depth(8));
  for (const int blocks : {1, 2, 7}) expect_as_whole(5, blocks);
  expect_as_whole(6, 3);
}

TEST_F(BlockRun, GivesItWhereSamplesAreSparse) {
  start(thinned(jittered(sphere_cloud(40000, 2), 3, 0.004), 250), at_depth(9, 4));
  expect_as_whole(7, 4);
  expect_as_whole(6, 3);
}

TEST_F(BlockRun, GivesItForSheetsAndEdgesAndOutliers) {
  Cloud cloud = thin_plate_cloud(20000, 4, 0.02);
  const Cloud outliers = jittered(box_cloud(200, 5), 6, 0.3);
  cloud.positions.insert(cloud.positions.end(), outliers.positions.begin(), outliers.positions.end());
  cloud.normals.insert(cloud.normals.end(), outliers.normals.begin(), outliers.normals.end());
  Options options = at_depth(8, 4);
  options.point_normals = PointNormals::given;  // what a run does besides fitting and extracting is left out
  options.keep_strays = true;
  options.min_component = 1;
  start(cloud, options);
  expect_as_whole(6, 4);
}

TEST_F(BlockRun, LeavesOutPiecesAsTheWholeDoes) {
  Cloud cloud = torus_cloud(20000, 4);
  const Cloud outliers = jittered(box_cloud(200, 5), 6, 0.3);
  append(cloud, outliers);
  append(cloud, translated(scaled(sphere_cloud(1000, 7), 0.2F), {0.9F, 0.9F, 0.9F}));
  Options options = at_depth(8, 4);
  options.point_normals = PointNormals::given;  // what a run does besides fitting and extracting is left out
  options.keep_strays = true;
  start(cloud, options);
  const std::size_t by_support = whole_.triangles.size();
  for (const int blocks : {1, 5}) expect_as_whole(6, blocks);
  options.largest = true;
  start(cloud, options);
  EXPECT_LT(whole_.triangles.size(), by_support);
  expect_as_whole(5, 3);
  options.largest = false;
  for (const double least : {1.0, 60.0, 0.02}) {
    options.min_component = least;
    start(cloud, options);
    if (least == 1.0) {
      EXPECT_GT(whole_.triangles.size(), by_support);
    }
    expect_as_whole(6, 4);
  }
}

TEST_F(BlockRun, LooksForSpecksOnlyWhereTheWholeDoes) {
  start(jittered(box_cloud(30000, 12), 13, 0.005F), at_depth(8, 4));
  for (const int blocks : {1, 2, 4}) {
    expect_as_whole(6, blocks);
    EXPECT_EQ(specks_, 2);
  }
}

/// Where samples end beside a cut, the surface goes on in a block whose own finer nodes are far away.
TEST_F(BlockRun, GivesItWhereSamplesEndAtTheBorderOfABlock) {
  const Cloud sphere = sphere_cloud(60000, 14);
  for (const float end : {0.06F, 0.07F, 0.08F}) {
    Cloud cloud;
    for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
      if (sphere.positions[i].x <= end) continue;
      cloud.positions.push_back(sphere.positions[i]);
      cloud.normals.push_back(sphere.normals[i]);
    }
    for (const Vec3f& corner : {Vec3f{-0.9F, -0.9F, -0.9F}, Vec3f{-0.9F, 0.9F, 0.9F}, Vec3f{-0.9F, -0.9F, 0.9F},
                                Vec3f{-0.9F, 0.9F, -0.9F}})  // which keep the cut in the middle
      append(cloud, translated(scaled(sphere_cloud(200, 15), 0.05F), corner));
    Options options = at_depth(8);
    options.point_normals = PointNormals::given;
    options.keep_strays = true;
    start(cloud, options);
    expect_as_whole(6, 16);
  }
}

TEST_F(BlockRun, CutsWhereSamplesEnd) {
  Cloud cloud;
  const Cloud sphere = jittered(sphere_cloud(40000, 14), 15, 0.003F);
  for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
    if (sphere.positions[i].z > 0.3F * sphere.positions[i].x + 0.4F) continue;
    cloud.positions.push_back(sphere.positions[i]);
    cloud.normals.push_back(sphere.normals[i]);
  }
  Options options = at_depth(8, 4);
  options.trim = 0.03;
  start(cloud, options);
  expect_as_whole(5, 7);
  expect_as_whole(6, 16);
  options.island_ratio = 0;
  start(cloud, options);
  expect_as_whole(6, 5);
}

TEST_F(BlockRun, NeedsTheRingThatItTakes) {
  start(sphere_cloud(40000, 8), at_depth(7, 16));
  scale::BlockOptions options = block_options(5, 3);
  options.ring = 8;  // half of it
  try {
    EXPECT_GT(differences(options), 0);
  } catch (const Error& error) {  // a vertex that a triangle needs is in no block
    EXPECT_EQ(error.code(), ErrorCode::internal);
  }
  options.ring = 0;
  EXPECT_EQ(differences(options), 0);
}

TEST_F(BlockRun, WritesTheFileOfTheWhole) {
  for (const Vec3f& offset : {Vec3f{}, Vec3f{1000, 0, 0}}) {
    start(translated(torus_cloud(4000, 11), offset), at_depth(7, 4));
    expect_the_file_of_the_whole(block_options(5, 2));
  }
}

TEST_F(BlockRun, TakesMoreBlocksWhereThereIsLessMemory) {
  start(sphere_cloud(40000, 10), at_depth(8, 4));
  scale::BlockOptions options = block_options(0, 0);
  int before = 0;
  for (const std::int64_t megabytes : {400, 40}) {
    options.memory_bytes = megabytes * 1'000'000;
    EXPECT_EQ(differences(options), 0);
    EXPECT_GT(blocks_, before);
    before = blocks_;
  }
  options.memory_bytes = 1'000'000;
  try {
    (void)differences(options);
    FAIL() << "a megabyte holds no block";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::over_limit);
  }
}

TEST_F(BlockRun, RefusesLevelsThatItCannotShare) {
  start(sphere_cloud(2000, 9), at_depth(7));
  for (const int level : {4, 6}) EXPECT_THROW((void)differences(block_options(level, 2)), Error);
}

TEST_F(BlockRun, SumsUpFieldsThatAreFarFromOneHalf) {
  Random random(16);
  Cloud plane;  // 0 in the middle, but for what is cut off
  for (int i = 0; i < 10000; ++i) {
    plane.positions.push_back({static_cast<float>(random.unit()), static_cast<float>(random.unit()), 0});
    plane.normals.push_back({0, 0, 1});
  }
  Options options = at_depth(8, 30, 0);
  options.point_normals = PointNormals::given;
  options.domain_faces = DomainFaces::open;
  start(plane, options);
  expect_as_whole(6, 2);
  EXPECT_TRUE(sums_again_);
}

TEST_F(BlockRun, GivesItWithoutScreening) {
  start(sphere_cloud(10000, 7), at_depth(8, 4, 0));
  expect_as_whole(5, 2);
}

}  // namespace
}  // namespace pointskin::test
