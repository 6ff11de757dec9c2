// The pictures of meshes and clouds.
#include <pointskin/camera.hpp>
#include <pointskin/error.hpp>
#include <pointskin/render.hpp>

#include <algorithm>
#include <cmath>

#include "mesh/mesh_checks.hpp"
#include "render/cloud_drawing.hpp"
#include "render/colour_bar.hpp"
#include "render/draw.hpp"
#include "render/mesh_drawing.hpp"
#include "render/picture.hpp"

namespace pointskin {
namespace {

using exec::Cpu;
using namespace render_detail;

void require(bool holds, const char* story) {
  if (!holds) throw Error(ErrorCode::usage, story);
}

void check_view(const RenderOptions& options) {
  require(std::isfinite(options.azimuth_degrees), "the azimuth must be a finite angle");
  require(options.elevation_degrees >= -90 && options.elevation_degrees <= 90,
          "the elevation must be in [-90, 90] degrees");
  require(options.zoom > 0 && options.zoom <= 1000, "the zoom must be in (0, 1000]");
  require(
      !options.field_of_view_degrees || (*options.field_of_view_degrees >= 1 && *options.field_of_view_degrees <= 170),
      "the field of view must be in [1, 170] degrees");
}

std::optional<WorldBox> world_box(const Box& box, const Vec3d& origin) {
  if (box.lower[0] > box.upper[0]) return std::nullopt;
  return WorldBox{origin + box.lower, origin + box.upper};
}

void finish(const Paint& paint, const RenderOptions& options, Image& image, RenderReport& made, RenderReport* report) {
  if (paint.scale()) {
    made.range = paint.scale()->range();
    draw_colour_bar(*paint.scale(), options, image);
  }
  if (report != nullptr) *report = made;
}

}  // namespace

namespace render_detail {

void check_options(const RenderOptions& options) {
  constexpr int kLargestSide = 16384;
  require(options.width >= 1 && options.width <= kLargestSide && options.height >= 1 && options.height <= kLargestSide,
          "the width and height of a picture must be in [1, 16384] pixels");
  check_view(options);
  require(options.point_size >= 0 && options.point_size <= 1000, "the size of points must be in [0, 1000] pixels");
  require(options.point_size_world >= 0 && std::isfinite(options.point_size_world),
          "the size of points must be a finite length, 0 or more");
  require(!options.range || (std::isfinite(options.range->low) && std::isfinite(options.range->high) &&
                             options.range->low < options.range->high),
          "the range of colours must be two finite numbers, the lower one first");
}

Image draw_mesh(Cpu& ex, const Mesh& mesh, const Paint& paint, Lit lit, const RenderOptions& options,
                RenderReport& report) {
  const FitPoints points(mesh, options.fit_world);
  const Camera camera(ex, points, mesh.origin, options);
  const MeshDrawing drawing(ex, mesh, camera, paint, options);
  DepthLight light{1, lit == Lit::as_values, {}};
  if (options.shadows && !light.even) {
    const RenderOptions from_lamp = light_options(options, camera);
    const Camera lamp(ex, points, mesh.origin, from_lamp);
    light.shadows.emplace(ex, MeshDrawing(ex, mesh, lamp, paint, from_lamp), lamp, camera, from_lamp);
  }
  return draw_picture(ex, drawing, camera, options, light, report);
}

}  // namespace render_detail

Image render(const Mesh& mesh, const RenderOptions& options, RenderReport* report) {
  check_options(options);
  Cpu ex(options.threads);
  mesh_detail::check_indices(ex, mesh);
  const Paint paint(vertices_of(mesh), options);
  RenderReport made;
  Image image = draw_mesh(ex, mesh, paint, paint.scale() ? Lit::as_values : Lit::as_clay, options, made);
  finish(paint, options, image, made, report);
  return image;
}

Image render(const Cloud& cloud, const RenderOptions& options, RenderReport* report) {
  check_options(options);
  Cpu ex(options.threads);
  const Paint paint(vertices_of(cloud), options);
  const FitPoints points(cloud, options.fit_world, options.threads);
  const render_detail::Camera camera(ex, points, cloud.origin, options);
  RenderReport made;
  made.point_size_world = point_size_world(ex, cloud, options);
  made.strays = points.strays();
  const CloudDrawing drawing(ex, cloud, camera, paint, options, made.point_size_world);
  // The plane of a few points: their discs leave steps.
  const int reach = std::clamp(static_cast<int>(std::lround(1.5 * drawing.usual_radius_pixels())), 2, 5);
  DepthLight light{reach, paint.scale().has_value(), {}};
  if (options.shadows && !light.even) {
    const RenderOptions from_lamp = light_options(options, camera);
    const render_detail::Camera lamp(ex, points, cloud.origin, from_lamp);
    const CloudDrawing lit(ex, cloud, lamp, paint, from_lamp, drawing.usual_size_world());
    light.shadows.emplace(ex, lit, lamp, camera, from_lamp);
    light.shadows->spare(drawing.usual_size_world() / 2);
  }
  Image image = draw_picture(ex, drawing, camera, options, light, made);
  finish(paint, options, image, made, report);
  return image;
}

std::optional<ValueRange> value_range(const Mesh& mesh, const std::string& name) {
  return usual_range(find_values(vertices_of(mesh), name));
}

std::optional<ValueRange> value_range(const Cloud& cloud, const std::string& name) {
  return usual_range(find_values(vertices_of(cloud), name));
}

std::optional<WorldBox> fitted_box(const Mesh& mesh, int threads) {
  Cpu ex(threads);
  mesh_detail::check_indices(ex, mesh);
  return world_box(FitPoints(mesh, std::nullopt).box(ex), mesh.origin);
}

std::optional<WorldBox> fitted_box(const Cloud& cloud, int threads) {
  Cpu ex(threads);
  return world_box(FitPoints(cloud, std::nullopt, threads).box(ex), cloud.origin);
}

pointskin::Camera camera_of(const Mesh& mesh, const RenderOptions& options) {
  check_options(options);
  Cpu ex(options.threads);
  mesh_detail::check_indices(ex, mesh);
  return render_detail::Camera(ex, FitPoints(mesh, options.fit_world), mesh.origin, options).matrices(options);
}

pointskin::Camera camera_of(const Cloud& cloud, const RenderOptions& options) {
  check_options(options);
  Cpu ex(options.threads);
  const FitPoints points(cloud, options.fit_world, options.threads);
  return render_detail::Camera(ex, points, cloud.origin, options).matrices(options);
}

}  // namespace pointskin
