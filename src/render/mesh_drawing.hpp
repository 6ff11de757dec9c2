// The triangles of a mesh on a picture.
#pragma once

#include <pointskin/mesh.hpp>
#include <pointskin/render.hpp>

#include "exec/cpu_primitives.hpp"
#include "render/camera.hpp"
#include "render/drawing.hpp"
#include "render/paint.hpp"

namespace pointskin::render_detail {

class MeshDrawing final : public Drawing {
 public:
  /// All arguments must outlive it. @param mesh  ids in range
  MeshDrawing(exec::Cpu& ex, const Mesh& mesh, const Camera& camera, const Paint& paint, const RenderOptions& options);

  [[nodiscard]] std::int64_t size() const override { return static_cast<std::int64_t>(mesh_.triangles.size()); }
  [[nodiscard]] Span rows(std::int64_t id) const override;
  void draw(std::int64_t id, Band& band) const override;
  [[nodiscard]] Seen seen(std::int32_t id, std::int64_t x, std::int64_t y) const override;
  [[nodiscard]] bool knows_normals() const override { return true; }

 private:
  [[nodiscard]] ScreenTriangle on_screen(std::int64_t id) const;
  [[nodiscard]] Vec3d corner_weights(const ScreenTriangle::Weights& w, const Triangle& t) const;
  [[nodiscard]] Vec3d normal_at(const Triangle& t, const Vec3d& weights) const;
  [[nodiscard]] double edge_at(const ScreenTriangle& triangle, const ScreenTriangle::Weights& w) const;

  const Mesh& mesh_;
  const Camera& camera_;
  const Paint& paint_;
  const RenderOptions& options_;
  bool smooth_;
  double line_width_;  // steps, from the edge to where it ends
  exec::Buffer<ProjectedVertex> vertices_;
};

}  // namespace pointskin::render_detail
