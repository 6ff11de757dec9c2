// Edges of triangles are drawn where a sample is near to one, so that hidden ones vanish with their triangles.
// Source: Baerentzen, Nielsen, Gjol, Larsen & Christensen, "Single-pass wireframe rendering", SIGGRAPH sketches 2006.
#include "render/mesh_drawing.hpp"
#include "core/vec3.hpp"

#include <algorithm>
#include <cmath>

#include "render/picture_scale.hpp"

namespace pointskin::render_detail {
namespace {

Vec3d corner(const std::vector<Vec3f>& values, const Triangle& t, std::size_t k) {
  return to_double(values[static_cast<std::size_t>(t[k])]);
}

}  // namespace

MeshDrawing::MeshDrawing(exec::Cpu& ex, const Mesh& mesh, const Camera& camera, const Paint& paint,
                         const RenderOptions& options)
    : mesh_(mesh),
      camera_(camera),
      paint_(paint),
      options_(options),
      smooth_(options.smooth && mesh.normals.size() == mesh.vertices.size()),
      line_width_(0.6 * std::max(0.75, picture_scale(options)) * (1 << camera.step_bits())),
      vertices_(ex.pool(), static_cast<std::int64_t>(mesh.vertices.size())) {
  exec::for_each(ex, "project", vertices_.size(), [this](std::int64_t v) {
    vertices_.data()[v] = camera_.project(mesh_.vertices[static_cast<std::size_t>(v)]);
  });
}

ScreenTriangle MeshDrawing::on_screen(std::int64_t id) const {
  const Triangle& t = mesh_.triangles[static_cast<std::size_t>(id)];
  return {vertices_.data()[t[0]], vertices_.data()[t[1]], vertices_.data()[t[2]]};
}

Span MeshDrawing::rows(std::int64_t id) const {
  const ScreenTriangle triangle = on_screen(id);
  if (!triangle.visible() || (!triangle.faces_viewer() && !options_.back_faces)) return {};
  return triangle.rows();
}

void MeshDrawing::draw(std::int64_t id, Band& band) const { band.draw(on_screen(id), static_cast<std::int32_t>(id)); }

Seen MeshDrawing::seen(std::int32_t id, std::int64_t x, std::int64_t y) const {
  const ScreenTriangle triangle = on_screen(id);
  const ScreenTriangle::Weights w = triangle.at(x, y);
  const Triangle& t = mesh_.triangles[static_cast<std::size_t>(id)];
  const Vec3d weights = corner_weights(w, t);
  Seen seen;
  seen.front = triangle.faces_viewer();
  const Vec3d normal = camera_.to_view(normal_at(t, weights));
  seen.normal = seen.front ? normal : -1 * normal;
  seen.albedo = seen.front ? paint_.at(t, weights) : behind();
  if (options_.wireframe) seen.line = edge_at(triangle, w);
  return seen;
}

/// Perspective-correct; they sum to 1.
Vec3d MeshDrawing::corner_weights(const ScreenTriangle::Weights& w, const Triangle& t) const {
  const Vec3d weights{static_cast<double>(w.a) * vertices_.data()[t[0]].weight,
                      static_cast<double>(w.b) * vertices_.data()[t[1]].weight,
                      static_cast<double>(w.c) * vertices_.data()[t[2]].weight};
  return 1 / (weights[0] + weights[1] + weights[2]) * weights;
}

/// Unit normal of the outside, in the mesh's frame.
Vec3d MeshDrawing::normal_at(const Triangle& t, const Vec3d& weights) const {
  Vec3d normal{0, 0, 0};
  if (smooth_)
    for (std::size_t k = 0; k < 3; ++k) normal += weights[k] * corner(mesh_.normals, t, k);
  if (!(squared_length(normal) > 0)) {
    const Vec3d a = corner(mesh_.vertices, t, 0);
    normal = cross(corner(mesh_.vertices, t, 1) - a, corner(mesh_.vertices, t, 2) - a);
  }
  return normalized(normal);
}

/// Edges fade where triangles are so small that all of the surface would be edges.
double MeshDrawing::edge_at(const ScreenTriangle& triangle, const ScreenTriangle::Weights& w) const {
  const double sides[3] = {triangle.side(0), triangle.side(1), triangle.side(2)};
  const double weights[3] = {static_cast<double>(w.a), static_cast<double>(w.b), static_cast<double>(w.c)};
  double nearest = weights[0] / sides[0];
  for (int k = 1; k < 3; ++k) nearest = std::min(nearest, weights[k] / sides[k]);
  const double height = static_cast<double>(triangle.area()) / std::max({sides[0], sides[1], sides[2]});
  const double strength = std::clamp(height / (10 * line_width_), 0.0, 1.0);
  return strength * std::clamp(1.5 - nearest / line_width_, 0.0, 1.0);
}

}  // namespace pointskin::render_detail
