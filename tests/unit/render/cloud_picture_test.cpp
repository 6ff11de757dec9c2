// Pictures of clouds: discs that are lit, hide each other, and are as large as the points are apart.
#include <gtest/gtest.h>

#include <pointskin/cloud.hpp>
#include <pointskin/render.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "support/pictures.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::background_of;
using test::covered;
using test::differing;
using test::front_view;
using test::middle;
using test::pixel;
using test::PixelBox;
using test::redness;

Cloud without_normals(Cloud cloud) {
  cloud.normals.clear();
  return cloud;
}

Cloud one_point(const Vec3f& normal = {0, 0, 1}) {
  Cloud cloud;
  cloud.positions = {{3, 4, 5}};
  cloud.normals = {normal};
  return cloud;
}

PixelBox box_of(const Cloud& cloud, const RenderOptions& options) {
  return covered(render(cloud, options), background_of(options));
}

TEST(CloudPicture, OfOnePointIsADiscInTheMiddle) {
  for (const Projection projection : {Projection::perspective, Projection::orthographic})
    for (const Cloud& cloud : {one_point(), without_normals(one_point())}) {
      RenderOptions options = front_view(900, 900);
      options.projection = projection;
      const PixelBox box = box_of(cloud, options);
      EXPECT_GT(box.width(), 10);
      EXPECT_EQ(box.width(), box.height());
      EXPECT_NEAR(box.left, 899 - box.right, 1);
      EXPECT_NEAR(box.top, 899 - box.bottom, 1);
      EXPECT_NEAR(box.count, std::numbers::pi / 4 * box.width() * box.width(), 4 * box.width());
    }
}

TEST(CloudPicture, OfPointsAtOnePlaceIsThatOfOne) {
  Cloud many = one_point();
  for (int i = 0; i < 99; ++i) test::append(many, one_point());
  EXPECT_EQ(differing(render(many, front_view()), render(one_point(), front_view())), 0);
}

/// Where no shadows are cast, no normals are worked out from the depths either.
TEST(CloudPicture, WithoutShadowsShowsPointsWhoseNormalSaysNothing) {
  RenderOptions options = front_view(300, 300);
  options.projection = Projection::orthographic;
  options.shadows = false;
  for (const Vec3f& normal : {Vec3f{0, 0, 0}, Vec3f{1, 0, 0}, Vec3f{0, 1, 0}}) {
    const PixelBox box = box_of(one_point(normal), options);
    EXPECT_GT(box.width(), 3);
    EXPECT_NEAR(box.width(), box.height(), 1);
  }
}

TEST(CloudPicture, OfNoPointsIsTheBackground) {
  EXPECT_EQ(differing(render(Cloud{}, front_view()), background_of(front_view())), 0);
}

TEST(CloudPicture, DrawsPointsOfTheGivenSizeInPixels) {
  RenderOptions options = front_view(300, 300);
  for (const double size : {3.0, 20.0, 61.0}) {
    options.point_size = size;
    for (const Cloud& cloud : {one_point(), without_normals(one_point())})
      EXPECT_NEAR(box_of(cloud, options).width(), size, 1.01) << size;
  }
}

TEST(CloudPicture, LaysDiscsAlongTheSurface) {
  // Turned by 60 degrees about the upright axis a disc is half as wide as high.
  RenderOptions options = front_view(300, 300);
  options.point_size = 80;
  const auto turned = static_cast<float>(std::sqrt(3.0) / 2);
  const PixelBox side = box_of(one_point({turned, 0, 0.5F}), options);
  EXPECT_NEAR(side.width(), 40, 2);
  EXPECT_NEAR(side.height(), 80, 2);
  const PixelBox lying = box_of(one_point({0, turned, 0.5F}), options);
  EXPECT_NEAR(lying.width(), 80, 2);
  EXPECT_NEAR(lying.height(), 40, 2);
  EXPECT_GT(box_of(one_point({1, 0, 0}), options).count, 0);  // from its very side it does not vanish
}

/// Two points on the line of sight, of two colours.
Cloud green_before_red(bool green_first) {
  Cloud cloud;
  const std::vector<float> z = green_first ? std::vector<float>{1, -1} : std::vector<float>{-1, 1};
  for (const float depth : z) {
    cloud.positions.push_back({0, 0, depth});
    cloud.normals.push_back({0, 0, 1});
  }
  using Bytes = std::vector<std::uint8_t>;
  const Bytes red = green_first ? Bytes{0, 255} : Bytes{255, 0};
  cloud.attributes = {{"red", red}, {"green", Bytes{red[1], red[0]}}, {"blue", Bytes{0, 0}}};
  return cloud;
}

TEST(CloudPicture, HidesTheFartherPointWhicheverIsListedFirst) {
  RenderOptions options = front_view();
  options.point_size = 30;
  for (const bool green_first : {true, false})
    for (const bool normals : {true, false}) {
      Cloud cloud = green_before_red(green_first);
      if (!normals) cloud.normals.clear();
      options.azimuth_degrees = 0;
      EXPECT_LT(redness(middle(render(cloud, options))), -50);
      options.azimuth_degrees = 180;
      if (normals) options.back_faces = true;
      EXPECT_GT(redness(middle(render(cloud, options))), 50);  // the red one, or the tone of backs
    }
}

TEST(CloudPicture, ShowsPointsThatAreTurnedAwayInTheToneOfBacks) {
  RenderOptions options = front_view();
  options.point_size = 30;
  RenderReport report;
  EXPECT_LT(std::abs(redness(middle(render(one_point(), options, &report)))), 30);
  EXPECT_EQ(report.behind, 0);
  EXPECT_GT(report.covered, 0);
  EXPECT_GT(redness(middle(render(one_point({0, 0, -1}), options, &report))), 60);
  EXPECT_EQ(report.behind, 1);
  options.back_faces = false;
  EXPECT_EQ(differing(render(one_point({0, 0, -1}), options, &report), background_of(options)), 0);
  EXPECT_EQ(report.covered, 0);
  options.back_faces = true;
  options.smooth = false;  // without its normals
  EXPECT_LT(std::abs(redness(middle(render(one_point({0, 0, -1}), options)))), 30);
}

TEST(CloudPicture, CoversASurfaceWithoutGaps) {
  for (const std::int64_t n : {3'000, 100'000}) {
    const Cloud sphere = test::sphere_cloud(n, 5);
    for (const Cloud& cloud : {sphere, without_normals(sphere)}) {
      const RenderOptions options = front_view(300, 300);
      const Image image = render(cloud, options), empty = background_of(options);
      int gaps = 0;
      for (int y = 0; y < 300; ++y)
        for (int x = 0; x < 300; ++x) {
          if (std::hypot(x - 149.5, y - 149.5) > 0.85 * kRenderFill * 150) continue;
          const bool back = redness(pixel(image, x, y)) > 60;
          const bool background = test::difference(pixel(image, x, y), pixel(empty, x, y)) <= 2;
          gaps += back || background ? 1 : 0;
        }
      SCOPED_TRACE(cloud.has_normals() ? "normals" : "no normals");
      // Of points thrown at random, discs of radius 1.15 sqrt(area / n) leave exp(-pi 1.32) = 1.6 % uncovered by those
      // of the front; the spacing is known to a fifth, which makes it 7 %.
      EXPECT_LT(gaps, 0.07 * 0.72 * std::numbers::pi * std::pow(kRenderFill * 150, 2)) << n;
    }
  }
}

TEST(CloudPicture, ShowsTheShapeAlsoWithoutNormals) {
  for (const std::int64_t n : {2'000, 200'000}) {
    const Image image = render(without_normals(test::sphere_cloud(n, 3)), front_view(300, 300));
    const auto mean = [&](int top) {
      int sum = 0;
      for (int y = top; y < top + 30; ++y)
        for (int x = 120; x < 180; ++x) sum += test::lightness(pixel(image, x, y));
      return sum / (30 * 60);
    };
    EXPECT_GT(mean(40), mean(230) + 25) << n;
  }
}

TEST(CloudPicture, DoesNotLetStraysShrinkTheOthers) {
  Cloud cloud = test::sphere_cloud(5'000, 4);
  const RenderOptions options = front_view();
  const PixelBox alone = box_of(cloud, options);
  cloud.positions.push_back({1000, 1000, 1000});
  cloud.normals.push_back({0, 0, 1});
  RenderReport report;
  const PixelBox with = covered(render(cloud, options, &report), background_of(options));
  EXPECT_EQ(with.width(), alone.width());
  EXPECT_EQ(report.strays, 1);
}

TEST(CloudPicture, LeavesOutPointsThatAreNotFinite) {
  const Cloud sphere = test::sphere_cloud(500, 4);
  Cloud cloud = sphere;
  cloud.positions.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  cloud.positions.push_back({0, std::numeric_limits<float>::infinity(), 0});
  for (int i = 0; i < 2; ++i) cloud.normals.push_back({0, 0, 1});
  EXPECT_EQ(differing(render(cloud, front_view()), render(sphere, front_view())), 0);
  cloud = sphere;
  cloud.normals[7] = {0, 0, 0};
  cloud.normals[8] = {std::numeric_limits<float>::quiet_NaN(), 0, 1};
  EXPECT_LT(differing(render(cloud, front_view()), render(sphere, front_view())), 2000);
}

TEST(PointSize, FollowsTheSpacingWhateverTheOrderAndHoweverOftenAPointIsListed) {
  const auto size = [](const Cloud& cloud) {
    RenderReport report;
    render(cloud, front_view(), &report);
    return report.point_size_world;
  };
  for (const std::int64_t n : {500, 20'000}) {
    const double sphere = 2.3 * std::sqrt(4 * std::numbers::pi / static_cast<double>(n));
    EXPECT_NEAR(size(test::sphere_cloud(n, 1)), sphere, 0.25 * sphere) << n;
    const double plane = 2.3 * std::sqrt(4 / static_cast<double>(n));
    EXPECT_NEAR(size(test::plane_cloud(n, 1)), plane, 0.35 * plane) << n;
  }
  const Cloud cloud = test::torus_cloud(5'000, 2);
  Cloud doubled = cloud;
  test::append(doubled, cloud);
  EXPECT_DOUBLE_EQ(size(doubled), size(cloud));
  EXPECT_DOUBLE_EQ(size(test::shuffled(cloud, 3)), size(cloud));
  EXPECT_EQ(size(one_point()), 0);
}

TEST(PointSize, InWorldUnitsGrowsWithTheZoom) {
  RenderOptions options = front_view(300, 300);
  options.fit_world = WorldBox{{-1, -1, -1}, {1, 1, 1}};
  options.point_size_world = 0.2;
  Cloud cloud = one_point();
  cloud.positions = {{0, 0, 0}};
  const double pixels = 0.2 / 2 * kRenderFill * 300;
  EXPECT_NEAR(box_of(cloud, options).width(), pixels, 1.5);
  options.zoom = 3;
  EXPECT_NEAR(box_of(cloud, options).width(), 3 * pixels, 2);
}

TEST(CloudPicture, HasTheSameBytesForAnyNumberOfThreads) {
  for (const bool normals : {true, false}) {
    Cloud cloud = test::torus_cloud(30'000, 9);
    if (!normals) cloud.normals.clear();
    RenderOptions options;
    options.width = 161;
    options.height = 97;
    options.threads = 1;
    const Image one = render(cloud, options);
    for (const int threads : {2, 5}) {
      options.threads = threads;
      EXPECT_EQ(render(cloud, options).rgb, one.rgb) << threads;
    }
  }
}

}  // namespace
}  // namespace pointskin
