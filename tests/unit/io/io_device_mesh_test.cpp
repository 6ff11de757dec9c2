// Meshes in the memory of a device: files of the same bytes, at a glance the same, and what is never written.
#include <gtest/gtest.h>

#include <pointskin/components.hpp>
#include <pointskin/device_data.hpp>
#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>

#include <filesystem>
#include <limits>

#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

/// The mesh's own arrays, which are memory of the device CPU. `mesh` stays.
DeviceMesh in_place(Mesh& mesh) {
  DeviceMesh view;
  view.origin = mesh.origin;
  view.vertices = {mesh.vertices.data(), static_cast<std::int64_t>(mesh.vertices.size())};
  view.normals = {mesh.normals.data(), static_cast<std::int64_t>(mesh.normals.size())};
  view.triangles = {mesh.triangles.data(), static_cast<std::int64_t>(mesh.triangles.size())};
  return view;
}

/// More rows than a block has, and no whole number of blocks.
Mesh ball() { return test::icosphere_mesh(6, 1, {0, 0, 0}); }

void expect_same_file(Mesh& mesh, const std::string& name, const WriteOptions& options = {}) {
  const test::TemporaryFolder folder;
  const Workspace workspace(Device::cpu(3));
  write_mesh(folder.file("host" + name), mesh, options);
  write_mesh(folder.file("device" + name), workspace, in_place(mesh), options);
  EXPECT_TRUE(test::bytes_of_file(folder.file("host" + name)) == test::bytes_of_file(folder.file("device" + name)))
      << name;
}

TEST(DeviceMesh, IsWrittenAsTheSameMeshOfTheHostIs) {
  Mesh mesh = ball();
  ASSERT_GT(mesh.vertices.size(), std::size_t{1} << 14);
  expect_same_file(mesh, ".ply");
  expect_same_file(mesh, ".ply", {.double_coordinates = true});
  expect_same_file(mesh, ".ply", {.ascii = true});
  expect_same_file(mesh, ".obj");
  mesh.origin = {4e5, 5e6, 0};
  expect_same_file(mesh, ".ply");
  mesh.normals.clear();
  expect_same_file(mesh, ".ply");
  mesh.triangles.clear();
  expect_same_file(mesh, ".ply");
}

TEST(DeviceMesh, KeepsItsAttributesInAFile) {
  const test::TemporaryFolder folder;
  Mesh mesh = ball();
  std::vector<float> heights;
  for (const Vec3f& v : mesh.vertices) heights.push_back(v.z);
  DeviceMesh view = in_place(mesh);
  view.attributes.push_back({"height", AttributeType::float32, heights.data()});
  write_mesh(folder.file("a.ply"), Workspace(Device::cpu(1)), view);
  const Mesh back = read_mesh(folder.file("a.ply"));
  ASSERT_EQ(back.attributes.size(), 1);
  EXPECT_EQ(back.attributes[0].values, AttributeValues(heights));
}

TEST(DeviceMesh, IsNotWrittenWhereItIsWrong) {
  const test::TemporaryFolder folder;
  const Workspace workspace(Device::cpu(2));
  const auto story = [&](Mesh mesh) {
    return test::story_of(ErrorCode::invalid_input,
                          [&] { write_mesh(folder.file("bad.ply"), workspace, in_place(mesh)); });
  };
  Mesh mesh = ball();
  mesh.vertices[20'000].y = std::numeric_limits<float>::quiet_NaN();
  EXPECT_EQ(story(mesh), "vertex 20000 is not finite");
  mesh = ball();
  mesh.normals.back().x = std::numeric_limits<float>::infinity();
  EXPECT_NE(story(mesh).find("the normal of vertex"), std::string::npos);
  mesh = ball();
  mesh.triangles.back()[1] = static_cast<std::int32_t>(mesh.vertices.size());
  EXPECT_NE(story(mesh).find("a triangle names vertex"), std::string::npos);
  mesh = ball();
  mesh.origin[2] = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(story(mesh), "the origin is not finite");
  mesh = ball();
  mesh.normals.pop_back();
  EXPECT_EQ(test::story_of(ErrorCode::usage, [&] { write_mesh(folder.file("bad.ply"), workspace, in_place(mesh)); }),
            "40961 normals for 40962 vertices");
  EXPECT_EQ(folder.file_count(), 0);
}

TEST(DeviceMesh, IsSeenAtAGlance) {
  const Workspace workspace(Device::cpu(2));
  Mesh mesh = ball();
  test::append(mesh, test::box_mesh({2, 0, 0}, {4, 2, 2}));
  const auto expect_as_on_the_host = [&] {
    const MeshGlance there = glance_at(workspace, in_place(mesh));
    const MeshGlance here = glance_at(mesh, 1);
    EXPECT_EQ(there.components, here.components);
    EXPECT_EQ(there.closed, here.closed);
    EXPECT_EQ(there.oriented, here.oriented);
    return there;
  };
  EXPECT_TRUE(expect_as_on_the_host().oriented);
  EXPECT_EQ(expect_as_on_the_host().components, 2);
  std::swap(mesh.triangles[7][0], mesh.triangles[7][1]);
  EXPECT_TRUE(expect_as_on_the_host().closed);
  EXPECT_FALSE(expect_as_on_the_host().oriented);
  mesh.triangles.pop_back();
  EXPECT_FALSE(expect_as_on_the_host().closed);
  mesh.triangles.back()[0] = -1;
  EXPECT_NE(test::story_of(ErrorCode::invalid_input, [&] { (void)glance_at(workspace, in_place(mesh)); })
                .find("a vertex that is not there"),
            std::string::npos);
  EXPECT_EQ(glance_at(workspace, {}).components, 0);
}

TEST(DeviceMesh, OfARunIsTheMeshOfTheRun) {
  const Cloud cloud = test::torus_cloud(20'000, 5);
  Reconstructor reconstructor(Device::cpu(2));
  const Options options{{.depth = 6}};
  const Mesh mesh = reconstructor.reconstruct(cloud, options);
  const Mesh other = download(reconstructor.workspace(), reconstructor.reconstruct_on_device(cloud, options));
  EXPECT_EQ(mesh.vertices, other.vertices);
  EXPECT_EQ(mesh.normals, other.normals);
  EXPECT_EQ(mesh.triangles, other.triangles);
}

}  // namespace
}  // namespace pointskin
