#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/render.hpp>

#include <array>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <limits>
#include <numbers>
#include <string>

#include "support/pictures.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::differing;
using test::front_view;
using test::middle;
using test::pixel;
using Pixel = test::Rgb;

/// The square [-1, 1]^2 at height z, facing +z, all of one colour.
Mesh coloured_square(float z, int red, int green, int blue) {
  Mesh mesh = test::translated(test::patch_mesh(1, 2), {-1, -1, z});
  const std::array<std::pair<const char*, int>, 3> channels{{{"red", red}, {"green", green}, {"blue", blue}}};
  for (const auto& [name, value] : channels)
    mesh.attributes.push_back({name, std::vector<std::uint8_t>(4, static_cast<std::uint8_t>(value))});
  return mesh;
}

/// Both in one mesh, `first` listed first.
Mesh together(const Mesh& first, const Mesh& second) {
  Mesh mesh = first;
  test::append(mesh, second);
  for (std::size_t a = 0; a < mesh.attributes.size(); ++a)
    mesh.attributes[a].values.append(second.attributes[a].values);
  return mesh;
}

ErrorCode code_of(const Mesh& mesh, const RenderOptions& options) {
  try {
    render(mesh, options);
  } catch (const Error& error) {
    return error.code();
  }
  return ErrorCode{0};
}

TEST(Render, DrawsASphereAsADiscOfTheDocumentedSize) {
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    RenderOptions options = front_view(320, 300);
    options.projection = projection;
    const Image empty = render(Mesh{}, options);
    const Image image = render(test::icosphere_mesh(5, 7, {1, 2, 3}), options);
    const double r = kRenderFill * 300 / 2;
    // Pixels that the outline crosses count whole: at most one more for every pixel of the outline's length.
    EXPECT_NEAR(differing(image, empty), std::numbers::pi * r * r, 2 * std::numbers::pi * r);
    EXPECT_NE(pixel(image, 160 + static_cast<int>(r) - 2, 150), pixel(empty, 160 + static_cast<int>(r) - 2, 150));
    EXPECT_EQ(pixel(image, 160 + static_cast<int>(r) + 2, 150), pixel(empty, 160 + static_cast<int>(r) + 2, 150));
  }
}

TEST(Render, LeavesTheBackgroundAtTheCorners) {
  const RenderOptions options = front_view();
  const Image empty = render(Mesh{}, options), image = render(test::icosphere_mesh(3), options);
  for (const int x : {0, 199})
    for (const int y : {0, 149}) EXPECT_EQ(pixel(image, x, y), pixel(empty, x, y));
  EXPECT_GT(pixel(empty, 0, 0)[0], 200);  // light
}

TEST(Render, HidesTheFartherTriangleWhicheverIsListedFirst) {
  const Mesh near_green = coloured_square(0.5F, 0, 255, 0), far_red = coloured_square(-0.5F, 255, 0, 0);
  for (const Projection projection : {Projection::orthographic, Projection::perspective}) {
    RenderOptions options = front_view();
    options.projection = projection;
    for (const Mesh& mesh : {together(near_green, far_red), together(far_red, near_green)}) {
      const Pixel seen = middle(render(mesh, options));
      EXPECT_GT(seen[1], seen[0] + 100);
    }
    options.azimuth_degrees = 180;  // now the red one is near, and both show their backs: the tone is the same
    const Mesh back = together(test::flipped(near_green), test::flipped(far_red));
    const Pixel seen = middle(render(back, options));
    EXPECT_GT(seen[0], seen[1] + 100);
  }
}

TEST(Render, DrawsBackFacesInAnotherTone) {
  RenderOptions options = front_view();
  const Mesh square = test::patch_mesh(4);
  const Pixel front = middle(render(square, options));
  const Pixel back = middle(render(test::flipped(square), options));
  EXPECT_LT(std::abs(front[0] - front[2]), 40);  // clay is nearly grey
  EXPECT_GT(back[0], back[2] + 60);              // backs are red
  options.back_faces = false;
  EXPECT_EQ(differing(render(test::flipped(square), options), render(Mesh{}, options)), 0);
}

TEST(Render, LeavesNoGapsBetweenNeighbours) {
  // A flat patch has one colour; a gap would let the background through.
  RenderOptions options = front_view(300, 300);
  options.azimuth_degrees = 25;
  options.elevation_degrees = 35;
  const Mesh patch = test::patch_mesh(23);
  const Image image = render(patch, options);
  const Pixel colour = middle(image);
  // The patch's inner circle of radius 1/2 in a bounding sphere of radius 1/sqrt(2), foreshortened by the two angles.
  const double r = kRenderFill * 150 / std::numbers::sqrt2 * std::cos(0.44) * std::cos(0.62) * 0.9;
  for (int y = 0; y < 300; ++y)
    for (int x = 0; x < 300; ++x) {
      if (std::hypot(x - 150, y - 150) >= r) continue;
      ASSERT_EQ(pixel(image, x, y), colour) << x << ", " << y;
    }
}

TEST(Render, TintsByVertexColours) {
  const Mesh blue = coloured_square(0, 0, 0, 255);
  RenderOptions options = front_view();
  const Pixel tinted = middle(render(blue, options));
  EXPECT_GT(tinted[2], tinted[0] + 100);
  options.colours = false;
  const Pixel plain = middle(render(blue, options));
  EXPECT_LT(std::abs(plain[2] - plain[0]), 40);
  const auto scaled = [&](AttributeType type, float factor) {
    Mesh mesh = blue;
    for (Attribute& attribute : mesh.attributes) {
      attribute.values = attribute.values.converted(AttributeType::float32);
      for (float& value : attribute.values.edit<float>()) value *= factor;
      attribute.values = attribute.values.converted(type);
    }
    return mesh;
  };
  const Image expected = render(blue, front_view());
  EXPECT_EQ(differing(render(scaled(AttributeType::float32, 1.0F / 255), front_view()), expected), 0);
  EXPECT_EQ(differing(render(scaled(AttributeType::float64, 1), front_view()), expected), 0);
  EXPECT_EQ(differing(render(scaled(AttributeType::uint16, 257), front_view()), expected), 0);
}

TEST(Render, IsBrighterOnTopThanBelow) {
  const Image image = render(test::icosphere_mesh(4), front_view());
  EXPECT_GT(pixel(image, 100, 30)[1], pixel(image, 100, 120)[1] + 20);
}

TEST(Render, TurnsTheUpAxis) {
  Mesh y_up = test::icosphere_mesh(2);
  for (Vec3f& v : y_up.vertices) v = {v.x, 0.5F * v.y, 0.75F * v.z};
  Mesh z_up = y_up;
  for (Vec3f& v : z_up.vertices) v = {v.x, -v.z, v.y};
  for (Vec3f& n : z_up.normals) n = {n.x, -n.z, n.y};
  RenderOptions options;
  options.width = options.height = 200;
  const Image expected = render(y_up, options);
  options.up = UpAxis::z;
  // Sums over the axes run in another order: single samples at an edge may tip over.
  EXPECT_LT(differing(render(z_up, options), expected, 2), 20);
}

TEST(Render, SeesTheRightSideFromTheRight) {
  // A box whose +x side alone is left open shows its inside, in the tone of back faces, from azimuth 90 only.
  Mesh box = test::box_mesh();
  box.triangles.resize(10);
  RenderOptions options = front_view();
  const Pixel front = middle(render(box, options));
  EXPECT_LT(front[0], front[2] + 40);
  options.azimuth_degrees = 90;
  const Pixel right = middle(render(box, options));
  EXPECT_GT(right[0], right[2] + 60);
}

TEST(Render, LeavesOutTrianglesThatAreNotFinite) {
  const Mesh sphere = test::icosphere_mesh(2);
  Mesh mesh = sphere;
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.push_back({std::numeric_limits<float>::quiet_NaN(), 0, 0});
  mesh.vertices.push_back({0, std::numeric_limits<float>::infinity(), 0});
  for (int i = 0; i < 2; ++i) mesh.normals.push_back({0, 0, 1});
  mesh.triangles.push_back({0, 1, first});
  mesh.triangles.push_back({0, 1, first + 1});
  mesh.triangles.push_back({2, 2, 2});
  EXPECT_EQ(differing(render(mesh, front_view()), render(sphere, front_view())), 0);
}

TEST(Render, RejectsWhatItCannotDraw) {
  Mesh bad = test::box_mesh();
  bad.triangles[3][2] = 8;
  EXPECT_EQ(code_of(bad, front_view()), ErrorCode::invalid_input);
  EXPECT_EQ(code_of(Mesh{}, front_view(0, 10)), ErrorCode::usage);
  EXPECT_EQ(code_of(Mesh{}, front_view(10, 16385)), ErrorCode::usage);
  RenderOptions options = front_view();
  options.elevation_degrees = 90.5;
  EXPECT_EQ(code_of(Mesh{}, options), ErrorCode::usage);
  options = front_view();
  options.azimuth_degrees = std::numeric_limits<double>::quiet_NaN();
  EXPECT_EQ(code_of(Mesh{}, options), ErrorCode::usage);
}

TEST(Render, GivesTheSameBytesForAnyNumberOfThreads) {
  RenderOptions options = front_view(161, 97);
  options.threads = 1;
  const Mesh mesh = test::torus_mesh(40, 20);
  const Image one = render(mesh, options);
  for (const int threads : {2, 5}) {
    options.threads = threads;
    EXPECT_EQ(render(mesh, options).rgb, one.rgb) << threads;
  }
}

TEST(WritePng, WritesASignatureAndTheSize) {
  const std::string path = (std::filesystem::temp_directory_path() / "pointskin_render_test.png").string();
  write_png(path, render(test::icosphere_mesh(1), front_view(258, 3)));
  std::ifstream file(path, std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(file)), std::istreambuf_iterator<char>());
  file.close();
  std::filesystem::remove(path);
  ASSERT_GT(bytes.size(), 33U);
  EXPECT_EQ(bytes.substr(0, 8), "\x89PNG\r\n\x1a\n");
  // Width 258 and height 3 as big-endian words, 8 bits a channel, colour type 2 (RGB).
  EXPECT_EQ(bytes.substr(12, 14), std::string("IHDR\0\0\1\2\0\0\0\3\x08\x02", 14));
  EXPECT_EQ(bytes.substr(bytes.size() - 8, 4), "IEND");
}

TEST(WritePng, RejectsBytesThatDoNotFitTheSize) {
  const std::string path = (std::filesystem::temp_directory_path() / "pointskin_render_test_bad.png").string();
  for (const Image& image : {Image{}, Image{2, 2, std::vector<std::uint8_t>(11)}, Image{-1, 2, {}}}) {
    try {
      write_png(path, image);
      FAIL() << image.width;
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
    }
  }
  EXPECT_FALSE(std::filesystem::exists(path));
}

}  // namespace
}  // namespace pointskin
