// The picture of a mesh in given colours.
#pragma once

#include <pointskin/mesh.hpp>
#include <pointskin/render.hpp>

#include "exec/cpu.hpp"
#include "render/paint.hpp"

namespace pointskin::render_detail {

/// @throws Error usage if an option is out of its range
void check_options(const RenderOptions& options);

/// How colours are lit.
enum class Lit {
  as_clay,    ///< with shadows and gloss
  as_values,  ///< evenly, so that they can be compared with a scale
};

/// render(), but for the scale of colours. @param mesh  ids in range; options must be checked
Image draw_mesh(exec::Cpu& ex, const Mesh& mesh, const Paint& paint, Lit lit, const RenderOptions& options,
                RenderReport& report);

}  // namespace pointskin::render_detail
