// PTX: scans with their grids, places and matrices.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <fstream>
#include <stdexcept>
#include <string>

#include <pointskin/normals.hpp>

#include "support/io_files.hpp"

namespace pointskin {
namespace {

using test::cloud_of;
using test::story_of;

/// The header of a scan whose matrix turns x into y and moves to `place`.
std::string turned_header(const std::string& grid, const std::string& place) {
  return grid + place + "\n0 1 0\n-1 0 0\n0 0 1\n" + "0 1 0 0\n-1 0 0 0\n0 0 1 0\n" + place + " 1\n";
}

const std::string kHeader =
    "2\n1\n0 0 0\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n0 0 0 1\n";  // NOLINT: a constant of tests

double world(const Cloud& cloud, std::size_t point, std::size_t axis) {
  return cloud.origin[axis] + static_cast<double>(cloud.positions[point][axis]);
}

const AttributeValues& values_of(const Cloud& cloud, const std::string& name) {
  for (const Attribute& a : cloud.attributes)
    if (a.name == name) return a.values;
  throw std::out_of_range(name);
}

TEST(Ptx, PointsAreMovedToTheWorldByTheMatrix) {
  const Cloud cloud = cloud_of("a.ptx", turned_header("2\n1\n", "500000 4649776 100") + "1 0 0 0.25\n0.001 2 3 1\n");
  ASSERT_EQ(cloud.size(), 2);
  EXPECT_EQ(cloud.dropped, 0);
  const double expected[2][3] = {{500000, 4649777, 100}, {499998, 4649776.001, 103}};
  for (std::size_t i = 0; i < 2; ++i)
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(world(cloud, i, axis), expected[i][axis], 1e-6);
  EXPECT_EQ(values_of(cloud, "intensity").as<float>(), (std::vector<float>{0.25F, 1}));
}

TEST(Ptx, EveryPointKnowsItsScanner) {
  const std::string second = turned_header("1\n1\n", "7 8 9");
  const Cloud cloud = cloud_of("a.ptx", kHeader + "1 0 0 0.5\n0 1 0 0.5\n" + second + "1 1 1 0.5\n");
  ASSERT_EQ(cloud.size(), 3);
  EXPECT_EQ(values_of(cloud, "sensor_x").as<double>(), (std::vector<double>{0, 0, 7}));
  EXPECT_EQ(values_of(cloud, "sensor_y").as<double>(), (std::vector<double>{0, 0, 8}));
  EXPECT_EQ(values_of(cloud, "sensor_z").as<double>(), (std::vector<double>{0, 0, 9}));
  EXPECT_TRUE(has_view_attributes(cloud));
}

TEST(Ptx, WhereTheScannerHasNoPlaceItIsTheOriginOfTheScan) {
  std::string header = turned_header("1\n1\n", "7 8 9");
  header.replace(header.find("7 8 9"), 5, "0 0 0");
  const Cloud cloud = cloud_of("a.ptx", header + "1 1 1 0.5\n");
  EXPECT_EQ(values_of(cloud, "sensor_y").as<double>(), (std::vector<double>{8}));
}

TEST(Ptx, NormalsPointToTheScanner) {
  // A room seen from its middle: without the scanners its normals would be taken for those of a box.
  std::string text = "20\n20\n5 5 5\n1 0 0\n0 1 0\n0 0 1\n1 0 0 0\n0 1 0 0\n0 0 1 0\n5 5 5 1\n";
  for (int i = 0; i < 400; ++i) {
    const double z = 1 - (i + 0.5) / 200;
    const double ring = std::sqrt(1 - z * z);
    text += std::to_string(ring * std::cos(2.4 * i)) + " " + std::to_string(ring * std::sin(2.4 * i)) + " " +
            std::to_string(z) + " 0.5\n";
  }
  Cloud cloud = cloud_of("room.ptx", text);
  NormalEstimator estimator{Device::cpu()};
  estimator.orient(cloud);
  EXPECT_EQ(estimator.report().method, NormalMethod::sensor);
  for (std::size_t i = 0; i < 400; ++i) {
    double inwards = 0;
    for (std::size_t axis = 0; axis < 3; ++axis)
      inwards += static_cast<double>(cloud.normals[i][axis]) * (5 - world(cloud, i, axis));
    EXPECT_GT(inwards, 0.9) << i;
  }
}

TEST(Ptx, DirectionsWithoutAPointAreLeftOut) {
  const Cloud cloud = cloud_of("a.ptx", kHeader + "0 0 0 0.5 0 0 0\n1 2 3 0.25 255 128 7\n");
  ASSERT_EQ(cloud.size(), 1);
  EXPECT_EQ(cloud.dropped, 0) << "it is no point";
  EXPECT_EQ(values_of(cloud, "red").as<std::uint8_t>(), std::vector<std::uint8_t>{255});
  EXPECT_EQ(values_of(cloud, "green").as<std::uint8_t>(), std::vector<std::uint8_t>{128});
  EXPECT_EQ(values_of(cloud, "blue").as<std::uint8_t>(), std::vector<std::uint8_t>{7});
  EXPECT_EQ(cloud_of("a.ptx", kHeader + "nan 0 0 1\n1 2 3 1\n").dropped, 1) << "but this is a bad one";
}

TEST(Ptx, ColoursOfAScanThatHasNoneAreMissing) {
  const Cloud cloud =
      cloud_of("a.ptx", kHeader + "0 0 0 0.5\n1 2 3 0.25\n" + kHeader + "4 5 6 1 9 8 7\n0 0 0 0.5 0 0 0\n");
  ASSERT_EQ(cloud.size(), 2);
  const AttributeValues& red = values_of(cloud, "red");
  EXPECT_TRUE(red.is_missing(0));
  EXPECT_FALSE(red.is_missing(1));
  EXPECT_EQ(red.at(1), 9);
}

TEST(Ptx, GridsMayBeEmptyAndLinesEndAsInWindows) {
  std::string empty = kHeader;
  empty[0] = '0';
  std::string text = empty + kHeader + "1 2 3 1\n4 5 6 1\n" + empty;
  for (std::size_t at = 0; (at = text.find('\n', at)) != std::string::npos; at += 2) text.replace(at, 1, "\r\n");
  EXPECT_EQ(cloud_of("a.ptx", text).size(), 2);
}

TEST(Ptx, GarbledScansAreRefusedWithTheirLine) {
  const auto story = [](const std::string& text) {
    return story_of(ErrorCode::invalid_input, [&] { cloud_of("a.ptx", text); });
  };
  EXPECT_EQ(story(""), "a.ptx: holds no scan; check the program that wrote it");
  EXPECT_EQ(story("3\n3\n"),
            "a.ptx: is truncated, the ten lines before a scan are promised, but the file ends before; copy or export "
            "it again");
  EXPECT_EQ(story(kHeader + "1 2 3 1\n"),
            "a.ptx: is truncated, 2 x 1 points are promised, but the file ends before; copy or export it again");
  EXPECT_NE(story("9007199254740992\n9007199254740992" + kHeader.substr(3)).find("is truncated"), std::string::npos);
  EXPECT_NE(story("-1" + kHeader.substr(1)).find("negative number of columns or rows, line 1"), std::string::npos);
  EXPECT_NE(story("1.5" + kHeader.substr(1)).find("is not a whole number, line 1"), std::string::npos);
  EXPECT_NE(story(kHeader + "1 2 3 1 5\n1 2 3 1 5\n").find("a point has 5 values, line 11"), std::string::npos);
  EXPECT_NE(story(kHeader + "1 2 3 1\n1 2 3\n").find("a value is missing at the end of the line, line 12"),
            std::string::npos);
  EXPECT_NE(story(kHeader + "1 2 3 1 0 0 256\n1 2 3 1 0 0 0\n").find("the colour 256 is not in 0 to 255, line 11"),
            std::string::npos);
  std::string matrix = kHeader;
  matrix.replace(matrix.rfind("0 0 0 1"), 7, "0 0 0 2");
  EXPECT_NE(story(matrix).find("does not end in 0, 0, 0 and 1"), std::string::npos);
  std::string infinite = kHeader;
  infinite.replace(infinite.rfind("0 0 0 1"), 7, "inf 0 0 1");
  EXPECT_NE(story(infinite).find("not finite, line 10"), std::string::npos);
}

TEST(Ptx, CloudCompareReadsTheSamePoints) {
  const std::string folder = POINTSKIN_SOURCE_DIR "/tests/data/formats/";
  const Cloud cloud = read_cloud(folder + "two_scans.ptx");
  std::ifstream expected(folder + "two_scans_ptx.asc");  // x, y, z, red, green, blue, intensity
  std::array<double, 7> row{};
  const auto next = [&] {
    for (double& value : row) expected >> value;
    return static_cast<bool>(expected);
  };
  std::size_t i = 0;
  for (; next(); ++i) {
    ASSERT_LT(i, cloud.positions.size());
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(world(cloud, i, axis), row[axis], 1e-5) << i;
    const std::array names{"red", "green", "blue", "intensity"};
    for (std::size_t a = 0; a < 4; ++a) EXPECT_NEAR(values_of(cloud, names[a]).at(i), row[3 + a], 1e-6) << i;
  }
  EXPECT_EQ(i, cloud.positions.size());
}

TEST(Ptx, DamagedFilesEndInAStoryOrACloud) {
  const std::string text =
      kHeader + "1 2 3 0.5 1 2 3\n0 0 0 0.5 0 0 0\n" + turned_header("1\n1\n", "7 8 9") + "1 2 3 1\n";
  test::damage(text, [](const std::string& damaged) { cloud_of("a.ptx", damaged); });
}

}  // namespace
}  // namespace pointskin
