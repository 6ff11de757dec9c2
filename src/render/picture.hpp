// From a drawing to the pixels of its picture.
#pragma once

#include <pointskin/render.hpp>

#include <optional>

#include "exec/cpu.hpp"
#include "render/camera.hpp"
#include "render/drawing.hpp"
#include "render/shadow.hpp"

namespace pointskin::render_detail {

/// How the light of a picture follows from its depth.
struct DepthLight {
  int normal_reach = 1;  ///< of normals_of()
  bool even = false;     ///< of Lighting
  std::optional<ShadowMap> shadows{};
};

/// Draws `drawing` onto its background. @param report  receives the shares
Image draw_picture(exec::Cpu& ex, const Drawing& drawing, const Camera& camera, const RenderOptions& options,
                   const DepthLight& light, RenderReport& report);

}  // namespace pointskin::render_detail
