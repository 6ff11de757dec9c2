// Where the camera stands: what fills the picture, axes, zoom, field of view, and what it says of itself.
#include <gtest/gtest.h>

#include <pointskin/camera.hpp>
#include <pointskin/error.hpp>
#include <pointskin/render.hpp>

#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "support/pictures.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::background_of;
using test::covered;
using test::middle;
using test::PixelBox;

constexpr double kDegree = std::numbers::pi / 180;

/// Pixels of a world point by the matrices that camera_of() gives.
Pixel shown(const Camera& camera, const Vec3d& p) {
  double clip[4];
  const double at[4] = {p[0], p[1], p[2], 1};
  double eye[4] = {0, 0, 0, 0};
  for (std::size_t r = 0; r < 4; ++r)
    for (std::size_t c = 0; c < 4; ++c) eye[r] += camera.view[4 * r + c] * at[c];
  for (std::size_t r = 0; r < 4; ++r) {
    clip[r] = 0;
    for (std::size_t c = 0; c < 4; ++c) clip[r] += camera.projection[4 * r + c] * eye[c];
  }
  return {(clip[0] / clip[3] + 1) * camera.width / 2, (1 - clip[1] / clip[3]) * camera.height / 2};
}

struct NamedMesh {
  std::string name;
  Mesh mesh;
};

std::vector<NamedMesh> shapes() {
  return {{"statue", test::box_mesh({-0.05, 0, -0.08}, {0.05, 1, 0.08})},
          {"plank", test::box_mesh({-3, 0, -0.2}, {3, 0.1, 0.2})},
          {"rod towards the viewer", test::box_mesh({-0.1, -0.1, -4}, {0.1, 0.1, 4})},
          {"torus", test::torus_mesh(60, 30)},
          {"corner", test::translated(test::tetrahedron_mesh(), {7, -3, 2})}};
}

TEST(BoxFit, FillsTheLimitingSideAndLeavesAsMuchRoomOnBothSides) {
  for (const NamedMesh& shape : shapes())
    for (const Projection projection : {Projection::perspective, Projection::orthographic})
      for (const auto& [width, height] : {std::pair(300, 200), std::pair(120, 280)})
        for (const auto& [azimuth, elevation] : {std::pair(0.0, 0.0), std::pair(30.0, 20.0), std::pair(-140.0, 65.0)}) {
          RenderOptions options = test::front_view(width, height);
          options.projection = projection;
          options.azimuth_degrees = azimuth;
          options.elevation_degrees = elevation;
          const PixelBox box = covered(render(shape.mesh, options), background_of(options));
          const std::string where = shape.name + (projection == Projection::perspective ? ", perspective" : "") +
                                    ", azimuth " + std::to_string(azimuth) + ", width " + std::to_string(width);
          // A pixel that is touched counts whole, and one that is touched little may not be seen.
          EXPECT_NEAR(std::max(box.width() - kRenderFill * width, box.height() - kRenderFill * height), 0, 2.5)
              << where;
          EXPECT_NEAR(box.left, width - 1 - box.right, 2.5) << where;
          EXPECT_NEAR(box.top, height - 1 - box.bottom, 2.5) << where;
        }
}

TEST(BoxFit, ShowsATallThingSeveralTimesAsLargeAsTheSphereWouldInAPortraitPicture) {
  const Mesh statue = test::box_mesh({-0.05, 0, -0.05}, {0.05, 1, 0.05});
  RenderOptions options = test::front_view(100, 800);
  const int box = covered(render(statue, options), background_of(options)).height();
  options.fit = Fit::sphere;
  const int sphere = covered(render(statue, options), background_of(options)).height();
  EXPECT_GT(box, 7 * sphere);
}

TEST(BoxFit, CountsOnlyVerticesOfTriangles) {
  Mesh mesh = test::icosphere_mesh(2);
  const Image alone = render(mesh, test::front_view());
  mesh.vertices.push_back({100, 0, 0});
  mesh.normals.push_back({1, 0, 0});
  EXPECT_EQ(test::differing(render(mesh, test::front_view()), alone), 0);
}

TEST(SphereFit, StandsAtTheSameDistanceFromEverySide) {
  // A box of half diagonal R about its middle c: the viewer is R / sin(14 degrees) away from c, and the sphere fills
  // kRenderFill of the shorter side.
  const Mesh mesh = test::box_mesh({1, 2, 3}, {2, 4, 6});
  const double radius = std::sqrt(1.0 + 4 + 9) / 2;
  for (const double azimuth : {0.0, 77.0, 200.0}) {
    RenderOptions options;
    options.fit = Fit::sphere;
    options.azimuth_degrees = azimuth;
    const Camera camera = camera_of(mesh, options);
    double depth = camera.view[11];
    const Vec3d centre{1.5, 3, 4.5};
    for (std::size_t a = 0; a < 3; ++a) depth += camera.view[8 + a] * centre[a];
    EXPECT_NEAR(-depth, radius / std::sin(14 * kDegree), 1e-6);
    EXPECT_NEAR(camera.projection[5], kRenderFill / std::tan(14 * kDegree), 1e-9);
    EXPECT_NEAR(camera.projection[0], camera.projection[5] * 900 / 1200, 1e-9);
    const Pixel middle = shown(camera, centre);
    EXPECT_NEAR(middle[0], 600, 1e-6);
    EXPECT_NEAR(middle[1], 450, 1e-6);
  }
}

TEST(Target, IsInTheMiddleOfThePictureWithBothFits) {
  const Mesh mesh = test::box_mesh({0, 0, 0}, {1, 2, 3});
  const Vec3d target{1, 2, 3};
  for (const Fit fit : {Fit::box, Fit::sphere})
    for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
      RenderOptions options;
      options.fit = fit;
      options.projection = projection;
      options.target_world = target;
      const Pixel at = shown(camera_of(mesh, options), target);
      EXPECT_NEAR(at[0], 600, 1e-6);
      EXPECT_NEAR(at[1], 450, 1e-6);
    }
}

TEST(Zoom, EnlargesThePictureAndLeavesTheViewerWhereItIs) {
  const Mesh mesh = test::torus_mesh(40, 20);
  RenderOptions options = test::front_view(300, 300);
  options.projection = Projection::perspective;
  const Camera plain = camera_of(mesh, options);
  options.zoom = 2.5;
  const Camera zoomed = camera_of(mesh, options);
  EXPECT_EQ(zoomed.view, plain.view);
  EXPECT_NEAR(zoomed.projection[0], 2.5 * plain.projection[0], 1e-12);
  options.zoom = 0.5;
  EXPECT_NEAR(covered(render(mesh, options), background_of(options)).width(), kRenderFill * 150, 2);
}

TEST(Zoom, OfAThousandShowsAFaceWithoutGaps) {
  RenderOptions options = test::front_view(300, 200);
  options.shadows = false;
  options.azimuth_degrees = 20;
  options.target_world = Vec3d{0.4, 0.4, 1};
  options.zoom = 1000;
  for (const Projection projection : {Projection::perspective, Projection::orthographic}) {
    options.projection = projection;
    const Image image = render(test::box_mesh(), options);
    const Image same{300, 200, std::vector<std::uint8_t>(image.rgb)};
    EXPECT_LT(test::difference(middle(image), test::pixel(image, 0, 0)), 2);
    for (int y = 0; y < 200; ++y)
      for (int x = 0; x < 300; ++x) ASSERT_LT(test::difference(test::pixel(image, x, y), middle(image)), 2) << x << y;
  }
}

TEST(FieldOfView, IsTheVerticalOneInDegrees) {
  const Mesh mesh = test::torus_mesh(40, 20);
  for (const Fit fit : {Fit::box, Fit::sphere}) {
    RenderOptions options;
    options.fit = fit;
    EXPECT_NEAR(2 * std::atan(1 / camera_of(mesh, options).projection[5]) / kDegree, 30.3, 0.05);
    for (const double degrees : {10.0, 60.0, 120.0}) {
      options.field_of_view_degrees = degrees;
      EXPECT_NEAR(camera_of(mesh, options).projection[5], 1 / std::tan(degrees * kDegree / 2), 1e-12);
      const PixelBox box = covered(render(mesh, options), background_of(options));
      EXPECT_LE(box.height(), 900 * kRenderFill + 3) << degrees;
      EXPECT_LE(box.width(), 1200 * kRenderFill + 3) << degrees;
      EXPECT_GT(box.count, 0);
    }
  }
}

TEST(CameraOf, IsTheCameraOfThePictureAlsoBesideAScaleOfColours) {
  Mesh mesh = test::torus_mesh(60, 30);
  std::vector<float> heights;
  for (const Vec3f& v : mesh.vertices) heights.push_back(v.z);
  mesh.attributes.push_back({"height", heights});
  mesh.origin = {100, 200, 300};
  for (const std::string name : {"", "height"}) {
    RenderOptions options;
    options.width = 400;
    options.height = 300;
    options.colour_by = name;
    const Camera camera = camera_of(mesh, options);
    EXPECT_NO_THROW(validate(camera));
    double left = 1e9, right = -1e9;
    for (const Vec3f& v : mesh.vertices) {
      const double x = shown(camera, {100 + double{v.x}, 200 + double{v.y}, 300 + double{v.z}})[0];
      left = std::min(left, x);
      right = std::max(right, x);
    }
    options.colour_bar = true;
    Image image = render(mesh, options);
    // What the scale covers is not of the torus.
    PixelBox box;
    const Image empty = background_of(options);
    for (int y = 0; y < 300; ++y)
      for (int x = 0; x < (name.empty() ? 400 : 325); ++x)
        if (test::difference(test::pixel(image, x, y), test::pixel(empty, x, y)) > 2)
          box = {std::min(box.left, x), 0, std::max(box.right, x), 0, 1};
    EXPECT_NEAR(box.left, left, 1.5) << name;
    EXPECT_NEAR(box.right, right, 1.5) << name;
  }
}

TEST(UpAxes, StandUprightWithTheDocumentedFront) {
  struct Expected {
    UpAxis up;
    Vec3d right, upwards, front;
  };
  const std::vector<Expected> all = {
      {UpAxis::y, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}},         {UpAxis::z, {1, 0, 0}, {0, 0, 1}, {0, -1, 0}},
      {UpAxis::x, {0, -1, 0}, {1, 0, 0}, {0, 0, 1}},        {UpAxis::minus_x, {0, 1, 0}, {-1, 0, 0}, {0, 0, 1}},
      {UpAxis::minus_y, {1, 0, 0}, {0, -1, 0}, {0, 0, -1}}, {UpAxis::minus_z, {1, 0, 0}, {0, 0, -1}, {0, 1, 0}}};
  for (const Expected& expected : all) {
    RenderOptions options = test::front_view();
    options.up = expected.up;
    const Camera camera = camera_of(test::box_mesh(), options);
    const Vec3d* rows[3] = {&expected.right, &expected.upwards, &expected.front};
    for (std::size_t r = 0; r < 3; ++r)
      for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(camera.view[4 * r + a], (*rows[r])[a], 1e-12) << r << a;
    // From above, what is up faces the viewer.
    options.elevation_degrees = 90;
    const Camera above = camera_of(test::box_mesh(), options);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(above.view[8 + a], expected.upwards[a], 1e-12);
  }
}

TEST(FitWorld, GivesDifferentThingsOneCamera) {
  RenderOptions options;
  const Mesh small = test::icosphere_mesh(2), moved = test::icosphere_mesh(2, 0.5, {2, 1, 0});
  EXPECT_NE(camera_of(small, options).view, camera_of(moved, options).view);
  options.fit_world = WorldBox{{-1, -1, -1}, {3, 2, 1}};
  EXPECT_EQ(camera_of(small, options).view, camera_of(moved, options).view);
  EXPECT_EQ(camera_of(small, options).projection, camera_of(moved, options).projection);
  const std::optional<WorldBox> box = fitted_box(moved);
  ASSERT_TRUE(box);
  EXPECT_NEAR(box->lower[0], 1.5, 0.01);
  EXPECT_NEAR(box->upper[1], 1.5, 0.01);
  EXPECT_FALSE(fitted_box(Mesh{}));
}

TEST(RenderOptions, OutOfRangeAreUsageErrors) {
  const auto code = [](const auto& change) {
    RenderOptions options = test::front_view(20, 20);
    change(options);
    try {
      render(test::box_mesh(), options);
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode{0};
  };
  const double nan = std::numeric_limits<double>::quiet_NaN();
  for (const double zoom : {0.0, -1.0, 1001.0, nan})
    EXPECT_EQ(code([&](RenderOptions& o) { o.zoom = zoom; }), ErrorCode::usage) << zoom;
  for (const double fov : {0.0, 171.0, nan})
    EXPECT_EQ(code([&](RenderOptions& o) { o.field_of_view_degrees = fov; }), ErrorCode::usage) << fov;
  for (const double size : {-1.0, 1001.0, nan})
    EXPECT_EQ(code([&](RenderOptions& o) { o.point_size = size; }), ErrorCode::usage) << size;
  EXPECT_EQ(code([&](RenderOptions& o) { o.point_size_world = -1; }), ErrorCode::usage);
  EXPECT_EQ(code([&](RenderOptions& o) { o.range = ValueRange{2, 1}; }), ErrorCode::usage);
  EXPECT_EQ(code([&](RenderOptions& o) { o.range = ValueRange{0, nan}; }), ErrorCode::usage);
  EXPECT_EQ(code([&](RenderOptions& o) { o.zoom = 1000; }), ErrorCode{0});
}

}  // namespace
}  // namespace pointskin
