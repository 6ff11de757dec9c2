// Colours by values: maps, ranges, what has no value, and the scale beside the picture.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/render.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "render/colour_map.hpp"
#include "render/ticks.hpp"
#include "support/pictures.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using render_detail::Colour;
using render_detail::diverging_colour;
using render_detail::sequential_colour;
using test::background_of;
using test::covered;
using test::front_view;
using test::middle;
using test::pixel;

/// CIE 1976 lightness of linear sRGB, 0 to 100.
double lightness(const Colour& c) {
  const double y = 0.2126 * c[0] + 0.7152 * c[1] + 0.0722 * c[2];
  return y > 216.0 / 24389 ? 116 * std::cbrt(y) - 16 : y * 24389 / 27;
}

/// As someone without green cones sees it: Vienot, Brettel & Mollon, "Digital video colourmaps for checking the
/// legibility of displays by dichromats", Color Research & Application 24(4), 1999.
Colour seen_by_deuteranope(const Colour& c) {
  const double red_green = 0.29275 * c[0] + 0.70725 * c[1];
  return {red_green, red_green, -0.02234 * c[0] + 0.02234 * c[1] + c[2]};
}

TEST(SequentialMap, GrowsLighterInEvenSteps) {
  constexpr int kSteps = 16;
  double least = 1e9, most = 0;
  for (int i = 0; i < kSteps; ++i) {
    const double step =
        lightness(sequential_colour((i + 1.0) / kSteps)) - lightness(sequential_colour(1.0 * i / kSteps));
    least = std::min(least, step);
    most = std::max(most, step);
  }
  EXPECT_GT(least, 2.5);
  EXPECT_LT(most, 2 * least);
  EXPECT_LT(lightness(sequential_colour(0)), 25);
  EXPECT_GT(lightness(sequential_colour(1)), 85);
}

TEST(Maps, DoNotNeedEyesForRedAndGreen) {
  for (int i = 0; i < 16; ++i) {
    const Colour a = seen_by_deuteranope(sequential_colour(i / 16.0));
    const Colour b = seen_by_deuteranope(sequential_colour((i + 1) / 16.0));
    EXPECT_GT(lightness(b), lightness(a) + 1.5) << i;
  }
  // The two ends of the other differ in what is left of their hues.
  const Colour low = seen_by_deuteranope(diverging_colour(-1)), high = seen_by_deuteranope(diverging_colour(1));
  EXPECT_GT(low[2], 2 * low[0]);
  EXPECT_GT(high[0], 2 * high[2]);
}

TEST(DivergingMap, IsLightAtZeroAndEquallyStrongOnBothSides) {
  EXPECT_GT(lightness(diverging_colour(0)), 90);
  for (const double t : {0.25, 0.5, 0.75, 1.0}) {
    EXPECT_NEAR(lightness(diverging_colour(-t)), lightness(diverging_colour(t)), 6) << t;
    EXPECT_LT(lightness(diverging_colour(t)), lightness(diverging_colour(t - 0.25)) - 4) << t;
    EXPECT_GT(diverging_colour(-t)[2], diverging_colour(-t)[0]);  // blue
    EXPECT_GT(diverging_colour(t)[0], diverging_colour(t)[2]);    // orange
  }
}

/// The square [0, 1]^2 of 50 x 50 cells, with a value at every vertex.
template <class Value>
Mesh square_with(const Value& value) {
  Mesh mesh = test::patch_mesh(50);
  std::vector<float> values;
  for (const Vec3f& v : mesh.vertices) values.push_back(static_cast<float>(value(v)));
  mesh.attributes.push_back({"value", values});
  return mesh;
}

RenderOptions by_value(int width = 200, int height = 150) {
  RenderOptions options = front_view(width, height);
  options.colour_by = "value";
  options.colour_bar = false;
  return options;
}

/// Linear colour of a pixel, made as bright as `like`: light does not change hues.
Colour hue_of(const test::Rgb& p, const Colour& like) {
  Colour c{};
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) sum += c[k] = render_detail::decode_srgb(p[k] / 255.0);
  return c * ((like[0] + like[1] + like[2]) / sum);
}

TEST(ColourBy, GivesEveryValueTheColourOfTheMap) {
  RenderOptions options = by_value();
  options.range = ValueRange{0, 1};
  const Image image = render(square_with([](const Vec3f& v) { return v.x; }), options);
  const double side = kRenderFill * 150;
  for (const double t : {0.1, 0.4, 0.6, 0.9}) {
    const int x = static_cast<int>(100 + (t - 0.5) * side);
    const Colour expected = sequential_colour((x + 0.5 - 100) / side + 0.5);
    const Colour seen = hue_of(pixel(image, x, 75), expected);
    for (std::size_t k = 0; k < 3; ++k) EXPECT_NEAR(seen[k], expected[k], 0.03) << t << " " << k;
  }
}

TEST(ColourBy, DrawsWhatHasNoValueInNeutralGrey) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const Mesh mesh = square_with([&](const Vec3f& v) { return v.x < 0.5F ? nan : 1 + v.y; });
  const Image image = render(mesh, by_value());
  const test::Rgb none = pixel(image, 60, 75), some = pixel(image, 140, 75);
  EXPECT_LT(std::abs(none[0] - none[1]) + std::abs(none[1] - none[2]), 4);
  EXPECT_GT(std::abs(some[0] - some[1]) + std::abs(some[1] - some[2]), 40);
}

TEST(ColourBy, RefusesAnUnknownNameAndListsTheOthers) {
  Mesh mesh = square_with([](const Vec3f&) { return 1; });
  mesh.attributes.push_back({"density", mesh.attributes[0].values});
  RenderOptions options = by_value();
  options.colour_by = "valu";
  try {
    render(mesh, options);
    FAIL();
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::usage);
    for (const char* part : {"mesh", "'valu'", "value", "density", "x, y, z"})
      EXPECT_NE(std::string(error.what()).find(part), std::string::npos) << error.what();
  }
  Cloud cloud = test::plane_cloud(10, 1);
  EXPECT_THROW(render(cloud, options), Error);
}

TEST(ColourBy, WorksForPointsAndForCoordinates) {
  Cloud cloud = test::plane_cloud(20'000, 1);
  cloud.origin = {5e6, 0, 0};
  RenderOptions options = by_value();
  options.colour_by = "x";
  RenderReport report;
  const Image image = render(cloud, options, &report);
  ASSERT_TRUE(report.range);
  EXPECT_NEAR(report.range->low, 5e6 - 0.98, 0.02);
  EXPECT_NEAR(report.range->high, 5e6 + 0.98, 0.02);
  EXPECT_LT(test::lightness(pixel(image, 45, 75)), test::lightness(pixel(image, 155, 75)) - 60);
}

TEST(Range, IsFromTheFirstToTheNinetyNinthPercentileOfFiniteValues) {
  Cloud cloud;
  std::vector<float> values;
  for (int i = 0; i <= 1000; ++i) {
    cloud.positions.push_back({static_cast<float>(i), 0, 0});
    values.push_back(static_cast<float>(i * 37 % 1001));  // 0 to 1000 in another order
  }
  for (const float wild : {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
    cloud.positions.push_back({0, 1, 0});
    values.push_back(wild);
  }
  cloud.attributes = {{"value", values}};
  std::optional<ValueRange> range = value_range(cloud, "value");
  ASSERT_TRUE(range);
  EXPECT_EQ(range->low, 10);
  EXPECT_EQ(range->high, 990);
  // All but one are the same: from the smallest to the largest.
  std::fill(values.begin(), values.end(), 3.0F);
  values[5] = 8;
  cloud.attributes = {{"value", values}};
  range = value_range(cloud, "value");
  EXPECT_EQ(range->low, 3);
  EXPECT_EQ(range->high, 8);
  std::fill(values.begin(), values.end(), std::numeric_limits<float>::quiet_NaN());
  cloud.attributes = {{"value", values}};
  EXPECT_FALSE(value_range(cloud, "value"));
  EXPECT_NO_THROW(render(cloud, by_value()));
}

TEST(Range, KeepsTheDigitsOfTimesAndLabels) {
  Cloud cloud;
  std::vector<double> times;
  std::vector<std::int32_t> labels;
  for (int i = 0; i <= 1000; ++i) {
    cloud.positions.push_back({static_cast<float>(i), 0, 0});
    times.push_back(3e8 + 0.001 * i);
    labels.push_back((1 << 25) + i);
  }
  cloud.attributes = {{"gps_time", times}, {"label", labels}};
  EXPECT_NEAR(value_range(cloud, "gps_time")->low, 3e8 + 0.010, 1e-6);
  EXPECT_NEAR(value_range(cloud, "gps_time")->high, 3e8 + 0.990, 1e-6);
  EXPECT_EQ(value_range(cloud, "label")->low, (1 << 25) + 10);
  EXPECT_EQ(value_range(cloud, "label")->high, (1 << 25) + 990);
}

TEST(Range, OfEqualValuesIsWidened) {
  RenderReport report;
  render(square_with([](const Vec3f&) { return 4; }), by_value(), &report);
  ASSERT_TRUE(report.range);
  EXPECT_LT(report.range->low, 4);
  EXPECT_GT(report.range->high, 4);
}

TEST(AutomaticMap, IsDivergingForTwoSignsAlone) {
  const auto middle_of = [](double low, double high, const std::string& name) {
    const Mesh mesh = square_with([&](const Vec3f& v) { return low + (high - low) * static_cast<double>(v.x); });
    RenderOptions options = by_value();
    options.colour_by = name;
    const test::Rgb p = middle(render(mesh, options));
    return std::abs(p[0] - p[2]);  // little for the light grey at 0
  };
  EXPECT_LT(middle_of(-1, 1, "value"), 15);
  EXPECT_GT(middle_of(0, 1, "value"), 25);
  EXPECT_GT(middle_of(-0.05, 1, "value"), 25);
}

TEST(ColourBar, StandsAtTheRightAndMakesRoomForItself) {
  const Mesh mesh = square_with([](const Vec3f& v) { return v.x; });
  RenderOptions options = by_value(600, 450);
  const test::PixelBox without = covered(render(mesh, options), background_of(options));
  options.colour_bar = true;
  const Image image = render(mesh, options), empty = background_of(options);
  int dark = 0, coloured = 0;
  for (int y = 0; y < 450; ++y)
    for (int x = 528; x < 600; ++x) {  // nine letters of eight pixels
      const test::Rgb p = pixel(image, x, y);
      dark += test::lightness(p) < 90 && *std::max_element(p.begin(), p.end()) < 100 ? 1 : 0;
      coloured += *std::max_element(p.begin(), p.end()) - *std::min_element(p.begin(), p.end()) > 60 ? 1 : 0;
    }
  EXPECT_GT(dark, 100);       // name and numbers
  EXPECT_GT(coloured, 1500);  // the map
  for (int y = 0; y < 450; ++y) EXPECT_LT(test::difference(pixel(image, 520, y), pixel(empty, 520, y)), 3) << y;
  EXPECT_NEAR(without.left, 599 - without.right, 1);
  options.colour_by = "";
  EXPECT_EQ(test::differing(render(Mesh{}, options), empty), 0);
}

TEST(ColourBar, IsLeftOutOfTinyPictures) {
  const Mesh mesh = square_with([](const Vec3f& v) { return v.x; });
  RenderOptions options = by_value(150, 100);
  const Image without = render(mesh, options);
  options.colour_bar = true;
  EXPECT_EQ(render(mesh, options).rgb, without.rgb);
}

std::vector<std::string> labels(double low, double high, int most = 6) {
  std::vector<std::string> all;
  for (const render_detail::Tick& tick : render_detail::ticks_of({low, high}, most).ticks) all.push_back(tick.label);
  return all;
}

TEST(Ticks, AreRoundNumbersWithinTheRange) {
  using Labels = std::vector<std::string>;
  EXPECT_EQ(labels(0, 1), (Labels{"0.0", "0.2", "0.4", "0.6", "0.8", "1.0"}));
  EXPECT_EQ(labels(-0.3, 0.3), (Labels{"-0.3", "-0.2", "-0.1", "0.0", "0.1", "0.2", "0.3"}));
  EXPECT_EQ(labels(3, 97), (Labels{"20", "40", "60", "80"}));
  EXPECT_EQ(labels(1000.02, 1000.08),
            (Labels{"1000.02", "1000.03", "1000.04", "1000.05", "1000.06", "1000.07", "1000.08"}));
  EXPECT_EQ(labels(1.2e6, 1.1e7), (Labels{"2", "4", "6", "8", "10"}));
  EXPECT_EQ(render_detail::ticks_of({1.2e6, 1.1e7}, 6).exponent, 6);
  EXPECT_EQ(labels(0, 0.00004), (Labels{"0", "10", "20", "30", "40"}));
  EXPECT_EQ(render_detail::ticks_of({0, 0.00004}, 6).exponent, -6);
  // Coordinates of a map keep their digits instead.
  EXPECT_EQ(labels(6543210.5, 6543211.5), (Labels{"6543210.6", "6543210.8", "6543211.0", "6543211.2", "6543211.4"}));
}

}  // namespace
}  // namespace pointskin
