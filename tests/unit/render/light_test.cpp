// Light: hollows, shadows, smooth outlines, edges of meshes.
#include <gtest/gtest.h>

#include <pointskin/render.hpp>

#include <cmath>
#include <set>
#include <vector>

#include "support/pictures.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::background_of;
using test::differing;
using test::front_view;
using test::lightness;
using test::middle;
using test::pixel;

/// A square plate [-1, 1]^2 at z = 0, and over it, at `height`, a small one of half side 0.3.
Mesh plates(double height) {
  Mesh mesh = test::translated(test::patch_mesh(8, 2), {-1, -1, 0});
  test::append(mesh, test::translated(test::patch_mesh(4, 0.6, height), {-0.3F, -0.3F, 0}));
  return mesh;
}

TEST(Shadows, FallToTheLowerRightOfWhatIsInTheLight) {
  RenderOptions options = front_view(300, 300);
  const Image with = render(plates(0.5), options);
  options.shadows = false;
  const Image without = render(plates(0.5), options);
  // The light comes from (-0.55, 0.70, 0.65): at half a unit of depth the shadow is moved by (0.42, -0.54).
  const double scale = kRenderFill * 150;
  const auto at = [&](double x, double y) {
    return std::pair(static_cast<int>(150 + scale * x), static_cast<int>(150 - scale * y));
  };
  const auto [shadow_x, shadow_y] = at(0.5, -0.62);
  const auto [lit_x, lit_y] = at(-0.8, 0.8);
  EXPECT_LT(lightness(pixel(with, shadow_x, shadow_y)), lightness(pixel(without, shadow_x, shadow_y)) - 25);
  EXPECT_NEAR(lightness(pixel(with, lit_x, lit_y)), lightness(pixel(without, lit_x, lit_y)), 6);
  EXPECT_EQ(lightness(middle(with)), lightness(middle(without)));  // nothing is over the small plate
}

TEST(Hollows, AreDarkerThanWhatIsOpen) {
  // A right-angled fold, seen along its bisector: the light falls off towards the fold.
  Mesh fold;
  fold.vertices = {{-1, -1, 1}, {0, -1, 0}, {1, -1, 1}, {-1, 1, 1}, {0, 1, 0}, {1, 1, 1}};
  fold.triangles = {{0, 1, 4}, {0, 4, 3}, {1, 2, 5}, {1, 5, 4}};
  RenderOptions options = front_view(300, 300);
  const Image with = render(fold, options);
  options.shadows = false;
  const Image without = render(fold, options);
  const auto loss = [&](int x) { return lightness(pixel(without, x, 150)) - lightness(pixel(with, x, 150)); };
  EXPECT_GT(loss(155), 10);
  EXPECT_GT(loss(155), loss(250) + 8);
  EXPECT_EQ(without.rgb[0], with.rgb[0]);
}

TEST(Outlines, HaveThreeTonesBetweenTheSurfaceAndTheBackground) {
  // An edge that leans by one pixel in a hundred passes through every share of four samples.
  Mesh mesh;
  mesh.vertices = {{-1, -1, 0}, {0.01F, -1, 0}, {-0.01F, 1, 0}, {-1, 1, 0}};
  mesh.triangles = {{0, 1, 2}, {0, 2, 3}};
  RenderOptions options = front_view(200, 200);
  options.shadows = false;
  options.target_world = Vec3d{0, 0, 0};
  const Image image = render(mesh, options);
  std::set<int> tones;
  for (int x = 90; x < 110; ++x)
    for (int y = 60; y < 140; ++y) {
      const int inside = lightness(pixel(image, 40, y)), outside = lightness(pixel(image, 180, y));
      const int share = 4 * (lightness(pixel(image, x, y)) - inside);
      tones.insert((share + (outside - inside) / 2) / std::max(1, outside - inside));
    }
  EXPECT_GE(tones.size(), 4U);
}

TEST(Wireframe, DrawsEdgesOverFacesAndHidesThoseBehind) {
  RenderOptions options = front_view(300, 300);
  options.shadows = false;
  const Mesh plate = test::translated(test::patch_mesh(2, 2), {-1, -1, 0});
  const Image plain = render(plate, options);
  options.wireframe = true;
  const Image lines = render(plate, options);
  EXPECT_LT(lightness(middle(lines)), lightness(middle(plain)) - 25);  // four squares meet there
  EXPECT_EQ(pixel(lines, 130, 100), pixel(plain, 130, 100));           // within a triangle
  EXPECT_LT(lightness(pixel(lines, 150, 90)), lightness(pixel(plain, 150, 90)) - 25);
  Mesh both = plate;
  test::append(both, test::translated(test::patch_mesh(7, 1), {-0.5F, -0.5F, -0.5F}));
  EXPECT_EQ(differing(render(both, options), lines), 0);
}

TEST(Wireframe, FadesWhereTrianglesAreSmallerThanLines) {
  RenderOptions options = front_view(120, 120);
  const Mesh sphere = test::icosphere_mesh(6);
  const Image plain = render(sphere, options);
  options.wireframe = true;
  EXPECT_NEAR(lightness(middle(render(sphere, options))), lightness(middle(plain)), 25);
}

TEST(RenderReport, CountsWhatIsSeenFromBehind) {
  RenderOptions options = front_view(200, 200);
  RenderReport report;
  render(test::icosphere_mesh(4), options, &report);
  EXPECT_EQ(report.behind, 0);
  const double disc = 3.14159265 / 4 * kRenderFill * kRenderFill;
  EXPECT_NEAR(report.covered, disc, 0.01);
  render(test::flipped(test::icosphere_mesh(4)), options, &report);
  EXPECT_EQ(report.behind, 1);
  // Two squares side by side, one of them turned over.
  Mesh mesh = test::patch_mesh(3);
  test::append(mesh, test::translated(test::flipped(test::patch_mesh(3)), {1.1F, 0, 0}));
  render(mesh, options, &report);
  EXPECT_NEAR(report.behind, 0.5, 0.02);
  options.back_faces = false;
  render(mesh, options, &report);
  EXPECT_EQ(report.behind, 0);
  render(Mesh{}, options, &report);
  EXPECT_EQ(report.covered, 0);
  EXPECT_EQ(report.behind, 0);
}

TEST(LargePictures, LookLikeSmallOnes) {
  // The map of light has fewer cells than a large picture has pixels.
  const Mesh mesh = test::torus_mesh(60, 30);
  RenderOptions options = front_view(2400, 1800);
  const Image large = render(mesh, options);
  options.width = 300;
  options.height = 225;
  const Image small = render(mesh, options);
  int worst = 0;
  for (int y = 10; y < 215; ++y)
    for (int x = 10; x < 290; ++x) {
      int sum = 0, least = 255, most = 0;
      for (int k = 0; k < 64; ++k) {
        const int tone = lightness(pixel(large, 8 * x + k % 8, 8 * y + k / 8));
        sum += tone;
        least = std::min(least, tone);
        most = std::max(most, tone);
      }
      if (most - least < 12) worst = std::max(worst, std::abs(sum / 64 - lightness(pixel(small, x, y))));
    }
  EXPECT_LT(worst, 20);
}

}  // namespace
}  // namespace pointskin
