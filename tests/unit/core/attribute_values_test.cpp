// Values of one type: what they hold, what is missing, and what becomes of them when clouds are merged.
#include <gtest/gtest.h>

#include <pointskin/attribute.hpp>
#include <pointskin/error.hpp>

#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>
#include <vector>

namespace pointskin {
namespace {

using enum AttributeType;

constexpr std::array kTypes{int8, uint8, int16, uint16, int32, uint32, int64, uint64, float32, float64};
constexpr double kNan = std::numeric_limits<double>::quiet_NaN();

/// Numbers at the ends of T, and a few others that it holds.
template <class T>
std::vector<T> extremes() {
  std::vector<T> values{std::numeric_limits<T>::lowest(), std::numeric_limits<T>::max(), T{0}, T{1}, T{100}};
  if constexpr (std::is_floating_point_v<T>) {
    values.push_back(-T{0});
    values.push_back(std::numeric_limits<T>::denorm_min());
    values.push_back(T{16777216} + 1);
  }
  return values;
}

AttributeValues extremes_of(AttributeType type) {
  return visit_type(type, [](auto tag) { return AttributeValues(extremes<decltype(tag)>()); });
}

/// The i-th value in a type that holds all of them.
long double exact(const AttributeValues& values, std::size_t i) {
  return values.visit([&](const auto& all) { return static_cast<long double>(all[i]); });
}

TEST(AttributeValues, AreOfTheTypeOfTheirVector) {
  for (const AttributeType type : kTypes) {
    SCOPED_TRACE(name_of(type));
    visit_type(type, [&](auto tag) {
      using T = decltype(tag);
      const AttributeValues values(std::vector<T>{1, 2, 3});
      EXPECT_EQ(values.type(), type);
      EXPECT_EQ(type_of<T>(), type);
      EXPECT_EQ(size_of(type), sizeof(T));
      EXPECT_EQ(is_integer(type), std::is_integral_v<T>);
      EXPECT_EQ(values.size(), 3U);
      EXPECT_EQ(values.bytes(), 3 * sizeof(T));
      EXPECT_EQ(values.as<T>(), (std::vector<T>{1, 2, 3}));
      EXPECT_EQ(AttributeValues(type, 3), AttributeValues(std::vector<T>(3)));
    });
  }
  EXPECT_STREQ(name_of(uint16), "uint16");
  EXPECT_STREQ(name_of(float64), "float64");
}

TEST(AttributeValues, AreRefusedUnderAnotherType) {
  AttributeValues values(std::vector<double>{1});
  try {
    (void)values.as<float>();
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    EXPECT_STREQ(error.what(), "the values are float64, not float32");
  }
  EXPECT_THROW((void)values.edit<std::int64_t>(), Error);
  EXPECT_THROW((void)values.take<std::int64_t>(), Error);
}

TEST(AttributeValues, ThatAreMissingAreNanOrMasked) {
  for (const AttributeType type : kTypes) {
    SCOPED_TRACE(name_of(type));
    AttributeValues values(type, 3);
    for (std::size_t i = 0; i < 3; ++i) EXPECT_FALSE(values.is_missing(i));
    values.set_missing(1);
    EXPECT_EQ(values.has_mask(), is_integer(type));
    EXPECT_FALSE(values.is_missing(0));
    EXPECT_TRUE(values.is_missing(1));
    EXPECT_TRUE(std::isnan(values.at(1)));
    values.resize(5);
    EXPECT_TRUE(values.is_missing(3) && values.is_missing(4) && !values.is_missing(2));
    values.keep_where({true, false, true, false, false});
    EXPECT_FALSE(values.has_mask()) << "all that are left are there";
    EXPECT_EQ(values, AttributeValues(type, 2));
    const AttributeValues none = AttributeValues::missing(type, 2);
    EXPECT_TRUE(none.is_missing(0) && none.is_missing(1));
    values.resize(2);
    EXPECT_EQ(values, AttributeValues(type, 2));
    values.resize(1);
    EXPECT_EQ(values, AttributeValues(type, 1));
  }
}

TEST(AttributeValues, AreGatheredWithWhatIsMissing) {
  AttributeValues values(std::vector<std::int16_t>{10, 20, 30});
  values.set_missing(1);
  const AttributeValues gathered = values.gather({2, 1, 1, 0});
  EXPECT_EQ(gathered.as<std::int16_t>(), (std::vector<std::int16_t>{30, 0, 0, 10}));
  EXPECT_EQ(gathered.mask(), (std::vector<std::uint8_t>{0, 1, 1, 0}));
  EXPECT_FALSE(values.gather({2, 0}).has_mask());
  EXPECT_EQ(values.take<std::int16_t>().size(), 3U);
  EXPECT_TRUE(values.empty() && !values.has_mask());
}

TEST(AttributeValues, TakeMasksThatFit) {
  const std::vector<std::uint8_t> values{1, 2, 3};
  const AttributeValues some = AttributeValues::with_mask(values, {0, 1, 0});
  EXPECT_EQ(some.as<std::uint8_t>(), (std::vector<std::uint8_t>{1, 0, 3}));
  EXPECT_FALSE(AttributeValues::with_mask(values, {0, 0, 0}).has_mask());
  EXPECT_THROW(AttributeValues::with_mask(values, {0, 1}), Error);
  EXPECT_THROW(AttributeValues::with_mask(std::vector<float>{1, 2, 3}, {0, 1, 0}), Error);
}

/// True if every value of `from` is the same number in `to`.
bool holds(AttributeType to, AttributeType from) {
  const AttributeValues values = extremes_of(from);
  const AttributeValues converted = values.converted(to);
  for (std::size_t i = 0; i < values.size(); ++i)
    if (exact(converted, i) != exact(values, i)) return false;
  return true;
}

TEST(CommonType, IsTheSmallestThatHoldsBoth) {
  for (const AttributeType a : kTypes)
    for (const AttributeType b : kTypes) {
      SCOPED_TRACE(std::string(name_of(a)) + " and " + name_of(b));
      const AttributeType common = common_type(a, b);
      EXPECT_EQ(common, common_type(b, a));
      bool any_holds = false;
      for (const AttributeType type : kTypes) {
        if (!holds(type, a) || !holds(type, b)) continue;
        any_holds = true;
        EXPECT_LE(size_of(common), size_of(type)) << name_of(type);
      }
      if (any_holds)
        EXPECT_TRUE(holds(common, a) && holds(common, b)) << name_of(common);
      else
        EXPECT_EQ(common, float64);
    }
  EXPECT_EQ(common_type(uint8, int8), int16);
  EXPECT_EQ(common_type(uint32, int8), int64);
  EXPECT_EQ(common_type(uint16, float32), float32);
  EXPECT_EQ(common_type(int32, float32), float64);
  EXPECT_EQ(common_type(uint64, int64), float64);
}

TEST(AttributeValues, AppendedBecomeTheCommonTypeWithoutLoss) {
  AttributeValues values(std::vector<std::uint8_t>{0, 255, 7});
  values.set_missing(2);
  values.append(std::vector<std::int32_t>{-2147483648, 2147483647});
  EXPECT_EQ(values.type(), int32);
  EXPECT_EQ(values.mask(), (std::vector<std::uint8_t>{0, 0, 1, 0, 0}));
  EXPECT_EQ(values.as<std::int32_t>(), (std::vector<std::int32_t>{0, 255, 0, -2147483648, 2147483647}));
  values.append(std::vector<double>{0.1, kNan});
  EXPECT_EQ(values.type(), float64);
  EXPECT_FALSE(values.has_mask());
  EXPECT_EQ(values.at(3), -2147483648.0);
  EXPECT_EQ(values.at(5), 0.1);
  EXPECT_TRUE(values.is_missing(2) && values.is_missing(6));
  AttributeValues wide(std::vector<std::int64_t>{(std::int64_t{1} << 62) + 1});
  wide.append(AttributeValues::missing(uint32, 1));
  EXPECT_EQ(wide.as<std::int64_t>()[0], (std::int64_t{1} << 62) + 1) << "not by way of double";
  EXPECT_TRUE(wide.is_missing(1));
}

TEST(AttributeValues, ConvertedAreRoundedAndCutOff) {
  const AttributeValues values(std::vector<double>{-1e300, -0.6, 0.5, 254.4, 1e300, kNan});
  const AttributeValues bytes = values.converted(uint8);
  EXPECT_EQ(bytes.as<std::uint8_t>(), (std::vector<std::uint8_t>{0, 0, 1, 254, 255, 0}));
  EXPECT_EQ(bytes.mask(), (std::vector<std::uint8_t>{0, 0, 0, 0, 0, 1}));
  const AttributeValues wide = values.converted(int64);
  EXPECT_EQ(wide.as<std::int64_t>()[0], std::numeric_limits<std::int64_t>::min());
  EXPECT_EQ(wide.as<std::int64_t>()[4], std::numeric_limits<std::int64_t>::max());
  const AttributeValues floats = values.converted(float32);
  EXPECT_EQ(floats.as<float>()[0], -std::numeric_limits<float>::infinity());
  EXPECT_TRUE(std::isnan(bytes.converted(float32).at(5)));
  EXPECT_EQ(AttributeValues(std::vector<std::uint64_t>{~0ULL}).converted(int8).at(0), 127);
}

TEST(Labels, AreAllIntegersButColoursIntensitiesAndOtherBytes) {
  for (const char* name : {"anything", "red", "label", "gps_time", ""}) {
    for (const AttributeType type : {float32, float64}) EXPECT_FALSE(is_label(name, type)) << name;
    for (const AttributeType type : {int8, int16, int32, uint32, int64, uint64})
      EXPECT_TRUE(is_label(name, type)) << name;
  }
  for (const char* name :
       {"red", "Green", "BLUE", "alpha", "r", "g", "b", "a", "diffuse_red", "ambient_blue", "gray", "grey", "intensity",
        "scalar_Intensity", "Reflectance", "amplitude", "input_red", "input_input_diffuse_green"}) {
    EXPECT_FALSE(is_label(name, uint8)) << name;
    EXPECT_FALSE(is_label(name, uint16)) << name;
  }
  for (const char* name : {"number_of_returns", "quality", "idle", "video", "party", "apart", "width", "redder", "n"}) {
    EXPECT_FALSE(is_label(name, uint8)) << name;
    EXPECT_TRUE(is_label(name, uint16)) << name;
  }
  for (const char* name : {"label",      "scalar_Label", "Classification",  "class",      "segment_3", "instance",
                           "objectness", "material",     "cluster",         "face_index", "id",        "ID",
                           "point_id",   "point-id",     "pointId",         "id2",        "obj.ID",    "part",
                           "body_parts", "part3",        "class_intensity", "input_id"}) {
    EXPECT_TRUE(is_label(name, uint8)) << name;
    EXPECT_TRUE(is_label(name, uint16)) << name;
    EXPECT_FALSE(is_label(name, float32)) << name;
  }
}

}  // namespace
}  // namespace pointskin
