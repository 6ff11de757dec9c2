// The rasteriser: project the vertices, find what every sample of a band of rows sees, shade it, average to pixels.
// Bands are independent of each other, which makes the picture the same for any number of threads.
#include <pointskin/camera.hpp>
#include <pointskin/error.hpp>
#include <pointskin/render.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "mesh/mesh_checks.hpp"
#include "mesh/vec3d.hpp"
#include "render/camera.hpp"
#include "render/raster.hpp"
#include "render/shading.hpp"

namespace pointskin {
namespace {

using exec::Cpu;
using mesh_detail::dot;
using mesh_detail::minus;
using mesh_detail::normalized;
using mesh_detail::plus;
using mesh_detail::times;
using mesh_detail::to_double;
using render_detail::Band;
using render_detail::Colour;
using render_detail::kSupersampling;
using render_detail::ProjectedVertex;
using render_detail::ScreenTriangle;

constexpr std::int32_t kBandPixels = 32;

void check_options(const RenderOptions& options) {
  constexpr int kLargestSide = 16384;
  if (options.width < 1 || options.width > kLargestSide || options.height < 1 || options.height > kLargestSide)
    throw Error(ErrorCode::usage, "the width and height of a picture must be in [1, 16384] pixels");
  if (!std::isfinite(options.azimuth_degrees)) throw Error(ErrorCode::usage, "the azimuth must be a finite angle");
  if (!(options.elevation_degrees >= -90 && options.elevation_degrees <= 90))
    throw Error(ErrorCode::usage, "the elevation must be in [-90, 90] degrees");
}

/// Rows of samples that a triangle may touch; none if first > last.
struct RowRange {
  std::int32_t first, last;
};

class Renderer {
 public:
  Renderer(Cpu& ex, const Mesh& mesh, const RenderOptions& options)
      : mesh_(mesh),
        options_(options),
        camera_(ex, mesh, options),
        vertices_(ex.pool(), static_cast<std::int64_t>(mesh.vertices.size())),
        rows_(ex.pool(), static_cast<std::int64_t>(mesh.triangles.size())) {
    if (options.colours) colours_ = render_detail::vertex_colours(mesh);
    exec::for_each(ex, "project", vertices_.size(), [this](std::int64_t v) {
      vertices_.data()[v] = camera_.project(mesh_.vertices[static_cast<std::size_t>(v)]);
    });
    exec::for_each(ex, "project", rows_.size(), [this](std::int64_t t) { rows_.data()[t] = rows_of(t); });
  }

  void draw(Cpu& ex, Image& image) const {
    ex.run_blocks(exec::block_count(options_.height, kBandPixels), [&](std::int64_t b) {
      const auto first = static_cast<std::int32_t>(b) * kBandPixels;
      const std::int32_t pixels = std::min(kBandPixels, options_.height - first);
      Band band(options_.width * kSupersampling, first * kSupersampling, pixels * kSupersampling);
      fill(band);
      for (std::int32_t row = first; row < first + pixels; ++row) resolve(band, row, image);
    });
  }

 private:
  [[nodiscard]] ScreenTriangle on_screen(std::int64_t id) const {
    const Triangle& t = mesh_.triangles[static_cast<std::size_t>(id)];
    return {vertices_.data()[t[0]], vertices_.data()[t[1]], vertices_.data()[t[2]]};
  }

  [[nodiscard]] RowRange rows_of(std::int64_t id) const {
    const ScreenTriangle triangle = on_screen(id);
    if (!triangle.visible() || (!triangle.faces_viewer() && !options_.back_faces)) return {0, -1};
    return {triangle.first_row(), triangle.last_row()};
  }

  void fill(Band& band) const {
    for (std::int64_t t = 0; t < rows_.size(); ++t) {
      const RowRange rows = rows_.data()[t];
      if (rows.first > rows.last || rows.last < band.first_row || rows.first >= band.first_row + band.rows) continue;
      band.draw(on_screen(t), static_cast<std::int32_t>(t));
    }
  }

  /// Averages the samples of pixel row `row`.
  void resolve(const Band& band, std::int32_t row, Image& image) const {
    const double height = 1 - (row + 0.5) / options_.height;
    const Colour behind_all = render_detail::background(height);
    std::uint8_t* out =
        image.rgb.data() + std::size_t{3} * static_cast<std::size_t>(row) * static_cast<std::size_t>(options_.width);
    for (std::int32_t pixel = 0; pixel < options_.width; ++pixel) {
      Colour sum{0, 0, 0};
      for (std::int32_t s = 0; s < kSupersampling * kSupersampling; ++s)
        sum = plus(sum, sample(band, pixel * kSupersampling + s % kSupersampling,
                               row * kSupersampling + s / kSupersampling, behind_all));
      for (const double channel : times(1.0 / (kSupersampling * kSupersampling), sum)) *out++ = encode_(channel);
    }
  }

  [[nodiscard]] Colour sample(const Band& band, std::int32_t column, std::int32_t row, const Colour& background) const {
    const std::int32_t id =
        band.triangles[static_cast<std::size_t>(row - band.first_row) * static_cast<std::size_t>(band.width) +
                       static_cast<std::size_t>(column)];
    if (id < 0) return background;
    const ScreenTriangle triangle = on_screen(id);
    const Vec3d weights = corner_weights(triangle, id, column, row);
    const bool front = triangle.faces_viewer();
    const Vec3d normal = camera_.to_view(normal_at(id, weights, front));
    const Colour albedo = front ? albedo_at(id, weights) : render_detail::behind();
    return render_detail::shade(albedo, normal, camera_.up_in_view());
  }

  /// Perspective-correct weights of the corners at a sample; they sum to 1.
  [[nodiscard]] Vec3d corner_weights(const ScreenTriangle& triangle, std::int32_t id, std::int32_t column,
                                     std::int32_t row) const {
    const ScreenTriangle::Weights w = triangle.at(column, row);
    const Triangle& t = mesh_.triangles[static_cast<std::size_t>(id)];
    const Vec3d weights{static_cast<double>(w.a) * vertices_.data()[t[0]].weight,
                        static_cast<double>(w.b) * vertices_.data()[t[1]].weight,
                        static_cast<double>(w.c) * vertices_.data()[t[2]].weight};
    return times(1 / (weights[0] + weights[1] + weights[2]), weights);
  }

  /// Unit normal of the side that is seen, in the mesh's frame.
  [[nodiscard]] Vec3d normal_at(std::int32_t id, const Vec3d& weights, bool front) const {
    const Triangle& t = mesh_.triangles[static_cast<std::size_t>(id)];
    Vec3d normal{0, 0, 0};
    if (options_.smooth && mesh_.normals.size() == mesh_.vertices.size()) normal = blend(mesh_.normals, t, weights);
    if (!(mesh_detail::squared_length(normal) > 0)) {
      const Vec3d a = to_double(mesh_.vertices[static_cast<std::size_t>(t[0])]);
      const Vec3d b = to_double(mesh_.vertices[static_cast<std::size_t>(t[1])]);
      const Vec3d c = to_double(mesh_.vertices[static_cast<std::size_t>(t[2])]);
      normal = mesh_detail::cross(minus(b, a), minus(c, a));
    }
    return normalized(front ? normal : times(-1, normal));
  }

  [[nodiscard]] Colour albedo_at(std::int32_t id, const Vec3d& weights) const {
    return colours_.empty() ? clay_ : blend(colours_, mesh_.triangles[static_cast<std::size_t>(id)], weights);
  }

  [[nodiscard]] static Vec3d blend(const std::vector<Vec3f>& values, const Triangle& t, const Vec3d& weights) {
    Vec3d sum{0, 0, 0};
    for (std::size_t k = 0; k < 3; ++k)
      sum = plus(sum, times(weights[k], to_double(values[static_cast<std::size_t>(t[k])])));
    return sum;
  }

  const Mesh& mesh_;
  const RenderOptions& options_;
  render_detail::Camera camera_;
  exec::Buffer<ProjectedVertex> vertices_;
  exec::Buffer<RowRange> rows_;
  std::vector<Vec3f> colours_;
  Colour clay_ = render_detail::clay();
  render_detail::SrgbEncoder encode_;
};

}  // namespace

Image render(const Mesh& mesh, const RenderOptions& options) {
  check_options(options);
  Cpu ex(options.threads);
  mesh_detail::check_indices(ex, mesh);
  Image image{options.width, options.height, {}};
  image.rgb.resize(std::size_t{3} * static_cast<std::size_t>(options.width) * static_cast<std::size_t>(options.height));
  Renderer(ex, mesh, options).draw(ex, image);
  return image;
}

Camera camera_of(const Mesh& mesh, const RenderOptions& options) {
  check_options(options);
  Cpu ex(options.threads);
  mesh_detail::check_indices(ex, mesh);
  return render_detail::Camera(ex, mesh, options).matrices(mesh.origin, options);
}

}  // namespace pointskin
