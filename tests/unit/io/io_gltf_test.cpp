// glTF: what is written is read back, scenes become one mesh where their nodes put it, and broken files are refused.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "io/libraries.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using nlohmann::json;
using test::story_of;

std::string glb_bytes(const Mesh& mesh) {
  const test::TemporaryFolder folder;
  write_mesh(folder.file("mesh.glb"), mesh);
  return test::bytes_of_file(folder.file("mesh.glb"));
}

/// A GLB of a document and a binary chunk.
std::string glb(json document, const std::string& binary) {
  document["asset"] = {{"version", "2.0"}};
  document["buffers"] = {{{"byteLength", binary.size()}}};
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes("glTF\2\0\0\0\0\0\0\0", 12);
  const auto add = [&bytes](std::uint32_t value) { bytes.append(reinterpret_cast<const char*>(&value), 4); };
  add(static_cast<std::uint32_t>(text.size()));
  bytes += "JSON" + text;
  add(static_cast<std::uint32_t>(binary.size()));
  bytes += std::string("BIN\0", 4) + binary;
  return bytes;
}

template <class T>
std::string raw(const std::vector<T>& values) {
  return {reinterpret_cast<const char*>(values.data()), values.size() * sizeof(T)};
}

/// Four corners of a square as floats, of which one primitive of `mode` is made without indices.
json square(int mode) {
  return {{"meshes", {{{"primitives", {{{"attributes", {{"POSITION", 0}}}, {"mode", mode}}}}}}},
          {"accessors", {{{"bufferView", 0}, {"componentType", 5126}, {"type", "VEC3"}, {"count", 4}}}},
          {"bufferViews", {{{"buffer", 0}, {"byteLength", 48}}}}};
}

const std::string kSquare = raw<float>({0, 0, 0, 1, 0, 0, 0, 1, 0, 1, 1, 0});

Mesh read(const std::string& bytes) { return test::mesh_of("a.glb", bytes); }

TEST(Gltf, AMeshIsReadBackWithAllThatItCarries) {
  Mesh mesh = test::box_mesh();
  const std::size_t n = mesh.vertices.size();
  mesh.origin = {431000.125, 5412345.5, 812};
  mesh.normals.assign(n, Vec3f{0, 0, 1});
  for (const char* name : {"red", "green", "blue", "alpha"})
    mesh.attributes.push_back(
        {name, std::vector<std::uint8_t>(n, static_cast<std::uint8_t>(mesh.attributes.size() * 40))});
  mesh.attributes.push_back({"density", std::vector<float>(n, 2.5F)});
  mesh.attributes.push_back({"class", std::vector<std::uint16_t>(n, 7)});
  mesh.attributes.push_back({"id", std::vector<std::int32_t>(n, -12)});
  const Mesh again = read(glb_bytes(mesh));
  EXPECT_EQ(again.triangles, mesh.triangles);
  EXPECT_EQ(again.normals, mesh.normals);
  for (std::size_t i = 0; i < n; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_EQ(again.origin[axis] + static_cast<double>(again.vertices[i][axis]),
                mesh.origin[axis] + static_cast<double>(mesh.vertices[i][axis]));
  ASSERT_EQ(again.attributes.size(), mesh.attributes.size());
  for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
    EXPECT_EQ(again.attributes[a].name, mesh.attributes[a].name);
    EXPECT_EQ(again.attributes[a].values.at(0), mesh.attributes[a].values.at(0)) << mesh.attributes[a].name;
  }
  EXPECT_EQ(again.attributes[5].type(), AttributeType::uint16);
  EXPECT_EQ(again.attributes[6].type(), AttributeType::float32) << "glTF has no 32-bit integers of applications";
}

TEST(Gltf, ACloudIsReadBack) {
  const test::TemporaryFolder folder;
  Cloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 2, 3}, {4, 5, 6}};
  cloud.normals = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  write_cloud(folder.file("cloud.glb"), cloud);
  EXPECT_FALSE(may_hold_faces(folder.file("cloud.glb")));
  const Cloud again = read_cloud(folder.file("cloud.glb"));
  EXPECT_EQ(again.positions, cloud.positions);
  EXPECT_EQ(again.normals, cloud.normals);
}

/// Waves over a square: long in x, with colours and a label.
Mesh wavy_mesh() {
  Mesh mesh;
  constexpr int kSide = 40;
  std::vector<std::uint8_t> red, green, blue;
  std::vector<std::uint16_t> label;
  for (int i = 0; i < kSide; ++i)
    for (int j = 0; j < kSide; ++j) {
      const double x = 0.3 * i, y = 0.1 * j;
      mesh.vertices.push_back(
          {static_cast<float>(x), static_cast<float>(y), static_cast<float>(0.2 * std::sin(x) * std::cos(y))});
      const double dx = -0.2 * std::cos(x) * std::cos(y), dy = 0.2 * std::sin(x) * std::sin(y);
      const double size = std::sqrt(dx * dx + dy * dy + 1);
      mesh.normals.push_back(
          {static_cast<float>(dx / size), static_cast<float>(dy / size), static_cast<float>(1 / size)});
      red.push_back(static_cast<std::uint8_t>(6 * i));
      green.push_back(static_cast<std::uint8_t>(6 * j));
      blue.push_back(77);
      label.push_back(static_cast<std::uint16_t>(1000 * (i / 8)));
      if (i == 0 || j == 0) continue;
      const std::int32_t here = kSide * i + j;
      mesh.triangles.push_back({here - kSide - 1, here - 1, here});
      mesh.triangles.push_back({here, here - kSide, here - kSide - 1});
    }
  mesh.attributes = {{"red", red}, {"green", green}, {"blue", blue}, {"label", label}};
  return mesh;
}

std::string compressed(const Mesh& mesh) {
  const test::TemporaryFolder folder;
  write_mesh(folder.file("mesh.glb"), mesh, {.compress = true});
  return test::bytes_of_file(folder.file("mesh.glb"));
}

/// The same file with something else in what its first view says of its coding.
std::string with_packing(const std::string& whole, const char* key, const json& value) {
  const std::uint32_t length = static_cast<unsigned char>(whole[12]) + 256U * static_cast<unsigned char>(whole[13]);
  json document = json::parse(whole.substr(20, length));
  document["bufferViews"][0]["extensions"]["EXT_meshopt_compression"][key] = value;
  std::string text = document.dump();
  text.resize((text.size() + 3) / 4 * 4, ' ');
  std::string bytes = whole.substr(0, 12);
  const auto size = static_cast<std::uint32_t>(text.size());
  bytes.append(reinterpret_cast<const char*>(&size), 4);
  return bytes + "JSON" + text + whole.substr(20 + length);
}

class CompressedGltf : public testing::Test {
  void SetUp() override {
    if (!io::kHasMeshoptimizer) GTEST_SKIP() << "this build has no meshoptimizer";
  }
};

TEST_F(CompressedGltf, AMeshIsReadBackWithinItsSteps) {
  Mesh mesh = wavy_mesh();
  mesh.origin = {431000.125, 5412345.5, 812};
  const std::string bytes = compressed(mesh);
  EXPECT_LT(4 * bytes.size(), glb_bytes(mesh).size());
  const Mesh again = read(bytes);
  const double step = 0.3 * 39 / 65535;
  ASSERT_EQ(again.vertices.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    double cosine = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      const double expected = mesh.origin[axis] + static_cast<double>(mesh.vertices[i][axis]);
      EXPECT_NEAR(again.origin[axis] + static_cast<double>(again.vertices[i][axis]), expected, 0.51 * step) << i;
      cosine += static_cast<double>(mesh.normals[i][axis]) * static_cast<double>(again.normals[i][axis]);
    }
    EXPECT_GT(cosine, std::cos(0.0015)) << i;
  }
  ASSERT_EQ(again.triangles.size(), mesh.triangles.size());
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    Triangle turned = again.triangles[t];
    for (int turn = 0; turn < 2 && turned != mesh.triangles[t]; ++turn) turned = {turned[1], turned[2], turned[0]};
    EXPECT_EQ(turned, mesh.triangles[t]) << "the order of triangles and their sides stay";
  }
  ASSERT_EQ(again.attributes.size(), mesh.attributes.size());
  for (std::size_t a = 0; a < mesh.attributes.size(); ++a) {
    EXPECT_EQ(again.attributes[a].name, mesh.attributes[a].name);
    EXPECT_EQ(again.attributes[a].values, mesh.attributes[a].values) << mesh.attributes[a].name;
  }
}

TEST_F(CompressedGltf, ACloudKeepsNormalsWithoutLength) {
  const test::TemporaryFolder folder;
  Cloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 2, 3}, {4, 5, 6}, {4, 5, 6}};
  cloud.normals = {{1, 0, 0}, {0, 0, 0}, {0, 0.6F, -0.8F}, {0, 0, 7}};
  write_cloud(folder.file("cloud.glb"), cloud, {.compress = true});
  const Cloud again = read_cloud(folder.file("cloud.glb"));
  ASSERT_EQ(again.size(), 4);
  EXPECT_EQ(again.normals[1], (Vec3f{0, 0, 0}));
  EXPECT_NEAR(again.normals[2].z, -0.8, 1e-4);
  EXPECT_EQ(again.normals[3], (Vec3f{0, 0, 1}));
  cloud.positions.resize(1);
  cloud.normals.resize(1);
  write_cloud(folder.file("cloud.glb"), cloud, {.compress = true});
  EXPECT_EQ(read_cloud(folder.file("cloud.glb")).positions, cloud.positions) << "a box without sides";
}

TEST_F(CompressedGltf, WhatCannotBeUnpackedIsRefused) {
  const std::string whole = compressed(wavy_mesh());
  EXPECT_NO_THROW(read(with_packing(whole, "filter", "NONE")));
  const std::vector<std::pair<const char*, json>> wrong = {{"count", 1599},      {"count", 1'000'000'000'000},
                                                           {"count", -1},        {"byteStride", 12},
                                                           {"byteStride", 0},    {"byteStride", 4096},
                                                           {"byteLength", 17},   {"byteOffset", 1'000'000},
                                                           {"buffer", 1},        {"mode", "TRIANGLES"},
                                                           {"mode", "UNKNOWN"},  {"filter", "QUATERNION "},
                                                           {"mode", 7},          {"count", "many"},
                                                           {"byteLength", 1e99}, {"buffer", 9}};
  for (const auto& [key, value] : wrong)
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&, k = key, v = value] { read(with_packing(whole, k, v)); }), "")
        << key << " " << value;
  for (std::size_t size = 0; size + 4 < whole.size(); size += 7)
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { read(whole.substr(0, size)); }), "") << size;
}

TEST_F(CompressedGltf, SurvivesDamage) {
  Mesh mesh = test::box_mesh();
  mesh.normals.assign(mesh.vertices.size(), Vec3f{0, 0, 1});
  test::damage(compressed(mesh), [](const std::string& bytes) { read(bytes); });
}

TEST(Gltf, ListsStripsAndFansBecomeTriangles) {
  EXPECT_EQ(read(glb(square(4), kSquare)).triangles, (std::vector<Triangle>{{0, 1, 2}}));
  EXPECT_EQ(read(glb(square(5), kSquare)).triangles, (std::vector<Triangle>{{0, 1, 2}, {1, 3, 2}}));
  EXPECT_EQ(read(glb(square(6), kSquare)).triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}}));
  EXPECT_TRUE(read(glb(square(0), kSquare)).triangles.empty());
}

TEST(Gltf, NodesPutMeshesWhereTheyBelong) {
  json document = square(4);
  document["scenes"] = {{{"nodes", {0}}}};
  document["nodes"] = {{{"translation", {10, 0, 0}}, {"children", {1, 2}}},
                       {{"mesh", 0}, {"rotation", {0, 0, 0.7071067811865476, 0.7071067811865476}}},
                       {{"mesh", 0}, {"scale", {-2, 1, 1}}}};
  const Mesh mesh = read(glb(document, kSquare));
  ASSERT_EQ(mesh.vertices.size(), 8U);
  const auto world = [&](std::size_t i) { return mesh.origin.x + static_cast<double>(mesh.vertices[i].x); };
  EXPECT_NEAR(world(1), 10, 1e-6) << "x turned to y";
  EXPECT_NEAR(world(2), 9, 1e-6) << "y turned to -x";
  EXPECT_NEAR(world(5), 8, 1e-6) << "mirrored and twice as wide";
  EXPECT_EQ(mesh.triangles[0], (Triangle{0, 1, 2}));
  EXPECT_EQ(mesh.triangles[1], (Triangle{4, 6, 5})) << "a mirrored triangle is turned round";
}

TEST(Gltf, IntegersStandForSharesAndSparseValuesReplace) {
  json document = square(0);
  document["accessors"][0] = {
      {"bufferView", 0}, {"componentType", 5122}, {"type", "VEC3"}, {"count", 2}, {"normalized", true}};
  document["bufferViews"][0] = {{"buffer", 0}, {"byteLength", 16}, {"byteStride", 8}};
  const std::string shorts = raw<std::int16_t>({32767, -32767, 0, 0, 0, 16384, -32768, 0});
  const Mesh mesh = read(glb(document, shorts));
  ASSERT_EQ(mesh.vertices.size(), 2U);
  EXPECT_EQ(mesh.vertices[0], (Vec3f{1, -1, 0}));
  EXPECT_EQ(mesh.vertices[1].z, -1) << "the lowest short, too";

  document = square(4);
  document["accessors"][0]["sparse"] = {
      {"count", 1}, {"indices", {{"bufferView", 1}, {"componentType", 5121}}}, {"values", {{"bufferView", 2}}}};
  document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 48}, {"byteLength", 1}});
  document["bufferViews"].push_back({{"buffer", 0}, {"byteOffset", 52}, {"byteLength", 12}});
  const std::string sparse = kSquare + std::string("\2\0\0\0", 4) + raw<float>({7, 8, 9});
  EXPECT_EQ(read(glb(document, sparse)).vertices[2], (Vec3f{7, 8, 9}));
}

TEST(Gltf, TextWithADataUriIsRead) {
  json document = square(4);
  document["asset"] = {{"version", "2.0"}};
  document["accessors"][0]["count"] = 1;
  document["bufferViews"][0]["byteLength"] = 12;
  document["buffers"] = {{{"byteLength", 12}, {"uri", "data:application/octet-stream;base64,AACAPwAAAEAAAEBA"}}};
  EXPECT_EQ(test::cloud_of("a.gltf", document.dump()).positions, (std::vector<Vec3f>{{1, 2, 3}}));
  for (const char* uri : {"../secret.bin", "/etc/passwd", "http://a/b.bin"}) {
    document["buffers"][0]["uri"] = uri;
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { test::cloud_of("a.gltf", document.dump()); }).find("own folder"),
              std::string::npos)
        << uri;
  }
}

TEST(Gltf, EveryTruncationIsRefused) {
  const std::string whole = glb_bytes(test::box_mesh());
  for (std::size_t size = 0; size + 1 < whole.size(); ++size)
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { read(whole.substr(0, size)); }), "") << size;
}

TEST(Gltf, WhatDoesNotFitTogetherIsRefusedBeforeMemoryIsTaken) {
  const auto refused = [](const json& document) {
    return !story_of(ErrorCode::invalid_input, [&] { read(glb(document, kSquare)); }).empty();
  };
  json document = square(4);
  document["accessors"][0]["count"] = 1'000'000'000'000;
  EXPECT_TRUE(refused(document)) << "more than the view holds";
  document["accessors"][0].erase("bufferView");
  EXPECT_TRUE(refused(document)) << "more zeros than such a file needs";
  document = square(4);
  document["bufferViews"][0]["byteOffset"] = -4;
  EXPECT_TRUE(refused(document));
  document = square(4);
  document["bufferViews"][0]["byteLength"] = 49;
  EXPECT_TRUE(refused(document));
  document = square(4);
  document["meshes"][0]["primitives"][0]["indices"] = 0;
  EXPECT_TRUE(refused(document)) << "floats are no indices";
  document = square(4);
  document["scenes"] = {{{"nodes", {0}}}};
  document["nodes"] = {{{"children", {0}}}};
  EXPECT_TRUE(refused(document)) << "a node in itself";
  document = square(4);
  document["extensionsRequired"] = {"KHR_draco_mesh_compression"};
  EXPECT_TRUE(refused(document));
  EXPECT_NE(story_of(ErrorCode::invalid_input, [] { read(glb({}, {})); }) + "x", "")
      << "an empty scene holds no points";
}

}  // namespace
}  // namespace pointskin
