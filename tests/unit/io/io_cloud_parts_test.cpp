// Clouds read in parts: the points, origin and attributes of read_cloud(), for any parts.
#include <gtest/gtest.h>

#include <sys/stat.h>

#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>

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
#include "io/cloud_parts.hpp"
#include "io/npy.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using io::CloudParts;

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), sizeof(T) * a.size()) == 0);
}

Cloud read_in_parts(CloudParts& parts, std::int64_t rows, int threads, const std::optional<Vec3d>& shift) {
  exec::Cpu ex(threads);
  parts.choose_origin(ex, shift);
  Cloud all;
  CloudParts::Bytes buffer;
  for (std::int64_t first = 0; first < parts.rows(); first += rows) {
    Cloud some = parts.read(ex, first, std::min(rows, parts.rows() - first), buffer);
    EXPECT_LE(some.size() + some.dropped, rows);
    if (first == 0)
      all = std::move(some);
    else
      merge_into(all, std::move(some));
  }
  return all;
}

/// Reads `path` as a whole and in parts of several sizes.
void expect_the_same(const std::string& path, const std::optional<Vec3d>& shift = std::nullopt) {
  const Cloud whole = read_cloud(path, {.shift = shift});
  const std::unique_ptr<CloudParts> parts = CloudParts::open(path);
  ASSERT_NE(parts, nullptr);
  for (const std::int64_t rows : {std::int64_t{7}, std::int64_t{1000}, parts->rows()}) {
    SCOPED_TRACE("parts of " + std::to_string(rows) + " rows");
    const Cloud cloud = read_in_parts(*parts, rows, rows == 7 ? 1 : 3, shift);
    EXPECT_EQ(cloud.origin, whole.origin);
    EXPECT_EQ(cloud.dropped, whole.dropped);
    EXPECT_TRUE(same_bytes(cloud.positions, whole.positions));
    EXPECT_TRUE(same_bytes(cloud.normals, whole.normals));
    ASSERT_EQ(cloud.attributes.size(), whole.attributes.size());
    for (std::size_t a = 0; a < cloud.attributes.size(); ++a) {
      EXPECT_EQ(cloud.attributes[a].name, whole.attributes[a].name);
      EXPECT_EQ(cloud.attributes[a].values, whole.attributes[a].values);
    }
  }
}

constexpr int kRows = 5000;

/// Rows of another element, then points around (1e6, 2e6, 0) with normals and two attributes; some are not finite.
std::string ply_of_points(bool big_endian, bool wide) {
  const std::string real = wide ? "property double " : "property float ";
  std::string bytes = std::string("ply\nformat binary_") + (big_endian ? "big" : "little") +
                      "_endian 1.0\nelement camera 3\nproperty short id\nelement vertex " + std::to_string(kRows) +
                      "\n";
  for (const char* name : {"x", "y", "z"}) bytes += real + name + "\n";
  bytes += "property uchar red\nproperty float nx\nproperty float ny\nproperty float nz\nproperty ushort mark\n";
  bytes += "element face 0\nproperty list uchar int vertex_indices\nend_header\n";
  for (int i = 0; i < 3; ++i) bytes += raw<std::int16_t>(static_cast<std::int16_t>(i), big_endian);
  Random random(7);
  for (int row = 0; row < kRows; ++row) {
    double place[] = {1e6 + static_cast<double>(random.below(1000)) / 64,
                      2e6 + static_cast<double>(random.below(1000)) / 64, static_cast<double>(random.below(1000)) / 64};
    if (row % 1000 == 3) place[row % 3] = std::numeric_limits<double>::quiet_NaN();
    for (const double p : place)
      bytes += wide ? raw<double>(p, big_endian) : raw<float>(static_cast<float>(p), big_endian);
    bytes += raw<std::uint8_t>(static_cast<std::uint8_t>(row), big_endian);
    for (int axis = 0; axis < 3; ++axis) bytes += raw<float>(static_cast<float>(row % (axis + 2)), big_endian);
    bytes += raw<std::uint16_t>(static_cast<std::uint16_t>(row), big_endian);
  }
  return bytes;
}

TEST(CloudParts, AreTheWholeForEveryEncodingOfPly) {
  const TemporaryFolder folder;
  for (const bool big_endian : {false, true})
    for (const bool wide : {false, true}) {
      SCOPED_TRACE(std::string(big_endian ? "big" : "little") + (wide ? " double" : " float"));
      const std::string path = folder.file("points.ply");
      make_file(path, ply_of_points(big_endian, wide));
      expect_the_same(path);
      expect_the_same(path, Vec3d{1e6, 2e6, -3});
      EXPECT_GT(read_cloud(path).dropped, 0);
    }
}

TEST(CloudParts, ComeOneAfterTheOther) {
  const TemporaryFolder folder;
  const std::string path = folder.file("points.npy");
  constexpr std::int64_t kCount = 1'000'000;  // 12 MB: several parts
  std::string values;
  for (std::int64_t i = 0; i < 3 * kCount; ++i) values += raw<float>(static_cast<float>(i));
  make_file(path, io::npy_header(AttributeType::float32, kCount, 3) + values);
  const std::unique_ptr<CloudParts> parts = CloudParts::open(path);
  ASSERT_NE(parts, nullptr);
  exec::Cpu ex(2);
  parts->choose_origin(ex, std::nullopt);
  std::vector<Vec3f> all;
  int calls = 0;
  parts->for_parts(ex, [&](const Cloud& cloud) {
    ++calls;
    all.insert(all.end(), cloud.positions.begin(), cloud.positions.end());
  });
  EXPECT_GE(calls, 3);
  EXPECT_TRUE(same_bytes(all, read_cloud(path).positions));
}

TEST(CloudParts, ReadColumnsThatLieApart) {
  const TemporaryFolder folder;
  std::string values;
  for (int column = 0; column < 6; ++column)
    for (int row = 0; row < kRows; ++row) values += raw<double>(column < 3 ? 1e7 + row * (column + 1) : row % 2);
  std::string header = io::npy_header(AttributeType::float64, kRows, 6);
  const std::size_t order = header.find("False");
  ASSERT_NE(order, std::string::npos);
  header.replace(order, 5, "True ");  // Fortran's order
  make_file(folder.file("columns.npy"), header + values);
  expect_the_same(folder.file("columns.npy"));
  make_file(folder.file("rows.npy"), io::npy_header(AttributeType::float64, kRows, 6) + values);
  expect_the_same(folder.file("rows.npy"));
}

TEST(CloudParts, ChooseTheOriginFromAllPointsButFewStrays) {
  const TemporaryFolder folder;
  std::string values;
  for (int row = 0; row < kRows; ++row)
    for (int axis = 0; axis < 3; ++axis) values += raw<double>(row == 4321 ? -4e9 : 5e6 + 0.01 * row + axis);
  make_file(folder.file("strays.npy"), io::npy_header(AttributeType::float64, kRows, 3) + values);
  expect_the_same(folder.file("strays.npy"));
  EXPECT_GT(read_cloud(folder.file("strays.npy")).origin.x, 4e6);
}

TEST(CloudParts, OfNoPointsAreNone) {
  const TemporaryFolder folder;
  make_file(folder.file("none.npy"), io::npy_header(AttributeType::float32, 0, 3));
  const std::unique_ptr<CloudParts> parts = CloudParts::open(folder.file("none.npy"));
  ASSERT_NE(parts, nullptr);
  EXPECT_EQ(parts->rows(), 0);
  EXPECT_EQ(read_in_parts(*parts, 10, 1, std::nullopt).size(), 0);
}

TEST(CloudParts, RefuseWhatDoesNotLieInRows) {
  const TemporaryFolder folder;
  const std::string binary = ply_of_points(false, false);
  const auto is_refused = [&](const std::string& name, const std::string& bytes) {
    make_file(folder.file(name), bytes);
    return CloudParts::open(folder.file(name)) == nullptr;
  };
  EXPECT_TRUE(is_refused("text.ply",
                         "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
                         "property float z\nend_header\n1 2 3\n"));
  EXPECT_TRUE(is_refused("text.xyz", "1 2 3\n4 5 6\n"));
  std::string lists =
      "ply\nformat binary_little_endian 1.0\nelement vertex 1\nproperty float x\nproperty float y\n"
      "property float z\nproperty list uchar uchar tags\nend_header\n";
  EXPECT_TRUE(is_refused("lists.ply", lists + std::string(13, '\0')));
  // Whole numbers in 0..255 beside positions are colours, which become bytes: no values of the file any more.
  std::string values;
  for (int row = 0; row < 10; ++row)
    for (int column = 0; column < 6; ++column) values += raw<float>(column < 3 ? row : 20 * row);
  EXPECT_TRUE(is_refused("colours.npy", io::npy_header(AttributeType::float32, 10, 6) + values));
  ASSERT_EQ(::mkfifo(folder.file("pipe.ply").c_str(), 0600), 0);
  EXPECT_EQ(CloudParts::open(folder.file("pipe.ply")), nullptr);
  EXPECT_EQ(CloudParts::open("-"), nullptr);
}

TEST(CloudParts, ThatAreGarbledOrCutSayWhy) {
  const TemporaryFolder folder;
  const std::string bytes = ply_of_points(false, false), path = folder.file("cut.ply");
  make_file(path, bytes.substr(0, bytes.size() - 5));
  EXPECT_THROW(CloudParts::open(path), Error);
  make_file(path, bytes);
  const std::unique_ptr<CloudParts> parts = CloudParts::open(path);
  ASSERT_NE(parts, nullptr);
  exec::Cpu ex(2);
  CloudParts::Bytes buffer;
  parts->choose_origin(ex, std::nullopt);
  std::filesystem::resize_file(path, bytes.size() - 100);
  EXPECT_EQ(parts->read(ex, 10, 20, buffer).size(), 20);
  const auto code_of = [&](const auto& call) -> std::optional<ErrorCode> {
    try {
      call();
    } catch (const Error& error) {
      return error.code();
    }
    return std::nullopt;
  };
  EXPECT_EQ(code_of([&] { parts->read(ex, kRows - 20, 20, buffer); }), ErrorCode::invalid_input);
  EXPECT_EQ(code_of([&] { parts->choose_origin(ex, std::nullopt); }), ErrorCode::invalid_input);
  const double not_finite = std::numeric_limits<double>::infinity();
  EXPECT_EQ(code_of([&] { parts->choose_origin(ex, Vec3d{0, not_finite, 0}); }), ErrorCode::usage);
}

}  // namespace
}  // namespace pointskin::test
