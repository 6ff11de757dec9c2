// The scale of colours at the right of a picture.
#pragma once

#include <pointskin/render.hpp>

#include "render/colour_map.hpp"

namespace pointskin::render_detail {

/// Pixels at the right that the scale takes; 0 if there is none.
int colour_bar_width(const RenderOptions& options);

/// Draws `scale`, with its name and numbers, if there is to be one.
void draw_colour_bar(const ColourScale& scale, const RenderOptions& options, Image& image);

}  // namespace pointskin::render_detail
