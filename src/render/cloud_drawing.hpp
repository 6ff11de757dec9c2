// The points of a cloud on a picture, as discs.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/render.hpp>

#include "exec/cpu_primitives.hpp"
#include "render/camera.hpp"
#include "render/drawing.hpp"
#include "render/paint.hpp"

namespace pointskin::render_detail {

/// Diameter of the points in world units that `options` ask for, by their spacing unless it is given; 0 for points at
/// one place, which get a size on the picture.
double point_size_world(exec::Cpu& ex, const Cloud& cloud, const RenderOptions& options);

class CloudDrawing final : public Drawing {
 public:
  /// All arguments must outlive it. @param size_world  of point_size_world()
  CloudDrawing(exec::Cpu& ex, const Cloud& cloud, const Camera& camera, const Paint& paint,
               const RenderOptions& options, double size_world);

  [[nodiscard]] std::int64_t size() const override { return cloud_.size(); }
  [[nodiscard]] Span rows(std::int64_t id) const override;
  void draw(std::int64_t id, Band& band) const override;
  [[nodiscard]] Seen seen(std::int32_t id, std::int64_t x, std::int64_t y) const override;
  [[nodiscard]] bool knows_normals() const override { return normals_; }

  /// Radius of a point in the middle of the picture, in pixels, and its diameter in world units.
  [[nodiscard]] double usual_radius_pixels() const;
  [[nodiscard]] double usual_size_world() const;

 private:
  [[nodiscard]] double weight_in_middle() const;
  [[nodiscard]] double radius_steps(const ProjectedVertex& at) const;
  [[nodiscard]] Vec3d normal_of(std::int64_t id) const;
  [[nodiscard]] Vec3d to_viewer(const ProjectedVertex& at) const;
  [[nodiscard]] ScreenDisc disc_of(std::int64_t id) const;

  const Cloud& cloud_;
  const Camera& camera_;
  const Paint& paint_;
  const RenderOptions& options_;
  bool normals_;
  double steps_;   // per pixel
  double fixed_;   // radius on the picture, steps; 0: by radius_
  double radius_;  // of a point, in the camera's unit
  exec::Buffer<ProjectedVertex> points_;
};

}  // namespace pointskin::render_detail
