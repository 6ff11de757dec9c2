// A mesh measured from its file in parts has the numbers of the mesh in memory, however little memory there is.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/scale.hpp>

#include <algorithm>
#include <cstdint>
#include <functional>
#include <limits>
#include <numeric>
#include <random>
#include <string>
#include <utility>
#include <vector>

#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

void expect_same(const MeshReport& a, const MeshReport& b) {
  EXPECT_EQ(a.vertices, b.vertices);
  EXPECT_EQ(a.used_vertices, b.used_vertices);
  EXPECT_EQ(a.triangles, b.triangles);
  EXPECT_EQ(a.edges, b.edges);
  EXPECT_EQ(a.boundary_edges, b.boundary_edges);
  EXPECT_EQ(a.non_manifold_edges, b.non_manifold_edges);
  EXPECT_EQ(a.misoriented_edges, b.misoriented_edges);
  EXPECT_EQ(a.non_manifold_vertices, b.non_manifold_vertices);
  EXPECT_EQ(a.degenerate_triangles, b.degenerate_triangles);
  EXPECT_EQ(a.components, b.components);
  EXPECT_EQ(a.euler, b.euler);
  EXPECT_EQ(a.volume, b.volume);  // every bit
  EXPECT_EQ(a.area, b.area);
}

/// The message of the error that `work` throws, with its code.
std::pair<ErrorCode, std::string> thrown_by(const std::function<void()>& work) {
  try {
    work();
  } catch (const Error& error) {
    return {error.code(), error.what()};
  }
  ADD_FAILURE() << "no error";
  return {};
}

/// The number before " bytes".
std::int64_t number_in(const std::string& text) {
  const std::size_t at = text.find(" bytes");
  const std::size_t begin = text.rfind(' ', at - 1) + 1;
  return std::stoll(text.substr(begin, at - begin));
}

/// The least memory in which the file can be measured in parts, as the errors tell it.
std::int64_t least_memory(const std::string& path) {
  std::int64_t memory = 1;
  for (int i = 0; i < 4; ++i) {
    try {
      measure_file(path, {.max_memory_bytes = memory, .threads = 1});
      return memory;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::over_limit);
      const std::int64_t said = number_in(error.what());
      EXPECT_GT(said, memory) << error.what();
      memory = said;
    }
  }
  ADD_FAILURE() << "what errors told was never enough";
  return memory;
}

/// Vertices and triangles in random order.
Mesh scattered(const Mesh& mesh) {
  std::mt19937 random(5);
  std::vector<std::int32_t> place(mesh.vertices.size());
  std::iota(place.begin(), place.end(), 0);
  std::shuffle(place.begin(), place.end(), random);
  Mesh out = mesh;
  for (std::size_t i = 0; i < place.size(); ++i) out.vertices[static_cast<std::size_t>(place[i])] = mesh.vertices[i];
  for (Triangle& t : out.triangles)
    for (std::int32_t& v : t) v = place[static_cast<std::size_t>(v)];
  std::shuffle(out.triangles.begin(), out.triangles.end(), random);
  return out;
}

/// Everything that can be wrong with a mesh, more than once, near and far in the file.
Mesh spoilt(Mesh mesh) {
  test::append(mesh, test::moebius_mesh(50));
  test::append(mesh, test::patch_mesh(20));
  const std::size_t n = mesh.triangles.size();
  for (const std::size_t t : {std::size_t{0}, n / 3, n - 7}) {
    mesh.triangles.push_back(mesh.triangles[t]);                    // an edge with three triangles
    std::swap(mesh.triangles[t + 1][0], mesh.triangles[t + 1][1]);  // turned
    mesh.triangles[t + 2][1] = mesh.triangles[t + 2][0];            // degenerate
    mesh.triangles[t + 3][2] = mesh.triangles[(t + n / 2) % n][0];  // fans that share a vertex
    mesh.triangles.push_back({mesh.triangles[t][0], mesh.triangles[t][0], mesh.triangles[t][0]});
    mesh.vertices.push_back({1, 2, static_cast<float>(1000 + t)});  // used by none
  }
  return mesh;
}

std::vector<std::pair<std::string, Mesh>> meshes() {
  const Mesh sphere = test::icosphere_mesh(6);
  const Mesh torus = test::torus_mesh(300, 120);
  Mesh far = sphere;
  far.origin = {4e6, -5e5, 100};
  Mesh two = sphere;
  test::append(two, test::translated(torus, {30, 0, 0}));
  return {{"sphere", sphere},
          {"torus", torus},
          {"two", two},
          {"far", far},
          {"inside out", test::flipped(sphere)},
          {"scattered", scattered(two)},
          {"spoilt", spoilt(two)},
          {"spoilt and scattered", scattered(spoilt(two))}};
}

TEST(MeasureFile, IsMeasureForAnyMemoryAndThreads) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("mesh.ply");
  for (const auto& [name, mesh] : meshes()) {
    SCOPED_TRACE(name);
    write_mesh(path, mesh);
    const MeshReport whole = measure(read_mesh(path));
    expect_same(measure_file(path), whole);
    const std::int64_t least = least_memory(path);
    EXPECT_LT(least, 24 * (whole.vertices + whole.triangles)) << "less than the mesh as a whole takes";
    for (const std::int64_t memory : {least, least + 100'000, 2 * least, 4 * least, std::int64_t{1} << 40})
      for (const int threads : {1, 3}) {
        SCOPED_TRACE(std::to_string(memory) + " bytes, threads " + std::to_string(threads));
        expect_same(measure_file(path, {.max_memory_bytes = memory, .threads = threads}), whole);
      }
  }
}

TEST(MeasureFile, ReadsEveryKindOfRow) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("mesh.ply");
  const Mesh sphere = test::icosphere_mesh(6);
  for (const bool big_endian : {false, true})
    for (const bool wide : {false, true}) {
      std::string bytes = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") + "_endian 1.0\n" +
                          "element camera 2\nproperty float focus\nelement face " +
                          std::to_string(sphere.triangles.size()) + "\nproperty short label\nproperty list " +
                          (wide ? "int uint" : "uchar ushort") + " vertex_index\nproperty uchar red\nelement vertex " +
                          std::to_string(sphere.vertices.size()) + "\nproperty uchar red\n";
      for (const char* axis : {"x", "y", "z"})
        bytes += std::string("property ") + (wide ? "double " : "float ") + axis + "\n";
      bytes += "end_header\n" + test::raw<float>(1, big_endian) + test::raw<float>(2, big_endian);
      for (const Triangle& t : sphere.triangles) {
        bytes += test::raw<std::int16_t>(-3, big_endian);
        bytes += wide ? test::raw<std::int32_t>(3, big_endian) : test::raw<std::uint8_t>(3, big_endian);
        for (const std::int32_t v : t)
          bytes += wide ? test::raw<std::uint32_t>(static_cast<std::uint32_t>(v), big_endian)
                        : test::raw<std::uint16_t>(static_cast<std::uint16_t>(v), big_endian);
        bytes += '\7';
      }
      for (const Vec3f& p : sphere.vertices) {
        bytes += '\1';
        for (const float c : {p.x, p.y, p.z})
          bytes += wide ? test::raw<double>(1e7 + double{c}, big_endian) : test::raw<float>(c, big_endian);
      }
      test::make_file(path, bytes);
      const Mesh mesh = read_mesh(path);
      EXPECT_EQ(mesh.origin.x != 0, wide);
      expect_same(measure_file(path, {.max_memory_bytes = least_memory(path)}), measure(mesh));
    }
}

TEST(MeasureFile, ComplainsAsTheReaderDoes) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("mesh.ply");
  const Mesh sphere = test::icosphere_mesh(6);
  write_mesh(path, sphere);
  const std::int64_t memory = least_memory(path) + 100'000;
  const std::string whole = test::bytes_of_file(path);
  const std::size_t header = whole.find("end_header\n") + 11;
  const std::size_t faces = whole.size() - 13 * sphere.triangles.size();
  const std::size_t vertex = header + (faces - header) / sphere.vertices.size() * 9000;
  const std::size_t faces_middle = faces + 13 * (sphere.triangles.size() / 2);
  const auto with = [&](std::size_t at, const std::string& bytes) {
    return whole.substr(0, at) + bytes + whole.substr(at + bytes.size());
  };
  for (const std::string& bytes :
       {with(faces_middle + 1, test::raw<std::int32_t>(static_cast<std::int32_t>(sphere.vertices.size()))),
        with(faces_middle + 5, test::raw<std::int32_t>(-1)),
        with(vertex + 4, test::raw<float>(std::numeric_limits<float>::infinity())),
        with(vertex + 4, test::raw<float>(std::numeric_limits<float>::quiet_NaN())), whole.substr(0, whole.size() - 1),
        whole.substr(0, faces + 100), std::string("ply\nformat"), std::string()}) {
    test::make_file(path, bytes);
    const auto expected = thrown_by([&] { measure(read_mesh(path)); });
    EXPECT_EQ(thrown_by([&] { measure_file(path, {.max_memory_bytes = 6 * memory}); }), expected);
    if (bytes.size() == whole.size()) {
      EXPECT_EQ(thrown_by([&] { measure_file(path, {.max_memory_bytes = memory}); }), expected);
    }
  }
}

TEST(MeasureFile, RefusesWhatItCannotReadInParts) {
  const test::TemporaryFolder folder;
  const Mesh sphere = test::icosphere_mesh(5);
  for (const char* name : {"mesh.obj", "mesh.stl", "text.ply"}) {
    SCOPED_TRACE(name);
    const std::string path = folder.file(name);
    write_mesh(path, sphere, {.ascii = true});
    const auto [code, text] = thrown_by([&] { measure_file(path, {.max_memory_bytes = 100'000}); });
    EXPECT_EQ(code, ErrorCode::over_limit);
    EXPECT_NE(text.find("convert"), std::string::npos) << text;
    expect_same(measure_file(path, {.max_memory_bytes = number_in(text)}), measure(read_mesh(path)));
  }
  // A quad whose length gives itself away when it is read.
  const std::string path = folder.file("quads.ply");
  write_mesh(path, test::icosphere_mesh(6));
  const std::string whole = test::bytes_of_file(path);
  const std::int64_t memory = least_memory(path);
  std::string bytes =
      whole.substr(0, whole.size() - 13) + '\4' + whole.substr(whole.size() - 12) + whole.substr(whole.size() - 4);
  test::make_file(path, bytes);
  EXPECT_EQ(thrown_by([&] { measure_file(path, {.max_memory_bytes = memory}); }).first, ErrorCode::over_limit);
  expect_same(measure_file(path), measure(read_mesh(path)));
  EXPECT_EQ(thrown_by([&] { measure_file(path, {.max_memory_bytes = -1}); }).first, ErrorCode::usage);
}

TEST(MeasureFile, TakesPointsAsTheReaderDoes) {
  const test::TemporaryFolder folder;
  const std::string path = folder.file("points.ply");
  test::make_file(path,
                  "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                  "property float z\nend_header\n" +
                      test::raw<float>(1) + test::raw<float>(2) + test::raw<float>(3));
  EXPECT_EQ(measure_file(path, {.max_memory_bytes = 1 << 20}).triangles, 0);
  EXPECT_EQ(measure_file(path, {.max_memory_bytes = 1 << 20}).vertices, 1);
}

}  // namespace
}  // namespace pointskin
