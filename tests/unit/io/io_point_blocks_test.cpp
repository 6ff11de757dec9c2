// Points are read in blocks of 4096 rows: nothing may depend on where a row falls, nor on how its columns are stored.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>

#include "exec/host_array.hpp"
#include "support/io_files.hpp"

namespace pointskin {
namespace {

using test::cloud_of;
using test::raw;

constexpr float kInfinity = std::numeric_limits<float>::infinity();
constexpr std::int64_t kRows[] = {1, 4095, 4096, 4097, 8192, 10'000};

/// Row `i` is left out of a cloud: rows at the borders of blocks, and a few others.
bool is_bad(std::int64_t i) { return i % 4096 == 0 || i % 4096 == 4095 || i % 1000 == 7; }

/// One way to store points: the type of y, where x and z are float, and the order of bytes.
struct Storage {
  bool y_is_double, big_endian;
};

std::string make_ply(std::int64_t rows, const Storage& how) {
  std::string bytes = std::string("ply\nformat binary_") + (how.big_endian ? "big" : "little") +
                      "_endian 1.0\nelement vertex " + std::to_string(rows) + "\nproperty float x\nproperty " +
                      (how.y_is_double ? "double" : "float") +
                      " y\nproperty float z\nproperty uchar grey\nproperty float nx\nproperty float ny\n"
                      "property float nz\nend_header\n";
  for (std::int64_t i = 0; i < rows; ++i) {
    const auto value = static_cast<float>(i);
    const float y = is_bad(i) ? (i % 2 == 0 ? kInfinity : std::nanf("")) : value / 2;
    bytes += raw<float>(value, how.big_endian);
    bytes += how.y_is_double ? raw<double>(y, how.big_endian) : raw<float>(y, how.big_endian);
    bytes += raw<float>(-value, how.big_endian);
    bytes += raw<std::uint8_t>(static_cast<std::uint8_t>(i % 256));
    bytes += raw<float>(i % 5 == 0 ? kInfinity : value, how.big_endian);
    bytes += raw<float>(1, how.big_endian) + raw<float>(2, how.big_endian);
  }
  return bytes;
}

void expect_the_good_rows(const Cloud& cloud, std::int64_t rows) {
  std::size_t at = 0;
  for (std::int64_t i = 0; i < rows; ++i) {
    if (is_bad(i)) continue;
    const auto value = static_cast<float>(i);
    ASSERT_LT(at, cloud.positions.size());
    ASSERT_EQ(cloud.positions[at], (Vec3f{value, value / 2, -value})) << "row " << i;
    ASSERT_EQ(cloud.normals[at], (i % 5 == 0 ? Vec3f{} : Vec3f{value, 1, 2})) << "row " << i;
    ASSERT_EQ(cloud.attributes[0].values.at(at), static_cast<float>(i % 256)) << "row " << i;
    ++at;
  }
  EXPECT_EQ(cloud.positions.size(), at);
  EXPECT_EQ(cloud.dropped, rows - static_cast<std::int64_t>(at));
}

TEST(PointBlocks, LeaveOutBadRowsWhereverTheyFall) {
  for (const std::int64_t rows : kRows)
    for (const bool y_is_double : {false, true})
      for (const bool big_endian : {false, true})
        for (const int threads : {1, 8}) {
          SCOPED_TRACE(testing::Message() << rows << " rows, y double " << y_is_double << ", big endian " << big_endian
                                          << ", " << threads << " threads");
          const Cloud cloud = cloud_of("a.ply", make_ply(rows, {y_is_double, big_endian}), {{}, threads});
          ASSERT_EQ(cloud.attributes.size(), 1u);
          EXPECT_EQ(cloud.attributes[0].type(), AttributeType::uint8);
          ASSERT_NO_FATAL_FAILURE(expect_the_good_rows(cloud, rows));
        }
}

TEST(HostArray, GrowsAndShrinksLikeAnyVector) {
  for (const int threads : {1, 8}) {
    exec::Cpu ex(threads);
    std::vector<std::int32_t> values{1, 2, 3};
    for (const std::size_t size : {std::size_t{0}, std::size_t{5}, std::size_t{1} << 18, (std::size_t{1} << 20) + 77}) {
      exec::resize(ex, values, size);
      ASSERT_EQ(values.size(), size);
      for (const std::int32_t value : values) ASSERT_EQ(value, 0);
    }
    values.back() = 7;
    exec::resize(ex, values, std::size_t{4} << 20);
    EXPECT_EQ(values[(std::size_t{1} << 20) + 76], 7);
    EXPECT_EQ(values.back(), 0);
  }
}

}  // namespace
}  // namespace pointskin
