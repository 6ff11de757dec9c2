// The picture of a place where a reconstruction is in doubt.
#include <pointskin/camera.hpp>
#include <pointskin/error.hpp>
#include <pointskin/problems.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>

#include "mesh/mesh_checks.hpp"
#include "render/canvas.hpp"
#include "render/colour_bar.hpp"
#include "render/draw.hpp"
#include "render/picture_scale.hpp"

namespace pointskin {
namespace {

using namespace render_detail;

/// Clay where the surface is sound, then from orange to magenta.
Colour weakness_colour(double weakness) {
  constexpr double kSound = 0.1, kWeak = 0.25;  // from the first on a tint, at the second, the default threshold, all
  static const Colour kOrange = from_srgb(1.00, 0.62, 0.12), kMagenta = from_srgb(0.74, 0.02, 0.42);
  const double amount = std::clamp((weakness - kSound) / (kWeak - kSound), 0.0, 1.0);
  const double t = std::clamp((weakness - kWeak) / (1 - kWeak), 0.0, 1.0);
  return mix(clay(), mix(kOrange, kMagenta, t), amount);
}

RenderOptions options_of(const ProblemView& view, const RenderOptions& given) {
  RenderOptions options;
  options.width = given.width;
  options.height = given.height;
  options.up = given.up;
  options.smooth = given.smooth;
  options.back_faces = given.back_faces;
  options.shadows = given.shadows;
  options.threads = given.threads;
  options.azimuth_degrees = view.azimuth_degrees;
  options.elevation_degrees = view.elevation_degrees;
  options.target_world = view.target_world;
  options.fit = Fit::sphere;
  options.zoom = view.zoom;
  return options;
}

/// Radius on the picture of the sphere about the target that holds the region.
double region_pixels(const Mesh& mesh, const ProblemView& view, const RenderOptions& options) {
  constexpr double kHalfFieldOfView = 14 * std::numbers::pi / 180;  // of the view's matrix
  const auto depth_of_target = [&](const std::array<double, 16>& matrix) {
    double z = matrix[11];
    for (std::size_t a = 0; a < 3; ++a) z += matrix[8 + a] * view.target_world[a];
    return -z;
  };
  const double radius = depth_of_target(view.matrix) * std::sin(kHalfFieldOfView);
  const pointskin::Camera camera = camera_of(mesh, options);
  return radius / depth_of_target(camera.view) * camera.projection[5] * options.height / 2;
}

/// A white ring with a dark rim and four marks: it is seen on anything.
void mark(double radius, const RenderOptions& options, Canvas& canvas) {
  const double scale = std::max(0.7, picture_scale(options));
  const Place middle{options.width / 2.0, options.height / 2.0};
  const double largest = 0.47 * std::min(options.width, options.height);
  const double at = std::clamp(1.1 * radius, std::min(18 * scale, largest), largest);
  const double mark = 12 * scale;
  for (const bool rim : {true, false}) {
    const Ink ink = rim ? Ink{{0.08, 0.09, 0.12}, 0.85} : Ink{{1, 1, 1}, 1};
    const double width = (rim ? 6 : 2.6) * scale;
    canvas.ring(middle, at, width, ink);
    for (const auto& [x, y] : {std::pair(1, 0), std::pair(-1, 0), std::pair(0, 1), std::pair(0, -1)})
      canvas.line({{middle.x + x * at, middle.y + y * at}, {middle.x + x * (at + mark), middle.y + y * (at + mark)}},
                  width, ink);
  }
}

/// Lines from the bottom upwards, the first a little larger.
void write_caption(const std::string& caption, const RenderOptions& options, Canvas& canvas) {
  std::vector<std::string> lines;
  std::istringstream text(caption);
  for (std::string line; std::getline(text, line);) lines.push_back(line);
  const double height = std::max(8.0, std::round(15 * picture_scale(options)));
  TextStyle style{height, {{0.13, 0.15, 0.18}, 1}, {{1, 1, 1}, 0.75}};
  for (std::size_t i = 0; i < lines.size(); ++i) {
    const double below = static_cast<double>(lines.size() - 1 - i);
    const double room = (options.width - 3 * height) / std::max(1.0, text_width(lines[i], height));
    style.height = std::max(6.0, std::floor(height * std::min(1.0, room)));
    canvas.text({1.5 * height, options.height - (1.5 + 2 * below) * height}, lines[i], style);
  }
}

}  // namespace

Image render_problem(const Mesh& mesh, const ProblemRegion& region, std::size_t view, const RenderOptions& given,
                     const std::string& caption) {
  if (view >= region.views.size()) throw Error(ErrorCode::usage, "the region has no such view");
  RenderOptions options = options_of(region.views[view], given);
  check_options(options);
  exec::Cpu ex(options.threads);
  mesh_detail::check_indices(ex, mesh);
  const Vertices vertices = vertices_of(mesh);
  if (vertices.find("weakness") == nullptr)
    throw Error(ErrorCode::usage, "the mesh has no attribute \"weakness\"; reconstruct it with the option weakness");
  const ValueView values = find_values(vertices, "weakness");
  const Paint paint(values, ColourScale(values, {0, 1}, weakness_colour));
  RenderReport report;
  Image image = draw_mesh(ex, mesh, paint, Lit::as_clay, options, report);
  Canvas canvas(image);
  mark(region_pixels(mesh, region.views[view], options), options, canvas);
  write_caption(caption, options, canvas);
  options.colour_by = "weakness";
  draw_colour_bar(*paint.scale(), options, image);
  return image;
}

}  // namespace pointskin
