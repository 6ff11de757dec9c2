// Attributes keep type and value, bit for bit, on their way through files.
#include <gtest/gtest.h>

#include <bit>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "support/attributes.hpp"
#include "support/io_files.hpp"

namespace pointskin {
namespace {

using enum AttributeType;
using test::cloud_of;
using test::mesh_of;
using test::raw;
using test::same_bytes;
using test::story_of;

/// Numbers that a wider or narrower type on the way would change, as many of each type.
template <class T>
std::vector<T> telling_values() {
  using Limits = std::numeric_limits<T>;
  if constexpr (std::is_same_v<T, double>)
    return {-0.0, 9007199254740993.0, 4e8 + 1e-6, Limits::max(), Limits::denorm_min(), 0.1};
  else if constexpr (std::is_same_v<T, float>)
    return {-0.0F, 16777217.0F, Limits::lowest(), Limits::max(), Limits::denorm_min(), 0.1F};
  else
    return {Limits::min(), Limits::max(), T{0}, T{1}, static_cast<T>(Limits::max() - 1), T{77}};
}

constexpr std::array kPlyTypes{int8, uint8, int16, uint16, int32, uint32, float32, float64};

const AttributeValues& named(const std::vector<Attribute>& attributes, const std::string& name) {
  for (const Attribute& a : attributes)
    if (a.name == name) return a.values;
  throw std::logic_error("there is no " + name);
}

Cloud cloud_with_all_types() {
  Cloud cloud;
  for (int i = 0; i < 6; ++i) cloud.positions.push_back({static_cast<float>(i), 0, 1});
  for (const AttributeType type : kPlyTypes)
    visit_type(type, [&](auto tag) { cloud.attributes.push_back({name_of(type), telling_values<decltype(tag)>()}); });
  return cloud;
}

void expect_same(const std::vector<Attribute>& a, const std::vector<Attribute>& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t i = 0; i < a.size(); ++i) {
    EXPECT_EQ(a[i].name, b[i].name);
    EXPECT_EQ(a[i].type(), b[i].type()) << a[i].name;
    EXPECT_TRUE(same_bytes(a[i].values, b[i].values)) << a[i].name;
  }
}

TEST(TypesOfPly, StayWithEveryBitFromCloudToFileAndBack) {
  const test::TemporaryFolder folder;
  const Cloud cloud = cloud_with_all_types();
  write_cloud(folder.file("a.ply"), cloud);
  const std::string header = test::bytes_of_file(folder.file("a.ply")).substr(0, 500);
  EXPECT_NE(header.find("property char int8\nproperty uchar uint8\nproperty short int16\nproperty ushort uint16\n"
                        "property int int32\nproperty uint uint32\nproperty float float32\nproperty double float64\n"),
            std::string::npos)
      << header;
  const Cloud back = read_cloud(folder.file("a.ply"));
  expect_same(cloud.attributes, back.attributes);
  Mesh mesh{{}, cloud.positions, {}, cloud.attributes, {{0, 1, 2}}};
  write_mesh(folder.file("m.ply"), mesh);
  expect_same(cloud.attributes, read_mesh(folder.file("m.ply")).attributes);
}

/// All values of `cloud` with 17 digits, or with their bytes.
std::string ply_in(const char* encoding, const Cloud& cloud) {
  std::string bytes = std::string("ply\nformat ") + encoding + " 1.0\nelement vertex 6\nproperty float x\n" +
                      "property float y\nproperty float z\n";
  for (const Attribute& a : cloud.attributes)
    bytes += std::string("property ") + name_of(a.type()) + " " + a.name + "\n";
  bytes += "end_header\n";
  const bool text = std::string(encoding) == "ascii";
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3f& p = cloud.positions[i];
    for (const float v : {p.x, p.y, p.z})
      bytes += text ? std::to_string(v) + " " : raw<float>(v, std::string(encoding) == "binary_big_endian");
    for (const Attribute& a : cloud.attributes) {
      char digits[400];
      std::snprintf(digits, sizeof digits, "%.17g ", a.values.at(i));
      a.values.visit([&](const auto& all) {
        using T = typename std::decay_t<decltype(all)>::value_type;
        bytes += text ? digits : raw<T>(all[i], std::string(encoding) == "binary_big_endian");
      });
    }
    if (text) bytes += "\n";
  }
  return bytes;
}

TEST(TypesOfPly, AreReadFromAllEncodings) {
  const Cloud cloud = cloud_with_all_types();
  for (const char* encoding : {"ascii", "binary_little_endian", "binary_big_endian"}) {
    SCOPED_TRACE(encoding);
    expect_same(cloud.attributes, cloud_of("a.ply", ply_in(encoding, cloud)).attributes);
  }
}

TEST(TypesOfPly, StayWhereRowsAreDropped) {
  Cloud cloud = cloud_with_all_types();
  cloud.positions[2].y = std::numeric_limits<float>::infinity();
  const Cloud back = cloud_of("a.ply", ply_in("binary_little_endian", cloud));
  EXPECT_EQ(back.dropped, 1);
  for (Attribute& a : cloud.attributes) a.values.keep_where({true, true, false, true, true, true});
  expect_same(cloud.attributes, back.attributes);
}

TEST(TypesOfPly, RejectTextThatTheyDoNotHold) {
  const std::pair<const char*, std::vector<std::string>> cases[] = {{"char", {"-129", "128"}},
                                                                    {"uchar", {"-1", "256", "nan"}},
                                                                    {"short", {"-32769", "32768"}},
                                                                    {"ushort", {"-1", "65536"}},
                                                                    {"int", {"-2147483649", "2147483648"}},
                                                                    {"uint", {"-1", "4294967296"}},
                                                                    {"int", {"0.5", "nan", "inf", "1e300"}}};
  for (const auto& [name, values] : cases)
    for (const std::string& value : values) {
      const std::string type = name;
      const std::string head =
          "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\nproperty ";
      const std::string story = story_of(ErrorCode::invalid_input, [&] {
        cloud_of("a.ply", head + type + " mark\nend_header\n1 2 3 " + value + "\n");
      });
      EXPECT_NE(story.find(value + "' does not fit into a property " + type), std::string::npos) << story;
    }
}

TEST(TypesOfPly, OfMissingLabelsAreFloatsAndMissingColoursAreBlack) {
  const test::TemporaryFolder folder;
  Cloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 2, 3}};
  cloud.attributes = {{"label", std::vector<std::int32_t>{2147483647, 5}},
                      {"class", std::vector<std::uint8_t>{200, 5}},
                      {"red", std::vector<std::uint8_t>{200, 5}}};
  for (Attribute& a : cloud.attributes) a.values.set_missing(1);
  write_cloud(folder.file("a.ply"), cloud);
  const std::vector<Attribute> back = read_cloud(folder.file("a.ply")).attributes;
  EXPECT_EQ(back[0].type(), float64);
  EXPECT_EQ(back[0].values.at(0), 2147483647.0);
  EXPECT_TRUE(std::isnan(back[0].values.at(1)));
  EXPECT_EQ(back[1].type(), float32);
  EXPECT_TRUE(std::isnan(back[1].values.at(1)));
  EXPECT_EQ(back[2].values, AttributeValues(std::vector<std::uint8_t>{200, 0}));
}

TEST(TypesOfPly, TakeIntegersOf64BitsAsTheSmallestThatHoldsThem) {
  const test::TemporaryFolder folder;
  Cloud cloud;
  cloud.positions = {{0, 0, 0}, {1, 2, 3}};
  cloud.attributes = {{"small", std::vector<std::int64_t>{-2147483648, 2147483647}},
                      {"unsigned", std::vector<std::uint64_t>{0, 4294967295}},
                      {"wide", std::vector<std::int64_t>{-1, (std::int64_t{1} << 53) - 1}}};
  write_cloud(folder.file("a.ply"), cloud);
  const std::vector<Attribute> back = read_cloud(folder.file("a.ply")).attributes;
  EXPECT_EQ(back[0].values, AttributeValues(std::vector<std::int32_t>{-2147483648, 2147483647}));
  EXPECT_EQ(back[1].values, AttributeValues(std::vector<std::uint32_t>{0, 4294967295}));
  EXPECT_EQ(back[2].values, AttributeValues(std::vector<double>{-1, 9007199254740991}));
}

const std::string kVtk = "# vtk DataFile Version 3.0\np\n";

TEST(TypesOfVtk, AreReadFromText) {
  const Cloud cloud = cloud_of(
      "a.vtk",
      kVtk +
          "ASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 0 1 2 3\nPOINT_DATA 2\nFIELD f 12\n"
          "a 1 2 char\n-128 127\nb 1 2 unsigned_char\n0 255\nc 1 2 short\n-32768 32767\n"
          "d 1 2 unsigned_short\n0 65535\ne 1 2 int\n-2147483648 2147483647\nf 1 2 unsigned_int\n0 4294967295\n"
          "g 1 2 long\n-9223372036854775808 9007199254740993\nh 1 2 unsigned_long\n0 18446744073709551615\n"
          "i 1 2 float\n0.1 nan\nj 1 2 double\n0.1 400000000.000001\nk 1 2 vtkIdType\n+7 1e3\nl 1 2 bit\n1 0\n");
  const auto& all = cloud.attributes;
  ASSERT_EQ(all.size(), 12U);
  EXPECT_EQ(named(all, "a"), AttributeValues(std::vector<std::int8_t>{-128, 127}));
  EXPECT_EQ(named(all, "b"), AttributeValues(std::vector<std::uint8_t>{0, 255}));
  EXPECT_EQ(named(all, "c"), AttributeValues(std::vector<std::int16_t>{-32768, 32767}));
  EXPECT_EQ(named(all, "d"), AttributeValues(std::vector<std::uint16_t>{0, 65535}));
  EXPECT_EQ(named(all, "e"), AttributeValues(std::vector<std::int32_t>{-2147483648, 2147483647}));
  EXPECT_EQ(named(all, "f"), AttributeValues(std::vector<std::uint32_t>{0, 4294967295}));
  EXPECT_EQ(named(all, "g"),
            AttributeValues(std::vector<std::int64_t>{std::numeric_limits<std::int64_t>::min(), 9007199254740993}));
  EXPECT_EQ(named(all, "h"), AttributeValues(std::vector<std::uint64_t>{0, ~0ULL}));
  EXPECT_EQ(named(all, "i").as<float>()[0], 0.1F);
  EXPECT_EQ(named(all, "j"), AttributeValues(std::vector<double>{0.1, 400000000.000001}));
  EXPECT_EQ(named(all, "k"), AttributeValues(std::vector<std::int32_t>{7, 1000}));
  EXPECT_EQ(named(all, "l"), AttributeValues(std::vector<std::uint8_t>{1, 0}));
}

/// A binary file of `points` points at the origin whose data are `block`.
std::string binary_vtk(int points, const std::string& block) {
  return kVtk + "BINARY\nDATASET POLYDATA\nPOINTS " + std::to_string(points) + " float\n" +
         std::string(static_cast<std::size_t>(points) * 12, '\0') + "\nPOINT_DATA " + std::to_string(points) + "\n" +
         block;
}

TEST(TypesOfVtk, AreReadFromBigEndianBytes) {
  const auto check = [](const char* type, auto values) {
    using T = typename decltype(values)::value_type;
    std::string block = std::string("SCALARS s ") + type + "\nLOOKUP_TABLE default\n";
    for (const T v : values) block += raw<T>(v, true);
    const Cloud cloud = cloud_of("a.vtk", binary_vtk(6, block));
    EXPECT_TRUE(same_bytes(cloud.attributes.at(0).values, AttributeValues(values))) << type;
  };
  check("char", telling_values<std::int8_t>());
  check("unsigned_char", telling_values<std::uint8_t>());
  check("short", telling_values<std::int16_t>());
  check("unsigned_short", telling_values<std::uint16_t>());
  check("int", telling_values<std::int32_t>());
  check("unsigned_int", telling_values<std::uint32_t>());
  check("vtkIdType", telling_values<std::int32_t>());
  check("long", telling_values<std::int64_t>());
  check("vtktypeint64", telling_values<std::int64_t>());
  check("unsigned_long", telling_values<std::uint64_t>());
  check("float", telling_values<float>());
  check("double", telling_values<double>());
}

TEST(TypesOfVtk, HoldBitsEightToAByte) {
  const Cloud cloud =
      cloud_of("a.vtk", binary_vtk(11, "FIELD f 2\nflag 1 11 bit\n\xa5\x60\nafter 1 11 unsigned_char\n0123456789a"));
  EXPECT_EQ(named(cloud.attributes, "flag"),
            AttributeValues(std::vector<std::uint8_t>{1, 0, 1, 0, 0, 1, 0, 1, 0, 1, 1}));
  EXPECT_EQ(named(cloud.attributes, "after").at(10), 'a');
  EXPECT_NE(story_of(ErrorCode::invalid_input, [] { cloud_of("a.vtk", binary_vtk(11, "SCALARS f bit\n\xa5")); }), "");
}

TEST(TypesOfVtk, OfColoursAreBytesInBothEncodings) {
  const Cloud text = cloud_of("a.vtk", kVtk +
                                           "ASCII\nDATASET POLYDATA\nPOINTS 2 float\n0 0 0 1 2 3\nPOINT_DATA 2\n"
                                           "COLOR_SCALARS paint 4\n0 0.5 1 1\n0.2 2 -1 0.999\n"
                                           "COLOR_SCALARS more 1\n0.5 1\n");
  const Cloud binary =
      cloud_of("a.vtk", binary_vtk(2, "COLOR_SCALARS paint 4\n" + std::string("\0\x80\xff\xff\x33\xff\0\xff", 8) +
                                          "\nCOLOR_SCALARS more 1\n\x80\xff"));
  for (const Cloud* cloud : {&text, &binary}) {
    const auto& all = cloud->attributes;
    ASSERT_EQ(all.size(), 5U);
    EXPECT_EQ(named(all, "red"), AttributeValues(std::vector<std::uint8_t>{0, 51}));
    EXPECT_EQ(named(all, "green"), AttributeValues(std::vector<std::uint8_t>{128, 255}));
    EXPECT_EQ(named(all, "blue"), AttributeValues(std::vector<std::uint8_t>{255, 0}));
    EXPECT_EQ(named(all, "alpha"), AttributeValues(std::vector<std::uint8_t>{255, 255}));
    EXPECT_EQ(named(all, "more"), AttributeValues(std::vector<std::uint8_t>{128, 255}));
  }
}

TEST(TypesOfVtk, RejectTextThatTheyDoNotHold) {
  for (const char* value : {"128", "-129", "0.5", "nan", "1e300"}) {
    const std::string story = story_of(ErrorCode::invalid_input, [&] {
      cloud_of("a.vtk",
               kVtk + "ASCII\nDATASET POLYDATA\nPOINTS 1 float\n0 0 0\nPOINT_DATA 1\nSCALARS s char\n" + value);
    });
    EXPECT_NE(story.find("does not fit into its type, which holds whole numbers in -128..127"), std::string::npos)
        << value << ": " << story;
  }
}

/// The attribute s of a text with a header.
AttributeValues column_of(const std::string& name, const std::vector<std::string>& values, int threads = 0) {
  std::string text = "x,y,z," + name + "\n";
  for (const std::string& v : values) text += "1,2,3," + v + "\n";
  ReadOptions options;
  options.threads = threads;
  return cloud_of("a.csv", text, options).attributes.at(0).values;
}

TEST(TypesOfText, AreDoubleWhereFloatWouldLoseDigits) {
  for (const char* short_number :
       {"0.1", "0.123456", "1e-20", "16777216", "3.4e38", "-7", "nan", "inf", "0.30000001192092896"})
    EXPECT_EQ(column_of("s", {"1", short_number}).type(), float32) << short_number;
  for (const char* long_number :
       {"0.123456789", "16777217", "400000000.000001", "1e39", "1e-60", "0.300000001", "123456.789"}) {
    const AttributeValues values = column_of("s", {"1", long_number, "0.5"});
    EXPECT_EQ(values.type(), float64) << long_number;
    EXPECT_EQ(values.at(0), 1);
    EXPECT_EQ(values.at(1), std::strtod(long_number, nullptr));
    EXPECT_EQ(values.at(2), 0.5);
  }
  const Cloud unnamed = cloud_of("a.xyz", "1 2 3 400000000.000001\n1 2 3 400000000.000002\n");
  EXPECT_EQ(unnamed.attributes[0].values, AttributeValues(std::vector<double>{400000000.000001, 400000000.000002}));
}

TEST(TypesOfText, AreIntWhereNamesSoundLikeLabelsAndValuesAreWhole) {
  EXPECT_EQ(column_of("label", {"3", "-2147483648", "2147483647", "16777217"}),
            AttributeValues(std::vector<std::int32_t>{3, -2147483648, 2147483647, 16777217}));
  EXPECT_EQ(column_of("point id", {"1", "2"}).type(), int32);
  EXPECT_EQ(column_of("height", {"1", "2"}).type(), float32);
  EXPECT_EQ(column_of("label", {"1", "2.5"}).type(), float32);
  EXPECT_EQ(column_of("label", {"1", "nan"}).type(), float32);
  EXPECT_EQ(column_of("label", {"1", "2147483648"}).type(), float32) << "float holds that";
  EXPECT_EQ(column_of("label", {"1", "2147483649"}).type(), float64);
}

TEST(TypesOfText, DoNotDependOnTheThreads) {
  std::vector<std::string> values;
  for (int i = 0; i < 100'000; ++i) values.push_back(i == 99'000 ? "400000000.000001" : std::to_string(i));
  const AttributeValues one = column_of("s", values, 1);
  EXPECT_EQ(one.type(), float64);
  EXPECT_EQ(one.at(99'000), 400000000.000001);
  EXPECT_EQ(one.at(98'999), 98'999);
  EXPECT_TRUE(same_bytes(one, column_of("s", values, 4)));
}

std::vector<Attribute> obj_attributes(const std::string& vertices) {
  const std::string text = vertices + "f 1 2 3\n";
  const std::vector<Attribute> of_mesh = mesh_of("a.obj", text).attributes;
  const std::vector<Attribute> of_cloud = cloud_of("a.obj", text).attributes;
  EXPECT_EQ(of_mesh.size(), of_cloud.size());
  for (std::size_t a = 0; a < of_mesh.size(); ++a) EXPECT_TRUE(same_bytes(of_mesh[a].values, of_cloud[a].values));
  return of_mesh;
}

TEST(ColoursOfObj, ComeBackAsTheBytesThatWereWritten) {
  const test::TemporaryFolder folder;
  Mesh mesh;
  std::vector<std::uint8_t> red, green, blue;
  for (int i = 0; i < 256; ++i) {
    mesh.vertices.push_back({static_cast<float>(i), 0.5F, 0});
    red.push_back(static_cast<std::uint8_t>(i));
    green.push_back(static_cast<std::uint8_t>(255 - i));
    blue.push_back(7);
  }
  mesh.attributes = {{"red", red}, {"green", green}, {"blue", blue}};
  mesh.triangles = {{0, 1, 2}};
  write_mesh(folder.file("a.obj"), mesh);
  const Mesh back = read_mesh(folder.file("a.obj"));
  EXPECT_EQ(back.vertices, mesh.vertices);
  expect_same(back.attributes, mesh.attributes);
}

TEST(ColoursOfObj, AreSharesOrBytesOrFloats) {
  const std::vector<Attribute> shares = obj_attributes("v 0 0 0 0 0.5 1\nv 1 0 0 1 0 0.2\nv 0 1 0 1 1 1\n");
  ASSERT_EQ(shares.size(), 3U);
  EXPECT_EQ(shares[0].name, "red");
  EXPECT_EQ(shares[1].values, AttributeValues(std::vector<std::uint8_t>{128, 0, 255}));
  const std::vector<Attribute> bytes = obj_attributes("v 0 0 0 0 128 255\nv 1 0 0 1 0 2\nv 0 1 0 1 1 1\n");
  EXPECT_EQ(bytes.at(1).values, AttributeValues(std::vector<std::uint8_t>{128, 0, 1}));
  const std::vector<Attribute> light = obj_attributes("v 0 0 0 0 1.5 1\nv 1 0 0 1 0 2\nv 0 1 0 1 1 1\n");
  EXPECT_EQ(light.at(1).values, AttributeValues(std::vector<float>{1.5F, 0, 1}));
}

TEST(ColoursOfObj, AreThereIfEveryVertexHasThem) {
  EXPECT_TRUE(obj_attributes("v 0 0 0\nv 1 0 0\nv 0 1 0\n").empty());
  EXPECT_TRUE(obj_attributes("v 0 0 0 1\nv 1 0 0 1\nv 0 1 0 1\n").empty()) << "the fourth coordinate";
  EXPECT_TRUE(obj_attributes("v 0 0 0 1 1 1\nv 1 0 0\nv 0 1 0 0 0 0\n").empty());
  EXPECT_TRUE(obj_attributes("v 0 0 0\nv 1 0 0 1 1 1\nv 0 1 0 0 0 0\n").empty());
  EXPECT_TRUE(obj_attributes("v 0 0 0 1 1 1\nv 1 0 0 1 1\nv 0 1 0 0 0 0\n").empty());
  std::string many;  // in several blocks
  for (int i = 0; i < 30'000; ++i) many += i == 29'000 ? "v 1 2 3\n" : "v 1 2 3 0.25 0.5 0.75\n";
  EXPECT_TRUE(obj_attributes(many).empty());
}

TEST(ColoursOfObj, StayWhereNormalsAreOfOtherVertices) {
  const std::string head = "v 0 0 0 1 0 0\nv 1 0 0 1 0 0\nv 0 1 0 1 0 0\nvn 0 0 1\nvn 0 1 0\nvn 1 0 0\n";
  const Mesh matched = mesh_of("a.obj", head + "f 1//1 2//2 3//3\n");
  EXPECT_EQ(matched.normals.size(), 3U);
  EXPECT_EQ(matched.attributes.size(), 3U);
  const Mesh others = mesh_of("a.obj", head + "f 1//2 2//2 3//3\n");
  EXPECT_TRUE(others.normals.empty());
  EXPECT_EQ(others.attributes.size(), 3U);
}

TEST(ColoursOfObj, EndInAnAnswerOrAnErrorForEveryDamage) {
  EXPECT_NO_THROW(test::damage("v 0 0 0 1 0 0\nv 1 0 0 0.5 0 0\nv 0 1 0 1 0 0\nf 1 2 3\n",
                               [](const std::string& bytes) { mesh_of("a.obj", bytes); }));
}

}  // namespace
}  // namespace pointskin
