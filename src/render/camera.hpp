// Where vertices land on the picture.
#pragma once

#include <pointskin/camera.hpp>
#include <pointskin/render.hpp>

#include <cstdint>

#include "exec/cpu.hpp"
#include "mesh/vec3d.hpp"

namespace pointskin::render_detail {

/// Each pixel is cut into kSupersampling x kSupersampling samples.
inline constexpr int kSupersampling = 2;

/// Fixed-point steps per sample: integer coordinates make neighbouring triangles meet without gaps.
inline constexpr int kStepBits = 8;
inline constexpr std::int32_t kSteps = 1 << kStepBits;

/// A vertex on the picture.
struct ProjectedVertex {
  std::int32_t x = kOutside, y = kOutside;  ///< steps from the left and from the top
  float nearness = 0;                       ///< larger is nearer; linear over a triangle on the picture
  float weight = 1;                         ///< attributes times weight are linear over a triangle on the picture

  static constexpr std::int32_t kOutside = INT32_MIN;
  [[nodiscard]] bool visible() const { return x != kOutside; }
};

/// The viewer's frame and its projection.
class Camera {
 public:
  /// Fits the camera to the triangles of `mesh`, ids in range. O(t).
  Camera(exec::Cpu& ex, const Mesh& mesh, const RenderOptions& options);

  /// `vertex` is relative to the mesh's origin. Not finite gives an invisible one.
  [[nodiscard]] ProjectedVertex project(const Vec3f& vertex) const;

  /// A direction of the mesh in the viewer's frame: right, up, towards the viewer.
  [[nodiscard]] Vec3d to_view(const Vec3d& direction) const;

  /// The same view for interactive programs. @param origin  of the mesh
  [[nodiscard]] pointskin::Camera matrices(const Vec3d& origin, const RenderOptions& options) const;

  /// The mesh's up axis in the viewer's frame.
  [[nodiscard]] const Vec3d& up_in_view() const { return up_in_view_; }

 private:
  void orient(const RenderOptions& options);

  Vec3d right_{1, 0, 0}, up_{0, 1, 0}, back_{0, 0, 1};  // unit length, back_ points to the viewer
  Vec3d up_in_view_{0, 1, 0};
  Vec3d centre_{0, 0, 0};
  double radius_ = 1;
  bool perspective_ = true;
  double distance_ = 1;                 // viewer to centre, in radii
  double focal_ = 1;                    // steps per radius at unit depth
  double middle_x_ = 0, middle_y_ = 0;  // steps
};

}  // namespace pointskin::render_detail
