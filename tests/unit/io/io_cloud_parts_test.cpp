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
#include <type_traits>
#include <vector>

#include "exec/cpu.hpp"
#include "io/cloud_parts.hpp"
#include "io/npy.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using io::CloudParts;
using io::FileParts;

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && (a.empty() || std::memcmp(a.data(), b.data(), sizeof(T) * a.size()) == 0);
}

/// NaN where the other has it, too.
bool same_values(const AttributeValues& a, const AttributeValues& b) {
  return a.type() == b.type() && a.mask() == b.mask() && a.visit([&](const auto& values) {
    using T = typename std::decay_t<decltype(values)>::value_type;
    return same_bytes(values, b.as<T>());
  });
}

std::unique_ptr<CloudParts> open_parts(const std::string& path) {
  exec::Cpu ex(2);
  return CloudParts::open(ex, path);
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

/// Reads the files as a whole and in parts of several sizes.
void expect_the_same(const std::vector<std::string>& paths, const std::optional<Vec3d>& shift = std::nullopt) {
  Cloud whole;
  for (const std::string& path : paths) merge_into(whole, read_cloud(path, {.shift = shift}));
  exec::Cpu ex(2);
  const std::unique_ptr<CloudParts> parts = CloudParts::open(ex, paths);
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
      EXPECT_TRUE(same_values(cloud.attributes[a].values, whole.attributes[a].values)) << cloud.attributes[a].name;
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
      expect_the_same({path});
      expect_the_same({path}, Vec3d{1e6, 2e6, -3});
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
  const std::unique_ptr<CloudParts> parts = open_parts(path);
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
  expect_the_same({folder.file("columns.npy")});
  make_file(folder.file("rows.npy"), io::npy_header(AttributeType::float64, kRows, 6) + values);
  expect_the_same({folder.file("rows.npy")});
}

TEST(CloudParts, ChooseTheOriginFromAllPointsButFewStrays) {
  const TemporaryFolder folder;
  std::string values;
  for (int row = 0; row < kRows; ++row)
    for (int axis = 0; axis < 3; ++axis) values += raw<double>(row == 4321 ? -4e9 : 5e6 + 0.01 * row + axis);
  make_file(folder.file("strays.npy"), io::npy_header(AttributeType::float64, kRows, 3) + values);
  expect_the_same({folder.file("strays.npy")});
  EXPECT_GT(read_cloud(folder.file("strays.npy")).origin.x, 4e6);
}

TEST(CloudParts, OfNoPointsAreNone) {
  const TemporaryFolder folder;
  make_file(folder.file("none.npy"), io::npy_header(AttributeType::float32, 0, 3));
  const std::unique_ptr<CloudParts> parts = open_parts(folder.file("none.npy"));
  ASSERT_NE(parts, nullptr);
  EXPECT_EQ(parts->rows(), 0);
  EXPECT_EQ(read_in_parts(*parts, 10, 1, std::nullopt).size(), 0);
}

TEST(CloudParts, OfNoPointsNeedCoordinatesAllTheSame) {
  const TemporaryFolder folder;
  make_file(folder.file("none.ply"),
            "ply\nformat ascii 1.0\nelement vertex 0\nproperty float x\nproperty float y\nend_header\n");
  exec::Cpu ex(1);
  const std::unique_ptr<CloudParts> parts = CloudParts::open(ex, folder.file("none.ply"));
  ASSERT_NE(parts, nullptr);
  EXPECT_THROW(parts->choose_origin(ex, std::nullopt), Error);
}

TEST(CloudParts, RefuseWhatDoesNotLieInRows) {
  const TemporaryFolder folder;
  const std::string binary = ply_of_points(false, false);
  const auto is_refused = [&](const std::string& name, const std::string& bytes) {
    make_file(folder.file(name), bytes);
    EXPECT_EQ(FileParts::can_open(folder.file(name)), open_parts(folder.file(name)) != nullptr);
    return !FileParts::can_open(folder.file(name));
  };
  EXPECT_TRUE(is_refused("corners.obj", "v 0 0 0\n"));
  EXPECT_TRUE(is_refused("points.json", "[[1, 2, 3]]"));
  EXPECT_TRUE(is_refused("floats.xyz", std::string(24, '\0')));
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
  EXPECT_EQ(open_parts(folder.file("pipe.ply")), nullptr);
  EXPECT_EQ(open_parts("-"), nullptr);
}

/// Lines of values: places around (1000, 0, 0), normals along an axis, and what `more` says of a row.
template <class More>
std::string lines_of_text(int rows, const More& more) {
  std::string text;
  for (int row = 0; row < rows; ++row) {
    text += std::to_string(1000 + 0.001 * (row % 977)) + " " + std::to_string(0.01 * (row % 31)) + " " +
            (row % 1000 == 999 ? "nan" : std::to_string(row % 53)) + more(row) + "\n";
    if (row % 700 == 5) text += "\n# a remark\n";
  }
  return text;
}

TEST(CloudParts, OfTextAreTheWhole) {
  const TemporaryFolder folder;
  const auto normal = [](int row) { return std::string(row % 2 == 0 ? " 0 0 1" : " 0 -0.5 0.25"); };
  const auto colour = [](int row) { return " " + std::to_string(row % 256) + " 7 0"; };
  const auto expect = [&](const std::string& name, const std::string& bytes) {
    SCOPED_TRACE(name);
    make_file(folder.file(name), bytes);
    EXPECT_TRUE(FileParts::can_open(folder.file(name)));
    expect_the_same({folder.file(name)});
    expect_the_same({folder.file(name)}, Vec3d{1000, 0, 0});
  };
  expect("places.xyz", lines_of_text(2000, [](int) { return ""; }));
  expect("scalar.xyz", lines_of_text(2000, [](int row) { return " " + std::to_string(row) + ".123456789012"; }));
  expect("normals.xyz", lines_of_text(20000, normal));  // several blocks
  expect("colours.xyz", lines_of_text(2000, colour));
  expect("scalar_and_colours.txt", lines_of_text(2000, [&](int row) { return " 0.5" + colour(row); }));
  expect("colours_first.asc", lines_of_text(2000, [&](int row) { return colour(row) + normal(row); }));
  expect("colours_last.asc", lines_of_text(2000, [&](int row) { return normal(row) + colour(row); }));
  expect("promised.pts", "2000\n" + lines_of_text(2000, normal));
  expect("marked", "\xEF\xBB\xBF" + lines_of_text(2000, normal));
  expect("named.csv", "X Y Z nx ny nz r g b class height weight\r\n" + lines_of_text(2000, [&](int row) {
                        return normal(row) + colour(row) + " " + std::to_string(row % 9) + " 1234567.25 0.1\r";
                      }));
  expect("labels.csv",
         "x y z label id\n" + lines_of_text(2000, [](int row) { return " 16777217 " + std::to_string(row) + ".5"; }));
  expect("far.xyz", lines_of_text(2000, [](int) { return ""; }) + "1e9 1e9 1e9\n");
}

TEST(CloudParts, OfPlyInTextAreTheWhole) {
  const TemporaryFolder folder;
  std::string text =
      "ply\nformat ascii 1.0\nelement camera 2\nproperty float at\nelement nothing 4\nelement vertex 3000\nproperty "
      "float x\n"
      "property double y\nproperty float z\nproperty list uchar int tags\nproperty uchar red\nproperty int label\n"
      "property double weight\nelement edge 1\nproperty list uchar int corners\nend_header\n1\n2\n";
  text += lines_of_text(3000, [](int row) {
    return std::string(row % 2 == 0 ? " 0" : " 2 5 6") + " " + std::to_string(row % 256) + " " + std::to_string(row) +
           " 0.1";
  });
  make_file(folder.file("text.ply"), text + "3 0 1 2\n");
  expect_the_same({folder.file("text.ply")});
  make_file(folder.file("cut.ply"), text);
  EXPECT_THROW(open_parts(folder.file("cut.ply")), Error);
  make_file(folder.file("none.ply"), text.substr(0, text.find("element vertex")) + "end_header\n1\n2\n");
  EXPECT_FALSE(FileParts::can_open(folder.file("none.ply")));
  // Vertices without normals take those of their faces.
  const std::string mesh = "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 0 0\n";
  const std::string start =
      "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n";
  make_file(folder.file("mesh.ply"), start + mesh);
  EXPECT_FALSE(FileParts::can_open(folder.file("mesh.ply")));
  make_file(folder.file("mesh.ply"), start + "property float nx\n" + mesh);
  EXPECT_TRUE(FileParts::can_open(folder.file("mesh.ply")));
}

TEST(CloudParts, OfSeveralFilesAreTheMergedWhole) {
  const TemporaryFolder folder;
  const auto write = [&](const char* name, int points, const Vec3d& at, bool has_normals) {
    Cloud cloud = sphere_cloud(points, static_cast<std::uint64_t>(points));
    cloud.origin = at;
    if (!has_normals) cloud.normals.clear();
    std::vector<float> heights(cloud.positions.size());
    for (std::size_t i = 0; i < heights.size(); ++i) heights[i] = 0.1F * static_cast<float>(i);
    cloud.attributes = {{"height", heights}, {name, std::vector<float>(heights.size(), 7)}};
    write_cloud(folder.file(name), cloud);
    return folder.file(name);
  };
  const std::string near = write("near.ply", 3000, {0, 0, 0}, true), far = write("far.ply", 5000, {4e6, -7e5, 3}, true),
                    farther = write("farther.ply", 20000, {4e6, -7.01e5, 300}, true),
                    bare = write("bare.ply", 100, {1, 2, 3}, false), none = folder.file("none.npy"),
                    text = folder.file("text.csv");
  make_file(none, io::npy_header(AttributeType::float32, 0, 3));
  make_file(text, "x y z nx ny nz height\n" + lines_of_text(5000, [](int) { return " 0 0 1 0.123456789"; }));
  expect_the_same({near, far});
  expect_the_same({far, near});
  expect_the_same({near, none, far, farther});
  expect_the_same({none, text, farther, far, near});
  expect_the_same({near, bare});
  expect_the_same({near, far, text}, Vec3d{1e6, 0, 0});
  exec::Cpu ex(1);
  EXPECT_TRUE(CloudParts::open(ex, {near, far})->integers_with_gaps(ex).empty());
  make_file(folder.file("marked.csv"), "x y z nx ny nz red\n0 0 0 0 0 1 200\n");
  EXPECT_EQ(CloudParts::open(ex, {near, folder.file("marked.csv")})->integers_with_gaps(ex),
            std::vector<std::string>{"red"});
  EXPECT_THROW(CloudParts::open(ex, std::vector<std::string>{}), Error);
}

TEST(CloudParts, OfGarbledTextNameTheLineAsTheWholeDoes) {
  const TemporaryFolder folder;
  const std::string path = folder.file("garbled.xyz");
  const auto message_of = [](const auto& call) -> std::string {
    try {
      call();
    } catch (const Error& error) {
      return error.what();
    }
    return "no error";
  };
  const std::string good = lines_of_text(20000, [](int) { return " 0 0 1"; });
  for (const std::string& bytes :
       {good + "1 2 3 4 5 x\n", good + "1 2 3\n", good + "1 2 3 4 5 6 7\n" + good, std::string("1 2 3 4 5\n"),
        "7\n" + good, std::string("x,y\n1,2\n"), std::string("# none\n")}) {
    make_file(path, bytes);
    const std::string whole = message_of([&] { (void)read_cloud(path); });
    EXPECT_NE(whole, "no error");
    EXPECT_EQ(message_of([&] { open_parts(path); }), whole);
  }
  make_file(path, good);
  const std::unique_ptr<CloudParts> parts = open_parts(path);
  std::filesystem::resize_file(path, good.size() / 2);
  exec::Cpu ex(2);
  EXPECT_NE(message_of([&] { parts->choose_origin(ex, std::nullopt); }).find("cut short"), std::string::npos);
}

TEST(CloudParts, ThatAreGarbledOrCutSayWhy) {
  const TemporaryFolder folder;
  const std::string bytes = ply_of_points(false, false), path = folder.file("cut.ply");
  make_file(path, bytes.substr(0, bytes.size() - 5));
  EXPECT_THROW(open_parts(path), Error);
  make_file(path, bytes);
  const std::unique_ptr<CloudParts> parts = open_parts(path);
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
