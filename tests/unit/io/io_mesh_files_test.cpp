#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "support/io_files.hpp"

namespace pointskin {
namespace {

using test::mesh_of;
using test::raw;
using test::story_of;

/// A tetrahedron far from the origin: double coordinates, normals, a colour and a scalar.
Mesh far_tetrahedron() {
  Mesh mesh;
  mesh.origin = {2600000, 1200000, 400};
  mesh.vertices = {{0, 0, 0}, {1.001f, 0, 0}, {0, 1.002f, 0}, {0, 0, 1.003f}};
  mesh.normals = {{-1, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.attributes = {{"red", std::vector<std::uint8_t>{0, 1, 254, 255}},
                     {"density", std::vector<float>{0.5f, -1, 1e30f, 3}}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {1, 2, 3}, {2, 0, 3}};
  return mesh;
}

void expect_same_world_positions(const Mesh& a, const Mesh& b, double tolerance) {
  ASSERT_EQ(a.vertices.size(), b.vertices.size());
  for (std::size_t v = 0; v < a.vertices.size(); ++v) {
    EXPECT_NEAR(a.origin[0] + a.vertices[v].x, b.origin[0] + b.vertices[v].x, tolerance);
    EXPECT_NEAR(a.origin[1] + a.vertices[v].y, b.origin[1] + b.vertices[v].y, tolerance);
    EXPECT_NEAR(a.origin[2] + a.vertices[v].z, b.origin[2] + b.vertices[v].z, tolerance);
  }
}

TEST(MeshFiles, PlyBringsBackEverythingToTheTenthOfAMicrometre) {
  const test::TemporaryFolder folder;
  const Mesh mesh = far_tetrahedron();
  write_mesh(folder.file("a.ply"), mesh);
  const Mesh back = read_mesh(folder.file("a.ply"));
  expect_same_world_positions(mesh, back, 1e-7);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.normals, mesh.normals);
  ASSERT_EQ(back.attributes.size(), 2u);
  for (std::size_t a = 0; a < 2; ++a) {
    EXPECT_EQ(back.attributes[a].name, mesh.attributes[a].name);
    EXPECT_EQ(back.attributes[a].type(), mesh.attributes[a].type());
    EXPECT_EQ(back.attributes[a].values, mesh.attributes[a].values);
  }
}

TEST(MeshFiles, PlyHoldsFloatsWithoutAnOriginAndDoublesWithOne) {
  const test::TemporaryFolder folder;
  Mesh mesh = far_tetrahedron();
  mesh.attributes.clear();
  mesh.normals.clear();
  write_mesh(folder.file("far.ply"), mesh);
  mesh.origin = {0, 0, 0};
  write_mesh(folder.file("near.ply"), mesh);
  const std::string faces = "element face 4\nproperty list uchar int vertex_indices\nend_header\n";
  const auto header = [&](const std::string& type) {
    return "ply\nformat binary_little_endian 1.0\nelement vertex 4\nproperty " + type + " x\nproperty " + type +
           " y\nproperty " + type + " z\n" + faces;
  };
  const std::string far_bytes = test::bytes_of_file(folder.file("far.ply"));
  const std::string near_bytes = test::bytes_of_file(folder.file("near.ply"));
  EXPECT_EQ(far_bytes.substr(0, header("double").size()), header("double"));
  EXPECT_EQ(far_bytes.size(), header("double").size() + 4 * 24 + 4 * 13);
  EXPECT_EQ(near_bytes.substr(0, header("float").size()), header("float"));
  EXPECT_EQ(near_bytes.size(), header("float").size() + 4 * 12 + 4 * 13);
}

TEST(MeshFiles, ObjBringsBackWorldCoordinatesAndNormals) {
  const test::TemporaryFolder folder;
  const Mesh mesh = far_tetrahedron();
  write_mesh(folder.file("a.OBJ"), mesh);
  const Mesh back = read_mesh(folder.file("a.OBJ"));
  expect_same_world_positions(mesh, back, 1e-7);
  EXPECT_EQ(back.triangles, mesh.triangles);
  EXPECT_EQ(back.normals, mesh.normals);
}

TEST(MeshFiles, ObjPrintsFloatsInTheFewestDigitsThatReadBackEqual) {
  const test::TemporaryFolder folder;
  Mesh mesh;
  mesh.vertices = {{0.1f, -2, 1e-7f}, {0, 3, 4}, {5, 6, 7}};
  mesh.triangles = {{0, 1, 2}};
  write_mesh(folder.file("a.obj"), mesh);
  EXPECT_EQ(test::bytes_of_file(folder.file("a.obj")), "v 0.1 -2 1e-07\nv 0 3 4\nv 5 6 7\nf 1 2 3\n");
  EXPECT_EQ(read_mesh(folder.file("a.obj")).vertices, mesh.vertices);
}

TEST(MeshFiles, ObjHasColoursBehindCoordinatesIfTheyAreBytes) {
  const test::TemporaryFolder folder;
  Mesh mesh;
  mesh.vertices = {{1, 2, 3}, {0, 3, 4}, {5, 6, 7}};
  mesh.triangles = {{0, 1, 2}};
  const std::vector<std::uint8_t> values = {0, 128, 255};
  for (const char* name : {"blue", "red", "green"}) mesh.attributes.push_back({name, values});
  mesh.attributes[0].values = std::vector<std::uint8_t>{255, 1, 9};
  mesh.attributes[0].values.set_missing(2);
  write_mesh(folder.file("a.obj"), mesh);
  EXPECT_EQ(test::bytes_of_file(folder.file("a.obj")),
            "v 1 2 3 0.000 0.000 1.000\nv 0 3 4 0.502 0.502 0.004\nv 5 6 7 1.000 1.000 0.000\nf 1 2 3\n");
  EXPECT_EQ(read_mesh(folder.file("a.obj")).vertices, mesh.vertices);
  mesh.attributes[1].values = mesh.attributes[1].values.converted(AttributeType::float32);
  write_mesh(folder.file("a.obj"), mesh);
  EXPECT_EQ(test::bytes_of_file(folder.file("a.obj")), "v 1 2 3\nv 0 3 4\nv 5 6 7\nf 1 2 3\n");
}

TEST(MeshFiles, StlHoldsWorldCoordinatesAsFloatAndIsWeldedOnReading) {
  const test::TemporaryFolder folder;
  Mesh mesh = far_tetrahedron();
  write_mesh(folder.file("far.stl"), mesh);
  EXPECT_EQ(std::filesystem::file_size(folder.file("far.stl")), 84u + 4 * 50);
  expect_same_world_positions(
      read_mesh(folder.file("far.stl")),
      Mesh{mesh.origin, {mesh.vertices[0], mesh.vertices[2], mesh.vertices[1], mesh.vertices[3]}, {}, {}, {}},
      0.13);  // half a float step at 2.6e6
  mesh.origin = {0, 0, 0};
  write_mesh(folder.file("near.stl"), mesh);
  const Mesh back = read_mesh(folder.file("near.stl"));  // vertices in the order of the corners 0 2 1, 3
  EXPECT_EQ(back.vertices,
            (std::vector<Vec3f>{mesh.vertices[0], mesh.vertices[2], mesh.vertices[1], mesh.vertices[3]}));
  EXPECT_EQ(back.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {2, 1, 3}, {1, 0, 3}}));
  const std::string bytes = test::bytes_of_file(folder.file("near.stl"));
  EXPECT_EQ(bytes.substr(84, 12), raw<float>(0) + raw<float>(0) + raw<float>(-1));  // 0 2 1 looks down
}

TEST(MeshFiles, CloudsBringBackEverythingAndHaveNoFaces) {
  const test::TemporaryFolder folder;
  Cloud cloud;
  cloud.origin = {1e6, 2e6, 0};
  cloud.positions = {{0.001f, 0, 0}, {1, 2, 3}};
  cloud.normals = {{0, 0, 2}, {0, 3, 0}};
  cloud.attributes = {{"point id", std::vector<float>{1, 2}}, {"class", std::vector<std::uint8_t>{0, 255}}};
  write_cloud(folder.file("a.ply"), cloud);
  EXPECT_EQ(test::bytes_of_file(folder.file("a.ply")).find("face"), std::string::npos);
  const Cloud back = read_cloud(folder.file("a.ply"));
  EXPECT_NEAR(back.origin[0] + back.positions[0].x, 1e6 + 0.001, 1e-7);
  EXPECT_EQ(back.normals, cloud.normals) << "lengths are confidences and stay";
  EXPECT_EQ(back.attributes[0].name, "point_id");
  EXPECT_EQ(back.attributes[1].values, cloud.attributes[1].values);
}

TEST(MeshFiles, AreTheSameBytesForAnyNumberOfThreads) {
  Mesh mesh;
  mesh.origin = {1e6, 0, 0};
  constexpr std::int32_t kVertices = 50'000;
  for (std::int32_t v = 0; v < kVertices; ++v) mesh.vertices.push_back({float(v) * 0.1f, float(v % 100), 1});
  for (std::int32_t t = 0; t + 2 < kVertices; ++t) mesh.triangles.push_back({t, t + 1, t + 2});
  const test::TemporaryFolder folder;
  ReadOptions one;
  one.threads = 1;
  ReadOptions four;
  four.threads = 4;
  for (const std::string name : {"a.ply", "a.obj", "a.stl"}) {
    write_mesh(folder.file("1" + name), mesh, 1);
    write_mesh(folder.file("4" + name), mesh, 4);
    EXPECT_EQ(test::bytes_of_file(folder.file("1" + name)), test::bytes_of_file(folder.file("4" + name))) << name;
    const Mesh a = read_mesh(folder.file("1" + name), one);
    const Mesh b = read_mesh(folder.file("1" + name), four);
    EXPECT_EQ(a.vertices, b.vertices) << name;
    EXPECT_EQ(a.triangles, b.triangles) << name;
    EXPECT_EQ(a.triangles.size(), mesh.triangles.size()) << name;
  }
}

TEST(MeshFiles, AreRefusedWhenTheMeshDoesNotFitTogether) {
  const test::TemporaryFolder folder;
  const auto story = [&](ErrorCode code, const Mesh& mesh, const char* name = "a.ply") {
    return story_of(code, [&] { write_mesh(folder.file(name), mesh); });
  };
  const Mesh good = far_tetrahedron();
  Mesh bad = good;
  bad.triangles[0] = {0, 1, 4};
  for (const char* name : {"a.ply", "a.obj", "a.stl", "a.off", "a.glb"})
    EXPECT_NE(story(ErrorCode::invalid_input, bad, name), "");
  bad = good;
  bad.normals.pop_back();
  EXPECT_NE(story(ErrorCode::usage, bad), "");
  bad = good;
  bad.attributes[0].values.resize(3);
  EXPECT_NE(story(ErrorCode::usage, bad), "");
  bad = good;
  bad.attributes[1].name = "nx";
  EXPECT_NE(story(ErrorCode::usage, bad), "");
  EXPECT_NE(story(ErrorCode::usage, good, "a.step"), "");
  EXPECT_NE(story(ErrorCode::usage, good, "noextension"), "");
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(MeshFiles, HoldNothingThatIsNotFinite) {
  const test::TemporaryFolder folder;
  constexpr float kNan = std::numeric_limits<float>::quiet_NaN();
  constexpr float kInfinity = std::numeric_limits<float>::infinity();
  const auto is_refused = [&](const Mesh& mesh) {
    return story_of(ErrorCode::invalid_input, [&] { write_mesh(folder.file("a.ply"), mesh); });
  };
  Mesh bad = far_tetrahedron();
  bad.vertices[2].y = kNan;
  EXPECT_NE(is_refused(bad).find("vertex 2"), std::string::npos);
  bad = far_tetrahedron();
  bad.normals[1].z = kInfinity;
  EXPECT_NE(is_refused(bad).find("normal of vertex 1"), std::string::npos);
  bad = far_tetrahedron();
  bad.origin.x = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(is_refused(bad).find("origin"), std::string::npos);
  Cloud cloud;
  cloud.positions = {{0, 0, 0}, {0, -kInfinity, 0}};
  EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { write_cloud(folder.file("a.ply"), cloud); }).find("point 1"),
            std::string::npos);
  EXPECT_EQ(folder.file_count(), 0u);
}

TEST(ObjReader, TakesEveryFormOfCornerRelativeIndicesAndPolygons) {
  const Mesh mesh =
      mesh_of("a.obj",
              "# made by a test\nmtllib a.mtl\no thing\nv 0 0 0\nv 1 0 0 1.0\nvt 0 0\nv 1 1 0\nf -3 -2 -1\n"
              "v 0 1 0\ns off\nf 1/1 2/1 3/1 4/1\nf 1//1 2//1 3//1\nf 1/1/1 3/1/1 4/1/1\nvn 0 0 1\n");
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 1, 2}, {0, 2, 3}, {0, 1, 2}, {0, 2, 3}}));
  EXPECT_TRUE(mesh.normals.empty()) << "one normal for four vertices";
}

TEST(ObjReader, TakesNormalsOnlyIfEveryCornerNamesThatOfItsVertex) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 2\nvn 0 0 1\nvn 0 1 0\n";
  EXPECT_EQ(mesh_of("a.obj", points + "f 1//1 2//2 3//3\n").normals,
            (std::vector<Vec3f>{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}}));
  EXPECT_TRUE(mesh_of("a.obj", points + "f 1//1 2//3 3//3\n").normals.empty());
}

TEST(ObjReader, RejectsGarbledLines) {
  const std::string points = "v 0 0 0\nv 1 0 0\nv 0 1 0\n";
  for (const char* line : {"f 1 2 4", "f 0 1 2", "f -4 1 2", "f 1 2 x", "f 1 2 99999999999999999999",
                           "f 1//1 2//1 3//1", "f 1 2 3/1/", "v 1 2", "v 1 2 nan", "v a b c"})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { mesh_of("a.obj", points + line + "\n"); }), "") << line;
  EXPECT_NE(story_of(ErrorCode::invalid_input, [] { mesh_of("a.obj", "hello\n"); }), "");
}

TEST(OffReader, TakesCountsOnEitherLineNormalsAndColours) {
  for (const char* head : {"OFF\n3 1 0\n", "OFF 3 1 0\n", "# note\nOFF # tail\n\n3 1\n"}) {
    const Mesh mesh = mesh_of("a.off", std::string(head) + "0 0 0\n1 0 0\n0 1 0\n3 0 1 2 255 0 0\n");
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}})) << head;
  }
  const Mesh mesh = mesh_of("a.off", "CNOFF\n2 0 0\n0 0 0 0 0 1 10 20 30 255\n1 0 0 0 1 0 0 0 0 255\n");
  EXPECT_EQ(mesh.normals, (std::vector<Vec3f>{{0, 0, 1}, {0, 1, 0}}));
  ASSERT_EQ(mesh.attributes.size(), 4u);
  EXPECT_EQ(mesh.attributes[3].name, "alpha");
  EXPECT_EQ(mesh.attributes[0].type(), AttributeType::uint8);
  EXPECT_EQ(mesh_of("a.off", "COFF\n1 0 0\n0 0 0 0.5 0 1\n").attributes[0].type(), AttributeType::float32);
}

TEST(OffReader, RejectsGarbledFiles) {
  for (const char* text : {"OFF\n", "OFF BINARY\n1 0 0\n", "4OFF\n1 0 0\n", "OFF\n-1 0 0\n", "OFF\n1000000000 0 0\n",
                           "OFF\n2 0 0\n1 2 3\n", "OFF\n1 1 0\n1 2 3\n3 0 0 1\n", "OFF\n1 1 0\n1 2 3\n4000000000 0\n",
                           "OFF\n1 1 0\n1 2 3\n3 0 0 -1\n", "OFF\n9007199254740992 9007199254740992 0\n1 2 3\n"})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { mesh_of("a.off", text); }), "") << text;
}

constexpr const char* kTextStl =
    "solid two\n facet normal 0 0 1\n  outer loop\n   vertex 0 0 0\n   vertex 1 0 0\n   vertex 0 1 0\n  endloop\n"
    " endfacet\n facet normal 0 0 1\n  outer loop\n   vertex 1 0 -0\n   vertex 1 1 0\n   vertex 0 1e0 0\n  endloop\n"
    " endfacet\nendsolid two\n";

TEST(StlReader, WeldsTheCornersOfText) {
  const Mesh mesh = mesh_of("a.stl", kTextStl);
  EXPECT_EQ(mesh.vertices, (std::vector<Vec3f>{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {1, 1, 0}}));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
}

std::string binary_stl(const std::string& title, std::uint32_t promised) {
  std::string bytes = title + std::string(80 - title.size(), ' ') + raw<std::uint32_t>(promised);
  for (const float value : {0, 0, 1, 0, 0, 0, 1, 0, 0, 0, 1, 0}) bytes += raw<float>(value);
  return bytes + raw<std::uint16_t>(0);
}

TEST(StlReader, TakesBinaryFilesThatClaimToBeText) {
  EXPECT_EQ(mesh_of("a.stl", binary_stl("solid but binary", 1)).triangles, (std::vector<Triangle>{{0, 1, 2}}));
}

TEST(StlReader, TakesFilesWithoutTriangles) {
  EXPECT_TRUE(mesh_of("a.stl", std::string(84, '\0')).vertices.empty());
  EXPECT_TRUE(mesh_of("a.stl", "solid empty\nendsolid empty\n").vertices.empty());
}

TEST(StlReader, RejectsMoreTrianglesThanTheFileHolds) {
  for (const std::uint32_t promised : {2u, 4294967295u})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { mesh_of("a.stl", binary_stl("", promised)); }), "");
  EXPECT_NE(story_of(ErrorCode::invalid_input, [] { mesh_of("a.stl", "short"); }), "");
  EXPECT_NE(story_of(ErrorCode::invalid_input, [] { mesh_of("a.stl", "solid x\nnonsense\nendsolid\n"); }), "");
}

TEST(MeshReaders, EndInAnAnswerOrAnErrorForEveryDamage) {
  ReadOptions options;
  options.threads = 1;
  const auto damage = [&](const char* name, const std::string& bytes) {
    ASSERT_FALSE(mesh_of(name, bytes).triangles.empty());
    EXPECT_NO_THROW(test::damage(bytes, [&](const std::string& b) { mesh_of(name, b, options); })) << name;
  };
  damage("a.stl", kTextStl);
  damage("a.stl", binary_stl("x", 1));
  damage("a.off", "CNOFF 3 1 0\n0 0 0 0 0 1 1 2 3\n1 0 0 0 0 1 1 2 3\n0 1 0 0 0 1 1 2 3\n3 0 1 2\n");
  damage("a.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\nvn 0 0 1\nvn 0 0 1\nvn 0 0 1\nf 1//1 2//2 3//3\nf -3 -2 -1\n");
}

TEST(MeshReaders, GiveNormalsUnitLengthAndLeaveZeroNormalsAlone) {
  const Mesh mesh = mesh_of("a.ply",
                            "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                            "property float z\nproperty float nx\nproperty float ny\nproperty float nz\nend_header\n"
                            "0 0 0 3 0 4\n0 0 0 0 0 0\n");
  EXPECT_EQ(mesh.normals, (std::vector<Vec3f>{{0.6f, 0, 0.8f}, {0, 0, 0}}));
}

TEST(MeshReaders, RefuseTextsOfPoints) {
  EXPECT_NE(story_of(ErrorCode::invalid_input, [] { mesh_of("a.xyz", "1 2 3\n"); }), "");
}

}  // namespace
}  // namespace pointskin
