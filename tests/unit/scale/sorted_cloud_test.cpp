// Points sorted on a disk, against the sort of the engine in memory.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <limits>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include "exec/cpu.hpp"
#include "exec/cpu_primitives.hpp"
#include "io/cloud_parts.hpp"
#include "octree/frame.hpp"
#include "reconstruct/points.hpp"
#include "scale/cloud_extent.hpp"
#include "scale/sorted_cloud.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using scale::SortedCloud;

struct Points {
  std::vector<Vec3f> positions, normals;
  std::vector<std::uint64_t> keys;

  explicit Points(std::int64_t size)
      : positions(static_cast<std::size_t>(size)),
        normals(static_cast<std::size_t>(size)),
        keys(static_cast<std::size_t>(size)) {}
};

template <class T>
bool same_bytes(const std::vector<T>& a, const T* b) {
  return std::memcmp(a.data(), b, sizeof(T) * a.size()) == 0;
}

/// Of the points of a file that are not left out.
void expect_attributes(exec::Cpu& ex, const SortedCloud& sorted, const field::AttributeSamples& expected) {
  const std::vector<scale::PointAttribute>& found = sorted.attributes();
  ASSERT_EQ(found.size(), expected.channels.size());
  EXPECT_EQ(sorted.without_values(), expected.without_values);
  std::vector<std::vector<float>> shares(found.size(), std::vector<float>(static_cast<std::size_t>(sorted.size())));
  std::vector<float*> to;
  for (std::vector<float>& values : shares) to.push_back(values.data());
  sorted.read(ex, 0, sorted.size(), {nullptr, nullptr, nullptr, to});
  for (std::size_t c = 0; c < found.size(); ++c) {
    EXPECT_EQ(found[c].name, expected.names[c]);
    EXPECT_EQ(found[c].type, expected.channels[c].type);
    EXPECT_EQ(found[c].range.lowest, expected.channels[c].range.lowest);
    EXPECT_EQ(found[c].range.highest, expected.channels[c].range.highest);
    EXPECT_EQ(found[c].range.counted, expected.channels[c].range.counted);
    EXPECT_TRUE(same_bytes(shares[c], expected.channels[c].shares.data())) << found[c].name;
  }
}

/// Sorts the points of the file on the disk and in memory, without strays.
void expect_as_in_memory(const std::string& path, std::int64_t memory, int threads) {
  const Cloud cloud = read_cloud(path);
  exec::Cpu ex(threads);
  const auto parts = io::CloudParts::open(ex, path);
  ASSERT_NE(parts, nullptr);
  parts->choose_origin(ex, std::nullopt);
  scale::CloudExtent extent = scale::find_extent(ex, *parts, false);
  const octree::Frame frame = octree::frame_around(extent.strays.core, 1.1);

  detail::PointBuffers points = detail::upload(ex, cloud);
  points.attributes = detail::upload_attributes(ex, cloud);
  detail::leave_out(ex, extent.strays, points);
  const detail::SortedSamples expected = detail::sort_into_cube(ex, points, frame);

  const TemporaryFolder folder;
  std::sort(extent.strays.indices.begin(), extent.strays.indices.end());
  const SortedCloud sorted(ex, *parts,
                           {std::filesystem::path(folder.file("any")).parent_path().string(), memory, frame,
                            extent.strays.indices, false, scale::KeptAttributes::all});
  ASSERT_EQ(sorted.size(), expected.keys.size());
  Points all(sorted.size());
  sorted.read(0, sorted.size(), {all.positions.data(), all.normals.data(), all.keys.data()});
  EXPECT_TRUE(same_bytes(all.keys, expected.keys.data()));
  EXPECT_TRUE(same_bytes(all.positions, expected.samples.positions.data()));
  EXPECT_TRUE(same_bytes(all.normals, expected.samples.normals.data()));

  expect_attributes(ex, sorted, expected.attributes);
  const std::int64_t first = sorted.size() / 3, some = sorted.size() / 2;
  Points part(some);
  sorted.read(first, some, {part.positions.data(), nullptr, nullptr});
  EXPECT_TRUE(same_bytes(part.positions, expected.samples.positions.data() + first));
  EXPECT_EQ(folder.file_count(), 0U);
}

/// Every third point is there again with another normal, every fifth once more in all its bits, and some are strays.
Cloud with_duplicates(Cloud cloud) {
  const std::size_t size = cloud.positions.size();
  for (std::size_t i = 0; i < size; ++i) {
    if (i % 3 == 0) {
      cloud.positions.push_back(cloud.positions[i]);
      cloud.normals.push_back({-cloud.normals[i].y, cloud.normals[i].x, 0.5F});
    }
    if (i % 5 == 0) {
      cloud.positions.push_back(cloud.positions[i]);
      cloud.normals.push_back(cloud.normals[i]);
    }
  }
  for (int s = 0; s < 7; ++s) {
    cloud.positions.push_back({100.0F + 30 * s, 200, -100});
    cloud.normals.push_back({1, 0, 0});
  }
  return shuffled(cloud, 8);
}

TEST(SortedCloud, HasTheOrderAndTheBitsOfTheSortInMemory) {
  const TemporaryFolder folder;
  const std::string path = folder.file("cloud.ply");
  write_cloud(path, with_duplicates(torus_cloud(60'000, 1)));
  for (const std::int64_t memory : {std::int64_t{0}, std::int64_t{2} << 20, std::int64_t{1} << 30}) {
    SCOPED_TRACE(memory);
    expect_as_in_memory(path, memory, 1);
    expect_as_in_memory(path, memory, 3);
  }
}

TEST(SortedCloud, SortsManyPointsAtOnePlaceByTheirNormals) {
  const TemporaryFolder folder;
  Cloud cloud = sphere_cloud(20'000, 2);
  for (std::size_t i = 0; i < cloud.positions.size(); i += 2) cloud.positions[i] = {0.25F, 0.25F, 0.25F};
  write_cloud(folder.file("cloud.ply"), cloud);
  expect_as_in_memory(folder.file("cloud.ply"), 1 << 20, 2);
}

/// Equal points are in the order of their attributes, whatever their order in the file.
TEST(SortedCloud, HasTheAttributesOfTheSortInMemory) {
  const TemporaryFolder folder;
  Cloud cloud = with_duplicates(torus_cloud(20'000, 1));
  Random random(4);
  std::vector<std::uint8_t> red;
  std::vector<double> mass;
  std::vector<float> heat, nothing(cloud.positions.size(), std::numeric_limits<float>::quiet_NaN());
  for (const Vec3f& p : cloud.positions) {
    red.push_back(static_cast<std::uint8_t>(random.below(256)));
    mass.push_back(1e9 + random.unit());
    heat.push_back(p.x > 0 ? static_cast<float>(random.unit()) : nothing.front());
  }
  cloud.attributes = {{"red", red}, {"nothing", nothing}, {"mass", mass}, {"heat", heat}};
  const std::string path = folder.file("cloud.ply");
  write_cloud(path, cloud);
  for (const std::int64_t memory : {std::int64_t{0}, std::int64_t{1} << 30}) {
    SCOPED_TRACE(memory);
    expect_as_in_memory(path, memory, 3);
  }
}

TEST(SortedCloud, ReadsLabelsInTheirType) {
  constexpr std::int64_t kPoints = 20'000;
  const TemporaryFolder folder, temporary_folder;
  Cloud cloud = sphere_cloud(kPoints, 3);
  std::vector<std::uint16_t> label;  // of a point: what its coordinates say
  const auto label_of = [](const Vec3f& p) { return static_cast<std::uint16_t>(1000 * (p.x + 1.5F)); };
  for (const Vec3f& p : cloud.positions) label.push_back(label_of(p));
  cloud.attributes = {{"heat", std::vector<float>(kPoints, 1)}, {"class", label}};
  write_cloud(folder.file("cloud.ply"), cloud);
  exec::Cpu ex(1);
  const auto parts = io::CloudParts::open(ex, folder.file("cloud.ply"));
  parts->choose_origin(ex, std::nullopt);
  const std::vector<scale::PointAttribute> all = scale::attributes_of(ex, *parts, scale::KeptAttributes::all);
  ASSERT_EQ(all.size(), 2U);
  EXPECT_FALSE(all.front().is_label());
  EXPECT_TRUE(all.back().is_label());
  const octree::Frame frame{{-2, -2, -2}, 4};
  const SortedCloud sorted(ex, *parts,
                           {temporary_folder.file(""), 1 << 20, frame, {}, false, scale::KeptAttributes::all});
  const std::int64_t first = 10, count = kPoints - 20;
  std::vector<Vec3f> positions(static_cast<std::size_t>(count));
  std::vector<std::uint16_t> labels(positions.size());
  std::vector<float> heat(positions.size());
  const std::vector<float*> shares{heat.data(), nullptr};
  const std::vector<std::uint8_t*> raw{nullptr, reinterpret_cast<std::uint8_t*>(labels.data())};
  exec::Cpu several(3);
  sorted.read(several, first, count, {positions.data(), nullptr, nullptr, shares, raw});
  for (std::size_t i = 0; i < positions.size(); ++i)
    EXPECT_NEAR(labels[i], label_of(frame.to_world(positions[i])), 1) << i;
  EXPECT_TRUE(scale::attributes_of(ex, *parts, scale::KeptAttributes::colours).empty());
  EXPECT_TRUE(scale::attributes_of(ex, *parts, scale::KeptAttributes::none).empty());
}

TEST(SortedCloud, NeedsNormals) {
  const TemporaryFolder folder;
  Cloud cloud = sphere_cloud(1000, 3);
  cloud.normals.clear();
  write_cloud(folder.file("cloud.ply"), cloud);
  exec::Cpu ex(1);
  const auto parts = io::CloudParts::open(ex, folder.file("cloud.ply"));
  parts->choose_origin(ex, std::nullopt);
  const std::string temporary = std::filesystem::path(folder.file("any")).parent_path().string();
  EXPECT_THROW(SortedCloud(ex, *parts, {temporary, 1 << 20, {}, {}}), Error);
}

}  // namespace
}  // namespace pointskin::test
