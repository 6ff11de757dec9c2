// The box and the strays of a cloud that is read in parts, against those of the cloud in memory.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <vector>

#include "exec/cpu.hpp"
#include "exec/cpu_primitives.hpp"
#include "io/cloud_parts.hpp"
#include "io/npy.hpp"
#include "octree/strays.hpp"
#include "scale/cloud_extent.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"
#include "support/thread_ranks.hpp"

namespace pointskin::test {
namespace {

using io::CloudParts;
using scale::CloudExtent;

/// As each of several ranks finds it.
std::vector<CloudExtent> extents_of_ranks(const std::string& path, int ranks) {
  std::vector<CloudExtent> found(static_cast<std::size_t>(ranks));
  run_as_ranks(ranks, [&](Ranks& all) {
    exec::Cpu ex(1);
    const std::unique_ptr<CloudParts> parts = CloudParts::open(ex, path);
    parts->choose_origin(ex, std::nullopt);
    found[static_cast<std::size_t>(all.rank())] = scale::find_extent(ex, *parts, false, scale::Team(&all));
  });
  return found;
}

CloudExtent extent_of_file(const std::string& path, int threads, bool keep_strays = false) {
  exec::Cpu ex(threads);
  const std::unique_ptr<CloudParts> parts = CloudParts::open(ex, path);
  EXPECT_NE(parts, nullptr);
  parts->choose_origin(ex, std::nullopt);
  return scale::find_extent(ex, *parts, keep_strays);
}

bool has_normal(const Vec3f& n) { return n.x != 0 || n.y != 0 || n.z != 0; }

/// Writes the cloud, reads it in parts and as a whole.
void expect_as_in_memory(const Cloud& cloud, bool has_strays) {
  const TemporaryFolder folder;
  const std::string path = folder.file("cloud.ply");
  write_cloud(path, cloud);
  const Cloud whole = read_cloud(path);
  exec::Cpu ex(2);
  const octree::StrayPoints strays =
      octree::find_strays(ex, ArrayView<const Vec3f>{whole.positions.data(), whole.size()});
  ASSERT_EQ(strays.size() > 0, has_strays);
  std::int64_t with_normal = std::count_if(whole.normals.begin(), whole.normals.end(), has_normal);
  for (const std::int32_t i : strays.indices) with_normal -= has_normal(whole.normals[static_cast<std::size_t>(i)]);
  std::vector<CloudExtent> all{extent_of_file(path, 1), extent_of_file(path, 3)};
  for (const int ranks : {2, 3, 7}) {
    std::int64_t before = 0;
    for (CloudExtent& found : extents_of_ranks(path, ranks)) {
      EXPECT_GE(found.before, before);
      before = found.before;
      all.push_back(std::move(found));
    }
  }
  for (const CloudExtent& found : all) {
    EXPECT_EQ(found.points, whole.size() - strays.size());
    EXPECT_EQ(found.with_normal, with_normal);
    EXPECT_EQ(found.strays.indices, strays.indices);
    EXPECT_EQ(found.strays.positions, strays.positions);
    EXPECT_EQ(found.strays.core.lower, strays.core.lower);
    EXPECT_EQ(found.strays.core.upper, strays.core.upper);
  }
}

/// With some points far away, one of them without a normal.
Cloud with_strays(Cloud cloud, int strays) {
  const std::size_t step = cloud.positions.size() / static_cast<std::size_t>(strays + 1);
  for (int s = 1; s <= strays; ++s) {
    const std::size_t i = step * static_cast<std::size_t>(s);
    cloud.positions[i] = {s % 2 == 0 ? 500.0F + 100 * s : -2.0F, 300.0F, 50.0F * s};
    if (s == 1) cloud.normals[i] = {};
  }
  return cloud;
}

TEST(CloudExtent, IsThatOfTheCloudInMemory) {
  for (const std::int64_t points : {1, 100, 129, 5'000, 400'000}) {
    SCOPED_TRACE(points);
    expect_as_in_memory(sphere_cloud(points, 1), false);
  }
}

TEST(CloudExtent, LeavesOutTheStraysThatAreLeftOutInMemory) {
  expect_as_in_memory(with_strays(torus_cloud(20'000, 2), 9), true);
  expect_as_in_memory(with_strays(torus_cloud(400'000, 3), 20), true);
}

TEST(CloudExtent, DoesNotMindPointsThatComeInTheOrderOfTheirPlaces) {
  Cloud cloud = sphere_cloud(100'000, 4);
  std::sort(cloud.positions.begin(), cloud.positions.end(), [](const Vec3f& a, const Vec3f& b) { return a.x < b.x; });
  cloud.normals = cloud.positions;
  expect_as_in_memory(cloud, false);
  expect_as_in_memory(with_strays(cloud, 12), true);
}

TEST(CloudExtent, KeepsStraysWhereTheyAreWanted) {
  const TemporaryFolder folder;
  write_cloud(folder.file("cloud.ply"), with_strays(torus_cloud(20'000, 5), 9));
  const CloudExtent found = extent_of_file(folder.file("cloud.ply"), 2, true);
  EXPECT_EQ(found.points, 20'000);
  EXPECT_EQ(found.with_normal, 19'999);
  EXPECT_TRUE(found.strays.indices.empty());
  EXPECT_GT(found.strays.core.upper.x, 400);
}

TEST(CloudExtent, CountsPointsAndNotTheRowsWithoutAny) {
  constexpr std::int64_t kRows = 10'000;
  const TemporaryFolder folder;
  const Cloud sphere = sphere_cloud(kRows, 6);
  std::string values;
  for (std::int64_t row = 0; row < kRows; ++row) {
    const Vec3f& p = sphere.positions[static_cast<std::size_t>(row)];
    const bool is_point = row % 66 == 0;  // 152 of them
    for (const float v : {p.x, p.y, p.z})
      values += raw<float>(!is_point ? std::numeric_limits<float>::quiet_NaN() : row == 660 ? 1e4F : v);
  }
  make_file(folder.file("few.npy"), io::npy_header(AttributeType::float32, kRows, 3) + values);
  const Cloud whole = read_cloud(folder.file("few.npy"));
  exec::Cpu ex(2);
  const octree::StrayPoints strays =
      octree::find_strays(ex, ArrayView<const Vec3f>{whole.positions.data(), whole.size()});
  ASSERT_EQ(strays.size(), 1);
  const CloudExtent found = extent_of_file(folder.file("few.npy"), 2);
  EXPECT_EQ(found.points, whole.size() - 1);
  EXPECT_EQ(found.strays.indices, strays.indices);
  EXPECT_EQ(found.strays.core.lower, strays.core.lower);
  EXPECT_EQ(found.strays.core.upper, strays.core.upper);
}

TEST(CloudExtent, OfNoPointsIsAnError) {
  const TemporaryFolder folder;
  make_file(folder.file("none.ply"),
            "ply\nformat binary_little_endian 1.0\nelement vertex 0\nproperty float x\nproperty "
            "float y\nproperty float z\nend_header\n");
  EXPECT_THROW(extent_of_file(folder.file("none.ply"), 1), Error);
}

}  // namespace
}  // namespace pointskin::test
