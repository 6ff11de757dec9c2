// E57: files of libE57Format, and files that are damaged below their checksums.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <fstream>
#include <stdexcept>
#include <string>
#include <vector>

#include <pointskin/normals.hpp>

#include "io/crc32c.hpp"
#include "io/libraries.hpp"
#include "support/io_files.hpp"

namespace pointskin {
namespace {

using test::cloud_of;
using test::story_of;

const std::string kFolder = POINTSKIN_SOURCE_DIR "/tests/data/formats/";  // NOLINT: a constant of tests
constexpr std::size_t kPage = 1024;

double world(const Cloud& cloud, std::size_t point, std::size_t axis) {
  return cloud.origin[axis] + static_cast<double>(cloud.positions[point][axis]);
}

const AttributeValues& values_of(const Cloud& cloud, const std::string& name) {
  for (const Attribute& a : cloud.attributes)
    if (a.name == name) return a.values;
  throw std::out_of_range(name);
}

/// Lines of x, y, z, intensity, red, green and blue, as libE57Format reads them; colours of -1 are none.
std::vector<std::array<double, 7>> expected_points(const std::string& name) {
  std::ifstream file(kFolder + name);
  std::vector<std::array<double, 7>> rows;
  for (std::array<double, 7> row{};;) {
    for (double& value : row) file >> value;
    if (!file) return rows;
    rows.push_back(row);
  }
}

/// The file with new checksums.
std::string sealed(std::string bytes) {
  for (std::size_t page = 0; page + kPage <= bytes.size(); page += kPage) {
    const std::uint32_t sum = io::crc32c(std::string_view(bytes).substr(page, kPage - 4));
    bytes.replace(page + kPage - 4, 4, test::raw<std::uint32_t>(sum, true));
  }
  return bytes;
}

class E57 : public testing::Test {
 protected:
  void SetUp() override {
    if (!io::kHasPugixml) GTEST_SKIP() << "built without pugixml";
  }

  /// The story of plain_scan.e57 with a part of its XML replaced by another of the same length.
  static std::string story_with(const std::string& part, const std::string& by) {
    std::string bytes = test::bytes_of_file(kFolder + "plain_scan.e57");
    const std::size_t at = bytes.rfind(part);
    if (at == std::string::npos || part.size() != by.size()) throw std::logic_error(part);
    bytes.replace(at, part.size(), by);
    return story_of(ErrorCode::invalid_input, [&] { cloud_of("a.e57", sealed(bytes)); });
  }

  template <class T>
  static std::string story_with_number(std::size_t at, T value) {
    std::string bytes = test::bytes_of_file(kFolder + "plain_scan.e57");
    bytes.replace(at, sizeof(T), test::raw<T>(value));
    return story_of(ErrorCode::invalid_input, [&] { cloud_of("a.e57", sealed(bytes)); });
  }
};

TEST(Crc32c, IsThatOfTheStandard) {
  EXPECT_EQ(io::crc32c("123456789"), 0xE3069283U);
  EXPECT_EQ(io::crc32c(std::string(32, '\0')), 0x8A9136AAU) << "RFC 3720, B.4";
  EXPECT_EQ(io::crc32c(std::string(32, '\xff')), 0x62A8AB43U);
}

TEST_F(E57, ScansAreWhereTheirPosesPutThem) {
  const Cloud cloud = read_cloud(kFolder + "two_scans.e57");
  const auto expected = expected_points("two_scans_e57.asc");
  ASSERT_EQ(static_cast<std::size_t>(cloud.size()), expected.size());
  EXPECT_EQ(cloud.dropped, 0) << "directions without a point are no points";
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(world(cloud, i, axis), expected[i][axis], 2e-5) << i;
    EXPECT_NEAR(values_of(cloud, "intensity").at(i), expected[i][3], 1e-6) << i;
  }
}

TEST_F(E57, ColoursOfAScanThatHasNoneAreMissing) {
  const Cloud cloud = read_cloud(kFolder + "two_scans.e57");
  const auto expected = expected_points("two_scans_e57.asc");
  constexpr std::array kNames{"red", "green", "blue"};
  for (std::size_t c = 0; c < 3; ++c) {
    const AttributeValues& values = values_of(cloud, kNames[c]);
    EXPECT_EQ(values.type(), AttributeType::uint8);
    for (std::size_t i = 0; i < expected.size(); ++i) {
      EXPECT_EQ(values.is_missing(i), expected[i][4 + c] < 0) << i;
      if (!values.is_missing(i)) {
        EXPECT_EQ(values.at(i), expected[i][4 + c]) << i;
      }
    }
  }
  EXPECT_EQ(values_of(cloud, "rowIndex").at(1), 1) << "integers keep their names";
}

TEST_F(E57, EveryPointKnowsItsScanner) {
  const Cloud cloud = read_cloud(kFolder + "two_scans.e57");
  const AttributeValues& x = values_of(cloud, "sensor_x");
  EXPECT_EQ(x.at(0), 500000.125);
  EXPECT_EQ(x.at(x.size() - 1), 500020.125);
  EXPECT_EQ(values_of(cloud, "sensor_y").at(0), 4649776.5);
  EXPECT_EQ(values_of(cloud, "sensor_z").at(x.size() - 1), 100);
  EXPECT_TRUE(has_view_attributes(cloud));
  EXPECT_FALSE(has_view_attributes(read_cloud(kFolder + "plain_scan.e57")))
      << "a pose that moves nothing says nothing of points that were put together before";
}

TEST_F(E57, SphericalCoordinatesAreAroundTheScanner) {
  const Cloud cloud = read_cloud(kFolder + "spherical_scan.e57");
  const auto expected = expected_points("spherical_scan_e57.asc");
  ASSERT_EQ(static_cast<std::size_t>(cloud.size()), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) {
    for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_NEAR(world(cloud, i, axis), expected[i][axis], 2e-5) << i;
    EXPECT_EQ(values_of(cloud, "red").at(i), std::round(expected[i][4] * 255 / 1023)) << "its white is 1023";
    EXPECT_EQ(values_of(cloud, "timeStamp").at(i), 1000 + 0.5 * static_cast<double>(i));
  }
  EXPECT_EQ(values_of(cloud, "intensity").type(), AttributeType::uint16) << "integers in 0..2047";
  EXPECT_TRUE(has_view_attributes(cloud));
}

TEST_F(E57, NormalsOfTheExtensionAreRead) {
  const Cloud cloud = read_cloud(kFolder + "normals_scan.e57");
  ASSERT_TRUE(cloud.has_normals());
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    double length = 0, along = 0;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      length += world(cloud, i, axis) * world(cloud, i, axis);
      along += world(cloud, i, axis) * static_cast<double>(cloud.normals[i][axis]);
    }
    EXPECT_NEAR(along / std::sqrt(length), 1, 1e-6) << "they point away from the origin";
  }
}

TEST_F(E57, IsKnownByItsFirstBytesAndTheSameForAnyNumberOfThreads) {
  const std::string bytes = test::bytes_of_file(kFolder + "two_scans.e57");
  const Cloud one = cloud_of("a", bytes, {.shift = {}, .threads = 1});
  const Cloud two = cloud_of("a.xyz", bytes, {.shift = {}, .threads = 2});
  EXPECT_EQ(one.positions, two.positions);
  EXPECT_EQ(one.size(), 218);
}

TEST_F(E57, ADamagedPageIsNamed) {
  std::string bytes = test::bytes_of_file(kFolder + "two_scans.e57");
  bytes[2 * kPage + 17] ^= 1;
  EXPECT_EQ(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.e57", bytes); }),
            "a.e57: is damaged, the checksum of a page differs, byte 2048; copy or export it again");
}

TEST_F(E57, HeadersThatCannotBeAreRefused) {
  EXPECT_NE(story_with_number<std::uint32_t>(8, 2).find("is of E57 2.0; export it as E57 1.0"), std::string::npos);
  EXPECT_NE(story_with_number<std::uint64_t>(16, 1 << 20).find("is truncated, 1048576 bytes are promised, byte 4096"),
            std::string::npos);
  EXPECT_NE(story_with_number<std::uint64_t>(16, 1000).find("does not end at the end of a page"), std::string::npos);
  EXPECT_NE(story_with_number<std::uint64_t>(24, 1022).find("names byte 1022, where nothing can be"),
            std::string::npos);
  EXPECT_NE(story_with_number<std::uint64_t>(24, ~0ULL).find("where nothing can be"), std::string::npos);
  EXPECT_NE(story_with_number<std::uint64_t>(32, ~0ULL).find("ends before its XML does"), std::string::npos);
  EXPECT_NE(story_with_number<std::uint64_t>(40, 0).find("has pages of 0 bytes"), std::string::npos);
  EXPECT_NE(story_with_number<std::uint64_t>(40, 1ULL << 40).find("has pages of 1099511627776 bytes"),
            std::string::npos);
}

TEST_F(E57, PacketsThatCannotBeAreRefused) {
  // The section begins behind the header, its packets 32 bytes later.
  EXPECT_NE(story_with_number<std::uint8_t>(48, 2).find("packets of a scan are garbled"), std::string::npos);
  EXPECT_NE(story_with_number<std::uint64_t>(56, ~0ULL).find("packets of a scan are garbled"), std::string::npos);
  EXPECT_NE(story_with_number<std::uint8_t>(80, 3).find("packets of a scan are garbled"), std::string::npos);
  EXPECT_NE(story_with_number<std::uint16_t>(82, 0xFFFF).find("packets of a scan are garbled"), std::string::npos);
  EXPECT_NE(story_with_number<std::uint16_t>(84, 7).find("packets of a scan are garbled"), std::string::npos);
  EXPECT_NE(story_with_number<std::uint16_t>(86, 0).find("the values 'cartesianX' end before the 120 points do"),
            std::string::npos);
}

TEST_F(E57, XmlThatCannotBeIsRefused) {
  EXPECT_NE(story_with("recordCount=\"120\"", "recordCount=\"x20\"").find("'recordCount' 'x20', which is no whole"),
            std::string::npos);
  EXPECT_NE(story_with("recordCount=\"120\"", "recordCount=\"999\"").find("end before the 999 points do"),
            std::string::npos);
  EXPECT_NE(story_with("recordCount=\"120\"", "recordCount=\"000\"").find("holds no points"), std::string::npos);
  EXPECT_NE(story_with("cartesianX", "cartesianW").find("has a scan without coordinates"), std::string::npos);
  EXPECT_NE(story_with("</e57Root>", "</e57Rooo>").find("its XML is garbled"), std::string::npos);
  EXPECT_NE(story_with("</e57Root>", "</e57Root ").find("its XML is garbled"), std::string::npos);
}

TEST_F(E57, DamagedFilesEndInAStoryOrACloud) {
  const std::string bytes = test::bytes_of_file(kFolder + "plain_scan.e57");
  test::damage(bytes, [](const std::string& damaged) { cloud_of("a.e57", damaged, {.shift = {}, .threads = 1}); });
}

TEST_F(E57, DamagedFilesWithRightChecksumsDoSo) {
  const std::string bytes = test::bytes_of_file(kFolder + "plain_scan.e57");
  test::damage(bytes,
               [](const std::string& damaged) { cloud_of("a.e57", sealed(damaged), {.shift = {}, .threads = 1}); });
}

}  // namespace
}  // namespace pointskin
