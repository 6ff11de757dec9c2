// How large lines, letters and hollows are on a picture.
#pragma once

#include <pointskin/render.hpp>

#include <algorithm>

namespace pointskin::render_detail {

/// 1 for a picture of 900 pixels along its shorter side; what is drawn on a picture grows with it.
inline double picture_scale(const RenderOptions& options) { return std::min(options.width, options.height) / 900.0; }

}  // namespace pointskin::render_detail
