// LAS 1.0 to 1.4 and LAZ: the points of all formats, survey coordinates to their last digit, and garbled files.
#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

#include "support/io_files.hpp"

namespace pointskin {
namespace {

using test::cloud_of;
using test::raw;
using test::story_of;

constexpr std::array<std::size_t, 11> kPointBytes{20, 28, 26, 34, 57, 63, 30, 36, 38, 59, 67};
constexpr std::array<double, 3> kOffset{500000, 4649000, -20};
constexpr double kScale = 0.001;

void put(std::string& bytes, std::size_t at, const std::string& value) { bytes.replace(at, value.size(), value); }

std::size_t header_bytes(int minor) { return minor < 3 ? 227 : minor == 3 ? 235 : 375; }

/// Whole coordinates of point `i`.
std::array<std::int32_t, 3> place_of(std::int32_t i) { return {123456 + 7 * i, 776001 - i, i % 3 - 5}; }

/// One point with its number in its fields, by the tables of the standard.
std::string point(int format, std::int32_t i) {
  std::string p(kPointBytes.at(static_cast<std::size_t>(format)), '\0');
  for (std::size_t axis = 0; axis < 3; ++axis) put(p, 4 * axis, raw<std::int32_t>(place_of(i)[axis]));
  put(p, 12, raw<std::uint16_t>(static_cast<std::uint16_t>(1000 + i)));
  const bool is_extended = format >= 6;
  if (is_extended) {
    put(p, 14, raw<std::uint8_t>(0x92));  // the second of nine returns
    put(p, 16, raw<std::uint8_t>(200));
    put(p, 17, raw<std::uint8_t>(17));
    put(p, 18, raw<std::int16_t>(-2500));  // -15 degrees
    put(p, 20, raw<std::uint16_t>(4711));
  } else {
    put(p, 14, raw<std::uint8_t>(0b00101010));  // the second of five
    put(p, 15, raw<std::uint8_t>(0xE0 | 6));    // three flags above the class
    put(p, 16, raw<std::int8_t>(-15));
    put(p, 17, raw<std::uint8_t>(17));
    put(p, 18, raw<std::uint16_t>(4711));
  }
  const std::array<int, 11> time{0, 20, 0, 20, 20, 20, 22, 22, 22, 22, 22};
  const std::array<int, 11> colour{0, 0, 20, 28, 0, 28, 0, 30, 30, 0, 30};
  const auto f = static_cast<std::size_t>(format);
  if (time[f] > 0) put(p, static_cast<std::size_t>(time[f]), raw<double>(1000.25 + i));
  for (std::size_t c = 0; colour[f] > 0 && c < 3; ++c)
    put(p, static_cast<std::size_t>(colour[f]) + 2 * c, raw<std::uint16_t>(static_cast<std::uint16_t>(300 * c + i)));
  if (format == 8 || format == 10) put(p, 36, raw<std::uint16_t>(static_cast<std::uint16_t>(5000 + i)));
  return p;
}

/// A file of version 1.`minor`.
std::string las(int minor, int format, std::int32_t points) {
  std::string bytes(header_bytes(minor), '\0');
  put(bytes, 0, "LASF");
  put(bytes, 24, raw<std::uint8_t>(1) + raw<std::uint8_t>(static_cast<std::uint8_t>(minor)));
  const auto size = static_cast<std::uint32_t>(bytes.size());
  put(bytes, 94, raw<std::uint16_t>(static_cast<std::uint16_t>(size)) + raw<std::uint32_t>(size));
  put(bytes, 104, raw<std::uint8_t>(static_cast<std::uint8_t>(format)));
  put(bytes, 105, raw<std::uint16_t>(static_cast<std::uint16_t>(kPointBytes.at(static_cast<std::size_t>(format)))));
  if (format < 6) put(bytes, 107, raw<std::uint32_t>(static_cast<std::uint32_t>(points)));
  if (minor == 4) put(bytes, 247, raw<std::uint64_t>(static_cast<std::uint64_t>(points)));
  for (std::size_t axis = 0; axis < 3; ++axis) {
    put(bytes, 131 + 8 * axis, raw<double>(kScale));
    put(bytes, 155 + 8 * axis, raw<double>(kOffset[axis]));
  }
  for (std::int32_t i = 0; i < points; ++i) bytes += point(format, i);
  return bytes;
}

const AttributeValues* find(const Cloud& cloud, const std::string& name) {
  for (const Attribute& a : cloud.attributes)
    if (a.name == name) return &a.values;
  return nullptr;
}

const AttributeValues& values_of(const Cloud& cloud, const std::string& name) {
  if (const AttributeValues* const values = find(cloud, name)) return *values;
  throw std::out_of_range(name);
}

/// Expects the points of las() to be off by a sixteenth of their scale at most.
void expect_places(const Cloud& cloud) {
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)
    for (std::size_t axis = 0; axis < 3; ++axis)
      EXPECT_NEAR(cloud.origin[axis] + static_cast<double>(cloud.positions[i][axis]),
                  place_of(static_cast<std::int32_t>(i))[axis] * kScale + kOffset[axis], kScale / 16);
}

std::string peer_file(const std::string& name) {
  return test::bytes_of_file(POINTSKIN_SOURCE_DIR "/tests/data/formats/" + name);
}

/// The story of a file of three points of the format 3 with a value of its header replaced.
template <class T>
std::string story_with(std::size_t at, T value, int minor = 2) {
  std::string bytes = las(minor, 3, 3);
  put(bytes, at, raw<T>(value));
  return story_of(ErrorCode::invalid_input, [&] { cloud_of("a.las", bytes); });
}

TEST(Las, PointsOfAllVersionsAndFormatsKeepTheirValues) {
  for (int minor = 0; minor <= 4; ++minor)
    for (int format = 0; format <= (minor == 4 ? 10 : 5); ++format) {
      SCOPED_TRACE("1." + std::to_string(minor) + ", format " + std::to_string(format));
      const Cloud cloud = cloud_of("a.las", las(minor, format, 9));
      ASSERT_EQ(cloud.size(), 9);
      expect_places(cloud);
      EXPECT_EQ(values_of(cloud, "intensity").at(8), 1008);
      EXPECT_EQ(values_of(cloud, "return_number").at(0), 2);
      EXPECT_EQ(values_of(cloud, "number_of_returns").at(0), format < 6 ? 5 : 9);
      EXPECT_EQ(values_of(cloud, "classification").at(0), format < 6 ? 6 : 200);
      EXPECT_NEAR(values_of(cloud, "scan_angle").at(0), -15, 1e-5);
      EXPECT_EQ(values_of(cloud, "user_data").at(0), 17);
      EXPECT_EQ(values_of(cloud, "point_source_id").at(0), 4711);
    }
}

TEST(Las, FormatsHaveTimesColoursAndInfrared) {
  for (int format = 0; format <= 10; ++format) {
    SCOPED_TRACE(format);
    const Cloud cloud = cloud_of("a.las", las(4, format, 4));
    const bool has_time = format != 0 && format != 2;
    const bool has_colour = format == 2 || format == 3 || format == 5 || format == 7 || format == 8 || format == 10;
    const bool has_infrared = format == 8 || format == 10;
    ASSERT_EQ(find(cloud, "gps_time") != nullptr, has_time);
    ASSERT_EQ(find(cloud, "red") != nullptr, has_colour);
    ASSERT_EQ(find(cloud, "infrared") != nullptr, has_infrared);
    if (has_time) {
      EXPECT_EQ(values_of(cloud, "gps_time").at(3), 1003.25);
    }
    if (has_colour) {
      EXPECT_EQ(values_of(cloud, "blue").type(), AttributeType::uint16);
      EXPECT_EQ(values_of(cloud, "blue").at(3), 603);
    }
    if (has_infrared) {
      EXPECT_EQ(values_of(cloud, "infrared").at(3), 5003);
    }
  }
}

TEST(Las, ColoursThatAreBytesAreBytes) {
  for (const int factor : {1, 256, 257}) {
    std::string bytes = las(2, 2, 2);
    for (std::size_t i = 0; i < 2; ++i)
      for (std::size_t c = 0; c < 3; ++c)
        put(bytes, 227 + 26 * i + 20 + 2 * c,
            raw<std::uint16_t>(static_cast<std::uint16_t>(static_cast<int>(100 * c + 55 * i) * factor)));
    const Cloud cloud = cloud_of("a.las", bytes);
    EXPECT_EQ(values_of(cloud, "blue").type(), AttributeType::uint8) << factor;
    EXPECT_EQ(values_of(cloud, "blue").at(1), 255) << factor;
    EXPECT_EQ(values_of(cloud, "red").at(1), 55) << factor;
  }
}

TEST(Las, AGivenShiftIsTheOrigin) {
  const Vec3d shift{500100, 4649700, 0};
  const Cloud cloud = cloud_of("a.las", las(2, 0, 5), {.shift = shift});
  EXPECT_EQ(cloud.origin, shift);
  expect_places(cloud);
}

TEST(Las, AWideTileKeepsItsDigitsToo) {
  // 2 km: whole numbers that float would round if they were not taken from the middle.
  std::string bytes = las(2, 0, 3);
  const std::array<std::int32_t, 3> x{0, 2000001, 999999};
  for (std::size_t i = 0; i < 3; ++i) put(bytes, 227 + 20 * i, raw<std::int32_t>(x[i]));
  const Cloud cloud = cloud_of("a.las", bytes);
  for (std::size_t i = 0; i < 3; ++i)
    EXPECT_NEAR(cloud.origin[0] + static_cast<double>(cloud.positions[i].x), x[i] * kScale + kOffset[0], kScale / 8);
}

TEST(Las, CompressedPointsAreThoseOfTheFileThatIsNot) {
  for (const std::string name : {"format3", "format8"}) {
    const Cloud plain = cloud_of("a.las", peer_file(name + ".las"));
    const Cloud packed = cloud_of("a.laz", peer_file(name + ".laz"));
    EXPECT_EQ(plain.size(), 150);
    EXPECT_EQ(plain.positions, packed.positions) << name;
    EXPECT_EQ(plain.origin, packed.origin) << name;
    ASSERT_EQ(plain.attributes.size(), packed.attributes.size());
    for (std::size_t a = 0; a < plain.attributes.size(); ++a) {
      EXPECT_EQ(plain.attributes[a].name, packed.attributes[a].name);
      EXPECT_EQ(plain.attributes[a].values, packed.attributes[a].values) << name << plain.attributes[a].name;
    }
    EXPECT_NE(find(plain, "reflectance"), nullptr) << "an extra value that another program added";
  }
}

TEST(Las, CutFilesAreRefused) {
  const auto refuses = [](const std::string& name, const std::string& bytes) {
    return !story_of(ErrorCode::invalid_input, [&] { cloud_of(name, bytes); }).empty();
  };
  const std::string whole = las(4, 7, 3);
  for (std::size_t length = 0; length < whole.size(); ++length)
    EXPECT_TRUE(refuses("a.las", whole.substr(0, length))) << length;
  for (const char* name : {"format3.laz", "format8.laz"}) {
    const std::string packed = peer_file(name);
    for (std::size_t length = 0; length + 16 < packed.size(); ++length)
      EXPECT_TRUE(refuses("a.laz", packed.substr(0, length))) << name << " " << length;
  }
}

TEST(Las, HeadersThatCannotBeAreRefused) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  EXPECT_NE(story_with<std::uint8_t>(24, 2).find("is of LAS 2.2; export it as LAS 1.0 to 1.4"), std::string::npos);
  EXPECT_NE(story_with<std::uint8_t>(25, 5).find("is of LAS 1.5"), std::string::npos);
  EXPECT_NE(story_with<std::uint32_t>(96, 226).find("truncated before its points"), std::string::npos);
  EXPECT_NE(story_with<std::uint32_t>(96, 1U << 31).find("truncated before its points"), std::string::npos);
  EXPECT_NE(story_with<std::uint8_t>(104, 11).find("points of the format 11"), std::string::npos);
  EXPECT_NE(story_with<std::uint8_t>(104, 0x83).find("is compressed, but does not say how"), std::string::npos);
  EXPECT_NE(story_with<std::uint16_t>(105, 33).find("points of 33 bytes, too few for the format 3"), std::string::npos);
  EXPECT_NE(story_with<std::uint32_t>(107, ~0U).find("4294967295 points are promised"), std::string::npos);
  EXPECT_NE(story_with<std::uint64_t>(247, ~0ULL, 4).find("18446744073709551615 points are promised"),
            std::string::npos);
  EXPECT_NE(story_with<double>(139, 0).find("a scale or an offset"), std::string::npos);
  EXPECT_NE(story_with<double>(147, kNone).find("a scale or an offset"), std::string::npos);
  EXPECT_NE(story_with<double>(155, 1e300).find("a scale or an offset"), std::string::npos);
}

TEST(Las, DamagedFilesEndInAStoryOrACloud) {
  test::damage(las(4, 8, 2), [](const std::string& damaged) { cloud_of("a.las", damaged); });
}

TEST(Las, LayersWithoutBytesAreRefusedOrLeftOut) {
  const std::string bytes = peer_file("format8.laz");
  const auto number = [&](std::size_t at, std::size_t size) {
    std::size_t value = 0;
    for (std::size_t i = size; i-- > 0;) value = value << 8U | static_cast<unsigned char>(bytes[at + i]);
    return value;
  };
  // The place of the chunk table, the first point as it is, how many points there are, then the lengths of the layers.
  const std::size_t lengths = number(96, 4) + 8 + number(105, 2) + 4;
  for (std::size_t layer = 0; layer < 9; ++layer) {
    std::string damaged = bytes;
    damaged.replace(lengths + 4 * layer, 4, 4, '\0');
    const std::string story = story_of(ErrorCode::invalid_input, [&] { cloud_of("a.laz", damaged); });
    EXPECT_TRUE(layer > 0 || story.find("garbled") != std::string::npos) << "places are in the first";
  }
}

TEST(Las, DamagedCompressedFilesDoSo) {
  for (const char* name : {"format3.laz", "format8.laz"}) {
    const std::string bytes = peer_file(name);
    for (std::size_t i = 0; i < bytes.size(); i += 29) {
      std::string damaged = bytes;
      damaged[i] = static_cast<char>(damaged[i] ^ (i % 2 == 0 ? 0xFF : 0x11));
      const std::string story =
          story_of(ErrorCode::invalid_input, [&] { cloud_of("a.laz", damaged, {.shift = {}, .threads = 1}); });
      EXPECT_EQ(story.find("wrong code"), std::string::npos) << name << " " << i << ": " << story;
      EXPECT_EQ(story.find('\n'), std::string::npos) << story;
    }
  }
}

}  // namespace
}  // namespace pointskin
