// What can be seen of a mesh at a glance, in any space.
#pragma once

#include <pointskin/components.hpp>
#include <pointskin/mesh.hpp>

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/space.hpp"

namespace pointskin::mesh_detail {

/// The first triangle that names a vertex outside of [0, vertices), or -1. Waits.
template <exec::Space Exec>
std::int64_t find_bad_triangle(Exec& ex, std::int64_t vertices, ArrayView<const Triangle> triangles);

/// As glance_at() says. Ids must be in range. Waits.
template <exec::Space Exec>
MeshGlance glance(Exec& ex, std::int64_t vertices, ArrayView<const Triangle> triangles);

}  // namespace pointskin::mesh_detail
