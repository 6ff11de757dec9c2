// Merging of clouds, leaving out points, and the vertices of meshes as clouds.
#include <gtest/gtest.h>

#include <cstdint>
#include <string>
#include <utility>
#include <vector>

#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>

namespace pointskin {
namespace {

Cloud row_of(int count, const Vec3d& origin = {0, 0, 0}) {
  Cloud cloud;
  cloud.origin = origin;
  for (int i = 0; i < count; ++i) {
    cloud.positions.push_back({static_cast<float>(i), 0.5F, -1});
    cloud.normals.push_back({0, 0, 1});
  }
  return cloud;
}

Cloud merged(Cloud cloud, Cloud more) {
  merge_into(cloud, std::move(more));
  return cloud;
}

TEST(MergeInto, PutsThePointsBehindEachOther) {
  Cloud first = row_of(2);
  Cloud second = row_of(3);
  second.normals.assign(3, {1, 0, 0});
  first.dropped = 4;
  second.dropped = 5;
  const Cloud both = merged(first, second);
  const std::vector<Vec3f> positions = {{0, 0.5F, -1}, {1, 0.5F, -1}, {0, 0.5F, -1}, {1, 0.5F, -1}, {2, 0.5F, -1}};
  const std::vector<Vec3f> normals = {{0, 0, 1}, {0, 0, 1}, {1, 0, 0}, {1, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(both.positions, positions);
  EXPECT_EQ(both.normals, normals);
  EXPECT_EQ(both.dropped, 9);
}

TEST(MergeInto, KeepsWorldPositionsWhateverTheOrigins) {
  // Both are small around their own origins, 2^20 apart, where float has steps of 1/8; halves and wholes are exact.
  const Vec3d here{1048576, 0, 0};
  for (const bool large_first : {true, false}) {
    const Cloud large = row_of(100, here);
    const Cloud small = row_of(2);
    const Cloud both = large_first ? merged(large, small) : merged(small, large);
    EXPECT_EQ(both.origin, here) << "float loses less around the cloud with more points";
    std::vector<double> x;
    for (const Vec3f& p : both.positions) x.push_back(both.origin[0] + p.x);
    const std::size_t first_of_large = large_first ? 0 : 2;
    EXPECT_EQ(x[first_of_large], 1048576);
    EXPECT_EQ(x[first_of_large + 99], 1048675);
    EXPECT_EQ(x[large_first ? 100 : 0], 0);
    EXPECT_EQ(x[large_first ? 101 : 1], 1);
  }
}

TEST(MergeInto, KeepsNormalsOnlyIfBothHaveThem) {
  Cloud bare = row_of(2);
  bare.normals.clear();
  EXPECT_TRUE(merged(row_of(2), row_of(1)).has_normals());
  EXPECT_TRUE(merged(bare, row_of(1)).normals.empty());
  EXPECT_TRUE(merged(row_of(1), bare).normals.empty());
}

TEST(MergeInto, AttributesThatOneLacksAreMissingThere) {
  Cloud first = row_of(2);
  Cloud second = row_of(1);
  first.attributes = {{"label", std::vector<std::int32_t>{7, 8}}, {"red", std::vector<std::uint8_t>{1, 2}}};
  second.attributes = {{"height", std::vector<float>{0.5F}}, {"red", std::vector<std::int16_t>{-3}}};
  const Cloud both = merged(first, second);
  ASSERT_EQ(both.attributes.size(), 3U);
  const Attribute& label = both.attributes[0];
  const Attribute& red = both.attributes[1];
  const Attribute& height = both.attributes[2];
  EXPECT_EQ(label.name + " " + red.name + " " + height.name, "label red height");
  EXPECT_EQ(label.type(), AttributeType::int32);
  EXPECT_EQ(label.values.at(1), 8);
  EXPECT_TRUE(label.values.is_missing(2));
  EXPECT_EQ(red.type(), AttributeType::int16) << "holds uint8 and int16";
  EXPECT_EQ(red.values.as<std::int16_t>(), (std::vector<std::int16_t>{1, 2, -3}));
  EXPECT_TRUE(height.values.is_missing(0) && height.values.is_missing(1));
  EXPECT_EQ(height.values.at(2), 0.5);
}

TEST(MergeInto, ACloudWithoutPointsChangesNothingButTheCount) {
  Cloud nothing;
  nothing.dropped = 3;
  Cloud cloud = row_of(2, {1, 2, 3});
  cloud.attributes = {{"height", std::vector<float>{1, 2}}};
  for (const Cloud& both : {merged(nothing, cloud), merged(cloud, nothing)}) {
    EXPECT_EQ(both.origin, cloud.origin);
    EXPECT_EQ(both.positions, cloud.positions);
    EXPECT_EQ(both.normals, cloud.normals);
    ASSERT_EQ(both.attributes.size(), 1U);
    EXPECT_EQ(both.attributes[0].values, cloud.attributes[0].values);
    EXPECT_EQ(both.dropped, 3);
  }
  EXPECT_EQ(merged(nothing, nothing).dropped, 6);
}

TEST(KeepWhere, LeavesPointsWithAllThatTheyHave) {
  Cloud cloud = row_of(4);
  cloud.normals[2] = {0, 1, 0};
  cloud.attributes = {{"label", std::vector<std::int32_t>{5, 6, 7, 8}}};
  cloud.dropped = 1;
  keep_where(cloud, {true, false, true, false});
  EXPECT_EQ(cloud.positions, (std::vector<Vec3f>{{0, 0.5F, -1}, {2, 0.5F, -1}}));
  EXPECT_EQ(cloud.normals, (std::vector<Vec3f>{{0, 0, 1}, {0, 1, 0}}));
  EXPECT_EQ(cloud.attributes[0].values.as<std::int32_t>(), (std::vector<std::int32_t>{5, 7}));
  EXPECT_EQ(cloud.dropped, 3);
}

TEST(KeepWhere, NeedsAMarkAPoint) {
  Cloud cloud = row_of(4);
  try {
    keep_where(cloud, {true, false});
    FAIL() << "two marks for four points";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_STREQ(error.what(), "2 marks of points to keep for 4 points");
  }
  EXPECT_EQ(cloud.size(), 4) << "the cloud is left alone";
}

TEST(CloudOfVertices, TakesAllButTheTriangles) {
  Mesh mesh;
  mesh.origin = {1, 2, 3};
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
  mesh.normals.assign(3, {0, 0, 1});
  mesh.attributes = {{"height", std::vector<float>{1, 2, 3}}};
  mesh.triangles = {{0, 1, 2}};
  const Mesh before = mesh;
  const Cloud cloud = cloud_of_vertices(std::move(mesh));
  EXPECT_EQ(cloud.origin, before.origin);
  EXPECT_EQ(cloud.positions, before.vertices);
  EXPECT_EQ(cloud.normals, before.normals);
  ASSERT_EQ(cloud.attributes.size(), 1U);
  EXPECT_EQ(cloud.attributes[0].values, before.attributes[0].values);
  EXPECT_EQ(cloud.dropped, 0);
}

}  // namespace
}  // namespace pointskin
