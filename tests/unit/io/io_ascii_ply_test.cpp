#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/io_files.hpp"

namespace pointskin {
namespace {

using test::bytes_of_file;

/// Two triangles with everything that PLY stores.
Mesh square() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {0.1F, 0, 0}, {1e-30F, 1e30F, 0}, {0, 3, -0.25F}};
  mesh.normals = {{0, 0, 1}, {0, 0, -1}, {0, 1, 0}, {0.6F, 0.8F, 0}};
  mesh.attributes = {{"red", std::vector<std::uint8_t>{0, 1, 254, 255}},
                     {"quality", std::vector<float>{0.1F, -1, 1e30F, 16777216}},
                     {"shade", std::vector<std::int8_t>{-128, 0, 65, 127}},
                     {"time", std::vector<double>{0.1, 3e8 + 0.001, -1, 0}},
                     {"point_id", std::vector<std::uint64_t>{0, 16777217, 4294967295, 1}}};
  mesh.triangles = {{0, 1, 2}, {2, 1, 3}};
  return mesh;
}

TEST(AsciiPly, IsALinePerVertexAndFaceInTheFewestDigits) {
  const test::TemporaryFolder folder;
  write_mesh(folder.file("a.ply"), square(), {.ascii = true});
  EXPECT_EQ(bytes_of_file(folder.file("a.ply")),
            "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
            "property float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty float quality\n"
            "property char shade\nproperty double time\nproperty uint point_id\n"
            "element face 2\nproperty list uchar int vertex_indices\nend_header\n"
            "0 0 0 0 0 1 0 0.1 -128 0.1 0\n"
            "0.1 0 0 0 0 -1 1 -1 0 300000000.001 16777217\n"
            "1e-30 1e+30 0 0 1 0 254 1e+30 65 -1 4294967295\n"
            "0 3 -0.25 0.6 0.8 0 255 16777216 127 0 1\n"
            "3 0 1 2\n3 2 1 3\n");
}

TEST(AsciiPly, ReadsBackAsTheBinaryFileDoes) {
  const test::TemporaryFolder folder;
  Mesh mesh = square();
  mesh.vertices[2] = {std::sqrt(2.0F), 1.0F / 3, std::nextafter(1.0F, 2.0F)};
  for (const Vec3d& origin : {Vec3d{0, 0, 0}, Vec3d{2600000.1, -1200000, 400}}) {
    mesh.origin = origin;
    write_mesh(folder.file("text.ply"), mesh, {.ascii = true});
    write_mesh(folder.file("bytes.ply"), mesh);
    const ReadOptions as_it_is{.shift = origin};
    const Mesh text = read_mesh(folder.file("text.ply"), as_it_is);
    const Mesh bytes = read_mesh(folder.file("bytes.ply"), as_it_is);
    EXPECT_EQ(text.vertices, bytes.vertices);
    EXPECT_EQ(text.normals, bytes.normals);
    EXPECT_EQ(text.triangles, bytes.triangles);
    ASSERT_EQ(text.attributes.size(), 5U);
    for (std::size_t a = 0; a < 5; ++a) {
      EXPECT_EQ(text.attributes[a].type(), bytes.attributes[a].type());
      EXPECT_EQ(text.attributes[a].values, bytes.attributes[a].values);
    }
  }
}

TEST(AsciiPly, HoldsCloudsToo) {
  const test::TemporaryFolder folder;
  Cloud cloud;
  cloud.positions = {{1, 2, 3}, {4, 5, 6}};
  cloud.attributes = {{"q", std::vector<float>{0.5F, std::numeric_limits<float>::quiet_NaN()}}};
  write_cloud(folder.file("c.ply"), cloud, {.ascii = true});
  const std::string text = bytes_of_file(folder.file("c.ply"));
  EXPECT_TRUE(text.ends_with("end_header\n1 2 3 0.5\n4 5 6 nan\n")) << text;
  const Cloud back = read_cloud(folder.file("c.ply"));
  EXPECT_EQ(back.positions, cloud.positions);
  EXPECT_TRUE(std::isnan(back.attributes[0].values.at(1)));
}

TEST(AsciiPly, IsTheSameForAnyNumberOfThreads) {
  const test::TemporaryFolder folder;
  Mesh mesh;
  for (std::int32_t i = 0; i < 50'000; ++i) mesh.vertices.push_back({std::sin(static_cast<float>(i)), 1, 2});
  for (std::int32_t i = 0; i + 2 < 50'000; ++i) mesh.triangles.push_back({i, i + 1, i + 2});
  write_mesh(folder.file("1.ply"), mesh, {.ascii = true, .threads = 1});
  write_mesh(folder.file("7.ply"), mesh, {.ascii = true, .threads = 7});
  EXPECT_EQ(bytes_of_file(folder.file("1.ply")), bytes_of_file(folder.file("7.ply")));
}

TEST(AsciiPly, LeavesObjAndStlAsTheyAre) {
  const test::TemporaryFolder folder;
  for (const char* name : {"a.obj", "a.stl"}) {
    write_mesh(folder.file(name), square());
    const std::string before = bytes_of_file(folder.file(name));
    write_mesh(folder.file(name), square(), {.ascii = true});
    EXPECT_EQ(bytes_of_file(folder.file(name)), before) << name;
  }
}

}  // namespace
}  // namespace pointskin
