// What is drawn over a picture: letters, rings, lines.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <string>
#include <vector>

#include "render/canvas.hpp"
#include "support/pictures.hpp"

namespace pointskin::render_detail {
namespace {

Image blank(int width, int height, std::uint8_t tone = 255) {
  return {width, height, std::vector<std::uint8_t>(static_cast<std::size_t>(3 * width * height), tone)};
}

/// Where `words` leave ink on white.
test::PixelBox ink_of(const std::string& words, double height, std::vector<std::uint8_t>* bytes = nullptr) {
  Image image = blank(200, 100);
  Canvas(image).text({50, 60}, words, {height, {{0, 0, 0}, 1}});
  if (bytes != nullptr) *bytes = image.rgb;
  return test::covered(image, blank(200, 100));
}

TEST(Letters, AllHaveAShapeOfTheirOwn) {
  std::vector<std::vector<std::uint8_t>> shapes;
  for (char c = '!'; c <= '~'; ++c) {
    std::vector<std::uint8_t> bytes;
    EXPECT_GT(ink_of(std::string(1, c), 20, &bytes).count, 5) << c;
    for (const std::vector<std::uint8_t>& other : shapes) EXPECT_NE(bytes, other) << c;
    shapes.push_back(bytes);
  }
  EXPECT_EQ(ink_of(" ", 20).count, 0);
  EXPECT_GT(ink_of("\xC2\xB5", 20).count, 5);  // a box for what the font does not have
}

TEST(Letters, StandOnTheBaselineAndGrowWithTheirHeight) {
  for (const double height : {8.0, 14.0, 40.0}) {
    const test::PixelBox box = ink_of("H", height);
    EXPECT_NEAR(box.height(), height + std::max(1.25, 1.7 * height / 14), 2) << height;
    EXPECT_NEAR(box.bottom, 60, 1 + height / 14) << height;
  }
  EXPECT_NEAR(text_width("density", 28), 2 * text_width("density", 14), 1e-9);
  EXPECT_GT(ink_of("p", 20).bottom, ink_of("o", 20).bottom + 3);  // below the baseline
  EXPECT_LT(ink_of("o", 20).height(), ink_of("O", 20).height() - 3);
}

TEST(Letters, AreAlignedAtTheirEnds) {
  for (const auto& [align, wanted] :
       {std::pair(Align::left, 100.0), std::pair(Align::middle, 100 - text_width("MM", 20) / 2),
        std::pair(Align::right, 100 - text_width("MM", 20))}) {
    Image image = blank(200, 60);
    Canvas(image).text({100, 40}, "MM", {20, {{0, 0, 0}, 1}}, align);
    EXPECT_NEAR(test::covered(image, blank(200, 60)).left, wanted, 1.6);
  }
}

TEST(Letters, AreReadOnDarkGroundByTheirHalo) {
  Image image = blank(100, 60, 0);
  Canvas(image).text({20, 40}, "H", {20, {{0, 0, 0}, 1}, {{1, 1, 1}, 0.75}});
  EXPECT_GT(test::covered(image, blank(100, 60, 0)).count, 50);
}

TEST(Ring, HasTheRadiusAndTheWidthOfItsLine) {
  Image image = blank(101, 101);
  Canvas(image).ring({50.5, 50.5}, 30, 4, {{0, 0, 0}, 1});
  const test::PixelBox box = test::covered(image, blank(101, 101));
  EXPECT_NEAR(box.width(), 64, 1);
  EXPECT_EQ(test::pixel(image, 50, 50)[0], 255);
  EXPECT_EQ(test::pixel(image, 80, 50)[0], 0);
  EXPECT_NEAR(box.count, 2 * 3.14159 * 30 * 4, 2 * 3.14159 * 2 * 30);
}

TEST(Canvas, StaysWithinThePicture) {
  Image image = blank(20, 10);
  Canvas canvas(image);
  canvas.ring({0, 0}, 15, 40, {{0, 0, 0}, 1});
  canvas.line({{-100, 5}, {100, 5}}, 3, {{0, 0, 0}, 1});
  canvas.text({-30, 500}, "outside", {14, {{0, 0, 0}, 1}});
  canvas.fill({{-5, -5}, {50, 50}}, 3, {{0, 0, 0}, 1});
  canvas.triangle({{{-10, -10}, {40, -10}, {10, 40}}}, {{0, 0, 0}, 1});
  EXPECT_EQ(image.rgb.size(), 600U);
  EXPECT_EQ(test::pixel(image, 10, 5)[0], 0);
}

TEST(Triangle, CoversItsInsideWhicheverWayItsCornersRun) {
  for (const bool turned : {false, true}) {
    Image image = blank(60, 60);
    std::array<Place, 3> corners = {{{10, 10}, {50, 10}, {30, 50}}};
    if (turned) std::swap(corners[0], corners[1]);
    Canvas(image).triangle(corners, {{0, 0, 0}, 1});
    EXPECT_EQ(test::pixel(image, 30, 25)[0], 0);
    EXPECT_EQ(test::pixel(image, 12, 45)[0], 255);
    EXPECT_NEAR(test::covered(image, blank(60, 60)).count, 800, 100);
  }
}

}  // namespace
}  // namespace pointskin::render_detail
