// Where the key light does not get to.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include "render/camera.hpp"
#include "render/depth_map.hpp"
#include "render/drawing.hpp"

namespace pointskin::render_detail {

/// The picture that the key light sees of what `options` show; its size is small. Fitted to the same points.
RenderOptions light_options(const RenderOptions& options, const Camera& camera);

/// What the light sees first, by its place on the light's picture.
class ShadowMap {
 public:
  /// @param light    fitted with `options`, of light_options()
  /// @param drawing  onto the light's picture
  /// @param viewer   the picture's camera, in whose frame places are told
  ShadowMap(exec::Cpu& ex, const Drawing& drawing, const Camera& light, const Camera& viewer,
            const RenderOptions& options);

  /// What lies so much nearer to the light, in world units, does not shade: discs of points stand out by their size.
  void spare(double world) { slack_ = static_cast<float>(world / radius_); }

  /// Share of the light that reaches a place; the light is a disc in the sky, which 64 rays stand for: every cell of a
  /// square of 16 has its own four. @param normal  of the surface there @param column, row  of the cell
  [[nodiscard]] float reaches(const Vec3f& place, const Vec3f& normal, std::int32_t column, std::int32_t row) const;

 private:
  /// A linear map from the viewer's frame to column, row and nearness of the light's picture.
  struct Row {
    Vec3f along;
    float at_zero = 0;
    [[nodiscard]] float of(const Vec3f& p) const { return dot(along, p) + at_zero; }
  };

  /// A place on the light's disc.
  struct SunRay {
    float x, y;
  };
  static const std::array<SunRay, 64>& rays();

  DepthMap map_;
  Row column_, row_, nearness_;
  Vec3f towards_;  // the light, in the viewer's frame
  double radius_;  // world units, of the light's picture
  float slack_ = 0;
};

/// Share of the key light that reaches each cell of `map`.
CellFloats key_light_of(exec::Cpu& ex, const DepthMap& map, const std::vector<Vec3f>& normals,
                        const ShadowMap& shadows);

}  // namespace pointskin::render_detail
