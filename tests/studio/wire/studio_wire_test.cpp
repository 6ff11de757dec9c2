// Meshes and points as bytes: what a page reads is what was written, to within half a step.
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <filesystem>
#include <iostream>

#include <gtest/gtest.h>

#include "studio/wire/blob_reader.hpp"
#include "studio/wire/wire.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using studio::wire::encode_mesh;
using studio::wire::encode_points;
using studio::wire::even_order;
using studio::wire::PointSet;
using test::BlobReader;

/// A torus far from the origin, with colours and a number a vertex.
Mesh coloured_torus() {
  Mesh mesh = Reconstructor().reconstruct(test::torus_cloud(20'000, 7), {.depth = 6});
  mesh.origin = {500'000, -4'000'000, 30};
  const std::size_t n = mesh.vertices.size();
  for (const char* name : {"red", "green", "blue"}) {
    std::vector<std::uint8_t> values(n);
    for (std::size_t i = 0; i < n; ++i) values[i] = static_cast<std::uint8_t>(i * (name[0] == 'r' ? 3 : 5));
    mesh.attributes.push_back({name, values});
  }
  return mesh;
}

/// All arrays that a mesh can have.
studio::wire::MeshCoding everything(const Mesh& mesh, bool compressed) {
  studio::wire::MeshCoding coding{.compressed = compressed};
  const std::size_t n = mesh.vertices.size();
  coding.values.push_back({"density", std::vector<float>(n)});
  coding.tint.resize(n);
  for (std::size_t i = 0; i < n; ++i) {
    coding.values[0].values[i] = 0.25F * static_cast<float>(i);
    coding.tint[i] = static_cast<std::uint8_t>(i % 3);
  }
  return coding;
}

/// The corners of a triangle, the smallest first, in the same sense.
std::array<std::uint32_t, 3> turned(const std::array<std::uint32_t, 3>& t) {
  std::array<std::uint32_t, 3> out = t;
  std::rotate(out.begin(), std::min_element(out.begin(), out.end()), out.end());
  return out;
}

double degrees_between(const Vec3d& a, const Vec3d& b) {
  const Vec3d c = cross(a, b);
  return std::atan2(std::sqrt(squared_length(c)), dot(a, b)) * 180 / 3.14159265358979323846;
}

/// The largest distance of a coordinate from where it was, in steps of its axis.
double worst_step(const std::vector<Vec3f>& before, const Vec3d& origin, const BlobReader& blob) {
  const std::vector<Vec3d> after = blob.positions();
  const Vec3d step = (blob.upper() - blob.lower()) / 65535;
  double worst = 0;
  for (std::size_t i = 0; i < before.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      worst = std::max(worst, std::abs(after[i][axis] - origin[axis] - double{before[i][axis]}) / step[axis]);
  return worst;
}

class StudioWireCodings : public testing::TestWithParam<bool> {};

TEST_P(StudioWireCodings, AMeshComesBackToWithinHalfAStep) {
  const Mesh mesh = coloured_torus();
  const BlobReader blob(encode_mesh(mesh, everything(mesh, GetParam())));
  EXPECT_EQ(blob.header().at("kind"), "mesh");
  ASSERT_EQ(blob.header().at("vertices"), mesh.vertices.size());
  ASSERT_EQ(blob.header().at("triangles"), mesh.triangles.size());
  ASSERT_EQ(blob.positions().size(), mesh.vertices.size());
  EXPECT_LE(worst_step(mesh.vertices, mesh.origin, blob), 0.51);  // 0.5, and float's rounding of the step
  const std::vector<Vec3d> normals = blob.normals();
  ASSERT_EQ(normals.size(), mesh.normals.size());
  for (std::size_t i = 0; i < normals.size(); ++i) {
    const Vec3f& n = mesh.normals[i];
    ASSERT_LE(degrees_between(normals[i], {double{n.x}, double{n.y}, double{n.z}}), 1.2) << i;
  }
}

TEST_P(StudioWireCodings, TrianglesKeepTheirOrderAndTheirSense) {
  const Mesh mesh = coloured_torus();
  const BlobReader blob(encode_mesh(mesh, {.compressed = GetParam()}));
  const auto triangles = blob.numbers<std::array<std::uint32_t, 3>>("triangles");
  ASSERT_EQ(triangles.size(), mesh.triangles.size());
  for (std::size_t i = 0; i < triangles.size(); ++i) {
    std::array<std::uint32_t, 3> before{};
    for (std::size_t k = 0; k < 3; ++k) before[k] = static_cast<std::uint32_t>(mesh.triangles[i][k]);
    ASSERT_EQ(turned(triangles[i]), turned(before)) << i;
  }
}

TEST_P(StudioWireCodings, ColoursNumbersAndTintsComeBackAsTheyWere) {
  const Mesh mesh = coloured_torus();
  const auto coding = everything(mesh, GetParam());
  const BlobReader blob(encode_mesh(mesh, coding));
  EXPECT_EQ(blob.numbers<float>("values:density"), coding.values[0].values);
  EXPECT_EQ(blob.numbers<std::uint8_t>("tint"), coding.tint);
  const auto colours = blob.numbers<std::array<std::uint8_t, 4>>("colors");
  ASSERT_EQ(colours.size(), mesh.vertices.size());
  for (std::size_t i = 0; i < colours.size(); ++i) {
    const std::array<std::uint8_t, 4> expected = {static_cast<std::uint8_t>(i * 3), static_cast<std::uint8_t>(i * 5),
                                                  static_cast<std::uint8_t>(i * 5), 255};
    ASSERT_EQ(colours[i], expected) << i;
  }
}

INSTANTIATE_TEST_SUITE_P(Codings, StudioWireCodings, testing::Bool(),
                         [](const auto& info) { return info.param ? "compressed" : "raw"; });

TEST(StudioWire, CompressingLaterGivesTheSameBytes) {
  const Mesh mesh = coloured_torus();
  const std::vector<std::byte> raw = encode_mesh(mesh, everything(mesh, false));
  const std::vector<std::byte> packed = encode_mesh(mesh, everything(mesh, true));
  EXPECT_EQ(studio::wire::compressed(raw), packed);
  EXPECT_LT(packed.size(), raw.size() / 2);
}

TEST(StudioWire, ALargeMeshIsEncodedInPartsWithoutASeam) {
  Mesh mesh;
  test::Random random(3);
  for (int i = 0; i < 600'000; ++i) {
    const Vec3d d = random.direction();
    mesh.vertices.push_back({static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)});
    mesh.triangles.push_back({i, (i + 1) % 600'000, (i + 2) % 600'000});
  }
  mesh.normals = mesh.vertices;
  const std::vector<std::byte> bytes = encode_mesh(mesh, {});
  EXPECT_EQ(encode_mesh(mesh, {}), bytes);
  const BlobReader blob(bytes);
  EXPECT_LE(worst_step(mesh.vertices, mesh.origin, blob), 0.51);
  const auto triangles = blob.numbers<std::int32_t>("triangles");
  EXPECT_EQ(0, std::memcmp(triangles.data(), mesh.triangles.data(), 3 * sizeof(std::int32_t) * mesh.triangles.size()));
}

TEST(StudioWire, EveryDirectionIsWithin1Point2Degrees) {
  test::Random random(3);
  PointSet points;
  for (int i = 0; i < 100'000; ++i) {
    const Vec3d d = random.direction();
    points.normals.push_back({static_cast<float>(d.x), static_cast<float>(d.y), static_cast<float>(d.z)});
  }
  for (const Vec3f axis : {Vec3f{1, 0, 0}, Vec3f{0, 1, 0}, Vec3f{0, 0, 1}})
    points.normals.insert(points.normals.end(), {axis, -axis});
  points.positions.resize(points.normals.size());
  const std::vector<Vec3d> after = BlobReader(encode_points(points, {{}, {}}, false)).normals();
  double worst = 0;
  for (std::size_t i = 0; i < after.size(); ++i) {
    const Vec3f& n = points.normals[i];
    worst = std::max(worst, degrees_between(after[i], {double{n.x}, double{n.y}, double{n.z}}));
  }
  EXPECT_LE(worst, 1.2);
  for (std::size_t i = 100'000; i < after.size(); ++i) EXPECT_NEAR(dot(after[i], after[i]), 1, 1e-12);
  std::cout << "worst direction: " << worst << " degrees\n";
}

TEST(StudioWire, EmptyAndFlatMeshesAreEncoded) {
  for (const bool compressed : {false, true}) {
    const BlobReader empty(encode_mesh({}, {.compressed = compressed}));
    EXPECT_EQ(empty.header().at("vertices"), 0);
    EXPECT_TRUE(empty.bytes("triangles").empty());
    Mesh flat;
    flat.vertices = {{0, 0, 5}, {1, 0, 5}, {0, 1, 5}};
    flat.triangles = {{0, 1, 2}};
    const BlobReader blob(encode_mesh(flat, {.compressed = compressed}));
    EXPECT_EQ(blob.positions()[1], (Vec3d{1, 0, 5}));
    EXPECT_FALSE(blob.has("normals"));
  }
}

TEST(StudioWire, NumbersOfAnotherShapeAreRefused) {
  const Mesh mesh = coloured_torus();
  studio::wire::MeshCoding coding = everything(mesh, false);
  coding.values[0].values.pop_back();
  EXPECT_THROW((void)encode_mesh(mesh, coding), Error);
  coding = everything(mesh, false);
  coding.tint.push_back(0);
  EXPECT_THROW((void)encode_mesh(mesh, coding), Error);
}

TEST(StudioWire, PartsOfACloudLieInOneBox) {
  const Cloud cloud = test::sphere_cloud(5'000, 11);
  const Bounds box = bounds_of(cloud.positions);
  for (std::ptrdiff_t from = 0; from < 5'000; from += 1'000) {
    PointSet part{cloud.origin, {cloud.positions.begin() + from, cloud.positions.begin() + from + 1'000}, {}, {}, {}};
    const BlobReader blob(encode_points(part, box, true));
    EXPECT_EQ(blob.header().at("kind"), "points");
    EXPECT_NEAR(blob.lower().x, cloud.origin.x + double{box.lower.x}, 1e-12);
    EXPECT_LE(worst_step(part.positions, cloud.origin, blob), 0.51);
  }
}

/// Points of a beginning in each of the 8 octants of the cloud's cube, at most and at least.
std::pair<int, int> crowd(const std::vector<Vec3f>& positions, const std::vector<std::int64_t>& order,
                          std::size_t count) {
  std::array<int, 8> octants{};
  for (std::size_t i = 0; i < count; ++i) {
    const Vec3f& p = positions[static_cast<std::size_t>(order[i])];
    ++octants[static_cast<std::size_t>((p.x > 0 ? 1 : 0) + (p.y > 0 ? 2 : 0) + (p.z > 0 ? 4 : 0))];
  }
  return {*std::min_element(octants.begin(), octants.end()), *std::max_element(octants.begin(), octants.end())};
}

TEST(StudioWire, EveryBeginningOfTheOrderIsAnEvenChoice) {
  const Cloud cloud = test::sphere_cloud(40'000, 5);
  const std::vector<std::int64_t> order = even_order(cloud.positions);
  std::vector<std::int64_t> sorted = order;
  std::sort(sorted.begin(), sorted.end());
  for (std::size_t i = 0; i < sorted.size(); ++i) ASSERT_EQ(sorted[i], static_cast<std::int64_t>(i));
  for (const std::size_t count : {64U, 500U, 2'000U, 10'000U}) {
    const auto [fewest, most] = crowd(cloud.positions, order, count);
    EXPECT_GE(fewest, 0.6 * static_cast<double>(count) / 8) << count;
    EXPECT_LE(most, 1.4 * static_cast<double>(count) / 8) << count;
  }
}

TEST(StudioWire, TheOrderDoesNotDependOnThatOfTheFile) {
  Cloud cloud = test::sphere_cloud(10'000, 5);
  const auto in_order = [](const std::vector<Vec3f>& positions) {
    std::vector<Vec3f> out;
    for (const std::int64_t i : even_order(positions)) out.push_back(positions[static_cast<std::size_t>(i)]);
    return out;
  };
  const std::vector<Vec3f> before = in_order(cloud.positions);
  std::reverse(cloud.positions.begin(), cloud.positions.end());
  EXPECT_EQ(in_order(cloud.positions), before);
}

TEST(StudioWire, AScanOf368000TrianglesTakesLessThan2Point7MegabytesCoded) {
  const auto file = std::filesystem::path(POINTSKIN_SOURCE_DIR) / "../shared/data/bunny_scans.ply";
  if (!std::filesystem::exists(file)) GTEST_SKIP() << file << " is not there";
  const Mesh mesh = Reconstructor().reconstruct(read_cloud(file.string()), {.depth = 8});
  const std::vector<std::byte> raw = encode_mesh(mesh, {});
  const std::vector<std::byte> packed = studio::wire::compressed(raw);
  const BlobReader blob(packed);
  std::cout << mesh.triangles.size() << " triangles: " << raw.size() << " bytes raw, " << packed.size() << " coded";
  for (const char* name : {"positions", "normals", "triangles"})
    std::cout << ", " << name << " " << blob.section(name).at("bytes");
  std::cout << "\n";
  EXPECT_GT(mesh.triangles.size(), 365'000U);
  EXPECT_LE(packed.size(), 2'700'000U);
}

}  // namespace
}  // namespace pointskin
