#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>
#include <limits>
#include <variant>

#include "support/io_files.hpp"

namespace pointskin {
namespace {

using test::cloud_of;
using test::mesh_of;
using test::raw;
using test::story_of;

enum class Encoding { ascii, little, big };

/// Puts single values down in the three encodings.
class Body {
 public:
  explicit Body(Encoding encoding) : encoding_(encoding) {}
  template <class T>
  Body& add(std::type_identity_t<T> value) {
    if (encoding_ == Encoding::ascii)
      bytes_ += std::to_string(value) + " ";
    else
      bytes_ += raw<T>(value, encoding_ == Encoding::big);
    return *this;
  }
  Body& end_row() {
    if (encoding_ == Encoding::ascii) bytes_ += "\n";
    return *this;
  }
  [[nodiscard]] std::string with_header(const std::string& elements) const {
    constexpr const char* kNames[] = {"ascii", "binary_little_endian", "binary_big_endian"};
    return std::string("ply\nformat ") + kNames[static_cast<int>(encoding_)] + " 1.0\n" + elements + "end_header\n" +
           bytes_;
  }

 private:
  Encoding encoding_;
  std::string bytes_;
};

class PlyReaderIn : public testing::TestWithParam<Encoding> {};
INSTANTIATE_TEST_SUITE_P(AllEncodings, PlyReaderIn, testing::Values(Encoding::ascii, Encoding::little, Encoding::big));

template <class T>
std::string file_with_one_type(Encoding encoding, const std::string& type) {
  Body body(encoding);
  for (int row = 0; row < 3; ++row) {
    for (const int value : {row, 10 + row, 20 + row, 100 + row}) body.add<T>(static_cast<T>(value));
    body.end_row();
  }
  const std::string p = "property " + type + " ";
  return body.with_header("element vertex 3\n" + p + "x\n" + p + "y\n" + p + "z\n" + p + "mark\n");
}

void expect_rows_0_to_2(const Cloud& cloud, AttributeType type) {
  ASSERT_EQ(cloud.size(), 3);
  ASSERT_EQ(cloud.attributes.size(), 1u);
  EXPECT_EQ(cloud.attributes[0].name, "mark");
  EXPECT_EQ(cloud.attributes[0].type(), type);
  for (int row = 0; row < 3; ++row) {
    const auto i = static_cast<std::size_t>(row);
    EXPECT_EQ(cloud.positions[i], (Vec3f{float(row), float(10 + row), float(20 + row)}));
    EXPECT_EQ(cloud.attributes[0].values.at(i), float(100 + row));
  }
}

TEST_P(PlyReaderIn, ReadsEveryPropertyTypeUnderBothOfItsNames) {
  const auto check = [&](auto tag, AttributeType type, std::initializer_list<const char*> names) {
    for (const char* name : names) {
      SCOPED_TRACE(name);
      expect_rows_0_to_2(cloud_of("a.ply", file_with_one_type<decltype(tag)>(GetParam(), name)), type);
    }
  };
  check(std::int8_t{}, AttributeType::int8, {"char", "int8"});
  check(std::uint8_t{}, AttributeType::uint8, {"uchar", "uint8"});
  check(std::int16_t{}, AttributeType::int16, {"short", "int16"});
  check(std::uint16_t{}, AttributeType::uint16, {"ushort", "uint16"});
  check(std::int32_t{}, AttributeType::int32, {"int", "int32"});
  check(std::uint32_t{}, AttributeType::uint32, {"uint", "uint32"});
  check(float{}, AttributeType::float32, {"float", "float32"});
  check(double{}, AttributeType::float64, {"double", "float64"});
}

TEST_P(PlyReaderIn, FindsTheVerticesBetweenOtherElementsAndLists) {
  Body body(GetParam());
  body.add<std::uint8_t>(2).add<std::int16_t>(7).add<std::int16_t>(8).add<float>(9).end_row();  // camera 0
  body.add<std::uint8_t>(0).add<float>(9).end_row();                                            // camera 1
  for (int row = 0; row < 2; ++row) {  // vertex: z, list of uints, x, y
    body.add<double>(30 + row).add<std::int32_t>(row);
    for (int i = 0; i < row; ++i) body.add<std::uint32_t>(99);
    body.add<double>(10 + row).add<double>(20 + row).end_row();
  }
  body.add<float>(5).end_row();  // tail
  const Cloud cloud = cloud_of("a.ply", body.with_header("comment made by a test\nobj_info none\n"
                                                         "element camera 2\nproperty list uchar short ids\n"
                                                         "property float focus\nelement vertex 2\nproperty double z\n"
                                                         "property list int uint seen\nproperty double x\n"
                                                         "property double y\nelement tail 1\nproperty float t\n"));
  ASSERT_EQ(cloud.size(), 2);
  EXPECT_EQ(cloud.positions[0], (Vec3f{10, 20, 30}));
  EXPECT_EQ(cloud.positions[1], (Vec3f{11, 21, 31}));
  EXPECT_TRUE(cloud.attributes.empty());
}

constexpr const char* kNormalsAndColours =
    "property float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float nz\n"
    "property uchar red\nproperty uchar green\nproperty uchar blue\nproperty float confidence\n";

TEST_P(PlyReaderIn, GivesNormalsColoursAndScalarsTheirPlaces) {
  Body body(GetParam());
  body.add<float>(1).add<float>(2).add<float>(3).add<float>(0).add<float>(-1).add<float>(0);
  body.add<std::uint8_t>(255).add<std::uint8_t>(128).add<std::uint8_t>(0).add<float>(0.5f).end_row();
  const Cloud cloud = cloud_of("a.ply", body.with_header(std::string("element vertex 1\n") + kNormalsAndColours));
  ASSERT_TRUE(cloud.has_normals());
  EXPECT_EQ(cloud.normals[0], (Vec3f{0, -1, 0}));
  ASSERT_EQ(cloud.attributes.size(), 4u);
  EXPECT_EQ(cloud.attributes[0].name, "red");
  EXPECT_EQ(cloud.attributes[0].type(), AttributeType::uint8);
  EXPECT_EQ(cloud.attributes[0].values.at(0), 255);
  EXPECT_EQ(cloud.attributes[3].name, "confidence");
  EXPECT_EQ(cloud.attributes[3].type(), AttributeType::float32);
  EXPECT_EQ(cloud.attributes[3].values.at(0), 0.5f);
}

TEST_P(PlyReaderIn, DropsAndCountsPointsThatAreNotFiniteAndZeroesSuchNormals) {
  const float nan = std::numeric_limits<float>::quiet_NaN();
  const float inf = std::numeric_limits<float>::infinity();
  Body body(GetParam());
  body.add<float>(nan).add<float>(0).add<float>(0).add<float>(0).add<float>(0).add<float>(1).end_row();
  body.add<float>(1).add<float>(2).add<float>(3).add<float>(nan).add<float>(0).add<float>(1).end_row();
  body.add<float>(0).add<float>(-inf).add<float>(0).add<float>(0).add<float>(0).add<float>(1).end_row();
  body.add<float>(4).add<float>(5).add<float>(6).add<float>(0).add<float>(0).add<float>(1).end_row();
  const Cloud cloud = cloud_of("a.ply", body.with_header("element vertex 4\nproperty float x\nproperty float y\n"
                                                         "property float z\nproperty float normal_x\n"
                                                         "property float normal_y\nproperty float normal_z\n"));
  EXPECT_EQ(cloud.dropped, 2);
  ASSERT_EQ(cloud.size(), 2);
  EXPECT_EQ(cloud.positions[1], (Vec3f{4, 5, 6}));
  EXPECT_EQ(cloud.normals[0], (Vec3f{0, 0, 0}));
  EXPECT_EQ(cloud.normals[1], (Vec3f{0, 0, 1}));
}

constexpr const char* kXyz = "property float x\nproperty float y\nproperty float z\n";

TEST_P(PlyReaderIn, ReturnsAnEmptyCloudWhenNoPointIsFinite) {
  Body body(GetParam());
  body.add<float>(NAN).add<float>(0).add<float>(0).end_row();
  const Cloud cloud = cloud_of("a.ply", body.with_header(std::string("element vertex 1\n") + kXyz));
  EXPECT_EQ(cloud.size(), 0);
  EXPECT_EQ(cloud.dropped, 1);
}

/// Four vertices and faces with the given corners.
template <class Index>
std::string mesh_file(Encoding encoding, const std::vector<std::vector<int>>& faces, const std::string& list) {
  Body body(encoding);
  for (int v = 0; v < 4; ++v) body.add<float>(v).add<float>(v * v).add<float>(0).end_row();
  for (const auto& face : faces) {
    body.add<std::uint8_t>(static_cast<int>(face.size()));
    for (const int corner : face) body.add<Index>(static_cast<Index>(corner));
    body.add<float>(0.5f).end_row();
  }
  return body.with_header(std::string("element vertex 4\n") + kXyz + "element face " + std::to_string(faces.size()) +
                          "\nproperty list uchar " + list + "\nproperty float quality\n");
}

TEST_P(PlyReaderIn, ReadsTrianglesUnderBothNamesOfTheList) {
  for (const char* name : {"vertex_indices", "vertex_index"}) {
    const Mesh mesh =
        mesh_of("a.ply", mesh_file<std::int32_t>(GetParam(), {{0, 1, 2}, {2, 1, 3}}, std::string("int ") + name));
    EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {2, 1, 3}}));
    EXPECT_EQ(mesh.vertices[2], (Vec3f{2, 4, 0}));
  }
}

TEST_P(PlyReaderIn, FansPolygonsAndLeavesOutFacesWithoutArea) {
  const Mesh mesh = mesh_of(
      "a.ply", mesh_file<std::uint16_t>(GetParam(), {{0, 1, 2, 3}, {0, 1}, {}, {3, 2, 0}}, "ushort vertex_indices"));
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {3, 2, 0}}));
}

TEST_P(PlyReaderIn, RejectsVertexIndicesOutOfRange) {
  for (const int index : {4, -1}) {
    for (const auto& faces : {std::vector<std::vector<int>>{{0, 1, index}}, {{0, 1, 2, index}}}) {
      const std::string bytes = mesh_file<std::int32_t>(GetParam(), faces, "int vertex_indices");
      EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { mesh_of("a.ply", bytes); }), "") << index;
      EXPECT_EQ(cloud_of("a.ply", bytes).size(), 4) << "a cloud has no use for the faces";
    }
  }
}

TEST_P(PlyReaderIn, RejectsAMeshVertexThatIsNotFinite) {
  Body body(GetParam());
  body.add<float>(0).add<float>(NAN).add<float>(0).end_row();
  const std::string bytes = body.with_header(std::string("element vertex 1\n") + kXyz);
  EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { mesh_of("a.ply", bytes); }).find("vertex 0"), std::string::npos);
}

TEST_P(PlyReaderIn, EndsInAnAnswerOrAnErrorForEveryDamage) {
  Body body(GetParam());
  body.add<float>(1).add<float>(2).add<float>(3).add<float>(0).add<float>(0).add<float>(1);
  body.add<std::uint8_t>(1).add<std::uint8_t>(2).add<std::uint8_t>(3).add<float>(0.5f).end_row();
  body.add<std::uint8_t>(3).add<std::int32_t>(0).add<std::int32_t>(0).add<std::int32_t>(0).end_row();
  body.add<std::uint8_t>(4).add<std::int32_t>(0).add<std::int32_t>(0).add<std::int32_t>(0).add<std::int32_t>(0);
  const std::string bytes = body.end_row().with_header(std::string("element vertex 1\n") + kNormalsAndColours +
                                                       "element face 2\nproperty list uchar int vertex_indices\n");
  ASSERT_EQ(mesh_of("a.ply", bytes).triangles.size(), 3u);
  ReadOptions options;
  options.threads = 1;
  EXPECT_NO_THROW(test::damage(bytes, [&](const std::string& b) { cloud_of("a.ply", b, options); }));
  EXPECT_NO_THROW(test::damage(bytes, [&](const std::string& b) { mesh_of("a.ply", b, options); }));
}

TEST_P(PlyReaderIn, RejectsEveryTruncationOfABinaryMeshAlsoWhenReadAsACloud) {
  if (GetParam() == Encoding::ascii) GTEST_SKIP() << "a number without its last digit is a number";
  const std::string bytes = mesh_file<std::int32_t>(GetParam(), {{0, 1, 2}, {0, 1, 2, 3}}, "int vertex_indices");
  for (std::size_t length = 0; length < bytes.size(); ++length) {
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { mesh_of("a.ply", bytes.substr(0, length)); }), "") << length;
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.ply", bytes.substr(0, length)); }), "") << length;
  }
}

TEST_P(PlyReaderIn, GivesTheSameCloudForAnyNumberOfThreads) {
  Body body(GetParam());
  constexpr int kRows = 40'000;
  for (int row = 0; row < kRows; ++row) {
    body.add<double>(1e6 + row * 0.25).add<double>(row % 7 == 3 ? NAN : 5e6).add<double>(row % 100).end_row();
  }
  const std::string bytes = body.with_header("element vertex " + std::to_string(kRows) +
                                             "\nproperty double x\nproperty double y\nproperty double z\n");
  ReadOptions one;
  one.threads = 1;
  ReadOptions four;
  four.threads = 4;
  const Cloud a = cloud_of("a.ply", bytes, one);
  const Cloud b = cloud_of("a.ply", bytes, four);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.origin, b.origin);
  EXPECT_EQ(a.dropped, 5714);  // rows 3, 10, ..., 39994: 1 + 39991 / 7
  EXPECT_EQ(b.dropped, a.dropped);
}

/// Text is read as double whatever type the header names: only binary floats have lost their digits already.
TEST(PlyReader, KeepsTheMillimetresOfTextDeclaredFloat) {
  const Cloud cloud = cloud_of("a.ply",
                               "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\n"
                               "property float z\nend_header\n1000000.003 5 5\n1000000.007 5 5.001\n");
  ASSERT_EQ(cloud.size(), 2);
  EXPECT_NEAR(cloud.origin[0] + static_cast<double>(cloud.positions[0].x), 1000000.003, 1e-6);
  EXPECT_NEAR(cloud.origin[0] + static_cast<double>(cloud.positions[1].x), 1000000.007, 1e-6);
}

TEST_P(PlyReaderIn, KeepsTheMillimetresOfSurveyCoordinates) {
  Body body(GetParam());
  const std::vector<Vec3d> world{{500000.001, 4649776.002, 12.003}, {500010.004, 4649786.005, 13.006}};
  for (const Vec3d& p : world) body.add<double>(p[0]).add<double>(p[1]).add<double>(p[2]).end_row();
  const Cloud cloud = cloud_of("a.ply", body.with_header("element vertex 2\nproperty double x\nproperty double y\n"
                                                         "property double z\n"));
  EXPECT_EQ(cloud.origin, (Vec3d{500005, 4649781, 13}));  // whole-number centre of the box
  for (std::size_t i = 0; i < 2; ++i) {
    EXPECT_NEAR(cloud.origin[0] + cloud.positions[i].x, world[i][0], 1e-5);
    EXPECT_NEAR(cloud.origin[1] + cloud.positions[i].y, world[i][1], 1e-5);
    EXPECT_NEAR(cloud.origin[2] + cloud.positions[i].z, world[i][2], 1e-5);
  }
}

TEST(PlyReader, LeavesFloatsOfOnePlaceWhereTheyAreAndTakesAGivenShift) {
  Body body(Encoding::little);
  body.add<float>(500000.5f).add<float>(8).add<float>(9).end_row();
  const std::string bytes = body.with_header(std::string("element vertex 1\n") + kXyz);
  EXPECT_EQ(cloud_of("a.ply", bytes).origin, (Vec3d{0, 0, 0}));
  ReadOptions options;
  options.shift = Vec3d{500000, 8, 0};
  const Cloud cloud = cloud_of("a.ply", bytes, options);
  EXPECT_EQ(cloud.origin, (Vec3d{500000, 8, 0}));
  EXPECT_EQ(cloud.positions[0], (Vec3f{0.5f, 0, 9}));
  options.shift = Vec3d{NAN, 0, 0};
  EXPECT_NE(story_of(ErrorCode::usage, [&] { cloud_of("a.ply", bytes, options); }), "");
}

TEST(PlyReader, LeavesDoublesWhereTheyAreIfTheExtentIsMoreThanAThousandthOfTheMagnitude) {
  const auto origin_of = [](double far) {
    Body body(Encoding::little);
    body.add<double>(0).add<double>(far).add<double>(0).end_row();
    body.add<double>(1).add<double>(far).add<double>(0).end_row();
    return cloud_of("a.ply", body.with_header("element vertex 2\nproperty double x\nproperty double y\n"
                                              "property double z\n"))
        .origin;
  };
  EXPECT_EQ(origin_of(999), (Vec3d{0, 0, 0}));
  EXPECT_EQ(origin_of(1000), (Vec3d{1, 1000, 0}));  // round(0.5) = 1
}

TEST(PlyReader, RejectsAHeaderThatPromisesMoreVerticesThanTheFileHolds) {
  for (const char* count : {"1000000000000", "9223372036854775807", "2"}) {
    for (const Encoding encoding : {Encoding::ascii, Encoding::little}) {
      Body body(encoding);
      body.add<float>(1).add<float>(2).add<float>(3).end_row();
      const std::string bytes = body.with_header(std::string("element vertex ") + count + "\n" + kXyz);
      const std::string story = story_of(ErrorCode::invalid_input, [&] { cloud_of("a.ply", bytes); });
      EXPECT_NE(story.find("a.ply: is truncated"), std::string::npos) << count << " " << story;
    }
  }
}

TEST(PlyReader, RejectsAListThatPromisesMoreThanTheFileHolds) {
  for (const std::uint32_t length : {4000000000u, 2147483648u, 4u}) {
    Body body(Encoding::little);
    body.add<float>(1).add<float>(2).add<float>(3).add<std::uint32_t>(length).add<std::int32_t>(0);
    const std::string bytes = body.with_header(std::string("element vertex 1\n") + kXyz +
                                               "element face 1\nproperty list uint int vertex_indices\n");
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { mesh_of("a.ply", bytes); }), "") << length;
  }
}

TEST(PlyReader, RejectsGarbledHeadersWithTheirLine) {
  const std::string ok = "ply\nformat ascii 1.0\n";
  const std::vector<std::string> garbled{
      "ply\nformat ascii 2.0\nend_header\n",
      "ply\nformat text 1.0\nend_header\n",
      "ply\nelement vertex 0\nend_header\n",
      ok + "element vertex -1\nend_header\n",
      ok + "element vertex 99999999999999999999\nend_header\n",
      ok + "element vertex 1.5\nend_header\n",
      ok + "element vertex\nend_header\n",
      ok + "property float x\nend_header\n",
      ok + "element vertex 0\nproperty real x\nend_header\n",
      ok + "element vertex 0\nproperty float\nend_header\n",
      ok + "element vertex 0\nproperty list float int x\nend_header\n",
      ok + "element vertex 0\nproperty float x\nproperty int x\nend_header\n",
      ok + "element vertex 0\nelement vertex 0\nend_header\n",
      ok + "elephant vertex 0\nend_header\n",
  };
  for (const std::string& bytes : garbled)
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.ply", bytes); }).find(", line "), std::string::npos)
        << bytes;
}

TEST(PlyReader, RejectsFilesWithoutCoordinates) {
  const std::string ok = "ply\nformat ascii 1.0\n";
  for (const std::string& bytes : {std::string("ply"), std::string("ply\n"), ok, ok + "end_header\n",
                                   ok + "element vertex 0\nproperty float x\nproperty float y\nend_header\n",
                                   ok + "element vertex 1000000000000\nend_header\n", std::string("plywood\n")})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.ply", bytes); }), "") << bytes;
}

TEST(PlyReader, TakesWindowsLineEndsBlankLinesAndASignInText) {
  const std::string bytes =
      "ply\r\nformat ascii 1.0\r\nelement vertex 2\r\nproperty float x\r\nproperty float y\r\nproperty float z\r\n"
      "end_header\r\n+1.5 -2 1e-5\r\n\r\n4 5 6";
  const Cloud cloud = cloud_of("a.ply", bytes);
  EXPECT_EQ(cloud.positions, (std::vector<Vec3f>{{1.5f, -2, 1e-5f}, {4, 5, 6}}));
}

TEST(PlyReader, RejectsTextRowsOfTheWrongLengthWithTheirLine) {
  const std::string header = std::string("ply\nformat ascii 1.0\nelement vertex 2\n") + kXyz + "end_header\n";
  for (const char* rows : {"1 2 3\n4 5\n7 8 9\n", "1 2 3\n4 5 6 7\n", "1 2 3\n4 5 six\n", "1 2 3\n4 5 6z\n"}) {
    const std::string story = story_of(ErrorCode::invalid_input, [&] { cloud_of("a.ply", header + rows); });
    EXPECT_NE(story.find(", line 9;"), std::string::npos) << story;
  }
}

TEST(PlyReader, RejectsTextBytesOutOfTheirRange) {
  const std::string header =
      std::string("ply\nformat ascii 1.0\nelement vertex 1\n") + kXyz + "property uchar red\nend_header\n";
  EXPECT_EQ(cloud_of("a.ply", header + "1 2 3 255\n").attributes[0].values.at(0), 255);
  for (const char* row : {"1 2 3 256\n", "1 2 3 -1\n", "1 2 3 0.5\n", "1 2 3 nan\n"})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.ply", header + row); }), "") << row;
}

TEST(PlyReader, RecognisesPlyByItsContentWhateverTheName) {
  Body body(Encoding::little);
  body.add<float>(1).add<float>(2).add<float>(3);
  EXPECT_EQ(cloud_of("cloud.xyz", body.with_header(std::string("element vertex 1\n") + kXyz)).size(), 1);
}

TEST(PlyReader, ReadsOrRejectsEveryCloudOfTheSharedFolder) {
  const std::filesystem::path folder = POINTSKIN_SOURCE_DIR "/../shared/data";
  if (!std::filesystem::exists(folder)) GTEST_SKIP() << "the folder shared/data is absent";
  for (const auto& entry : std::filesystem::directory_iterator(folder)) {
    if (entry.path().extension() != ".ply") continue;
    SCOPED_TRACE(entry.path().string());
    const std::string path = entry.path().string();
    if (entry.path().filename() == "corrupt_pond.ply") {
      EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { read_cloud(path); }), "");
      continue;
    }
    EXPECT_GT(read_cloud(path).size(), 0);
    if (path.find("_gt.ply") != std::string::npos) {
      EXPECT_GT(read_mesh(path).triangles.size(), 0u);
    }
  }
}

}  // namespace
}  // namespace pointskin
