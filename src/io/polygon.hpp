// Polygons as lists of vertex ids.
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include <pointskin/mesh.hpp>

namespace pointskin::io {

/// Appends the fan (0, i, i + 1) of a polygon. Fewer than three corners enclose nothing and are left out.
inline void append_fan(const std::vector<std::int32_t>& corners, std::vector<Triangle>& triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i) triangles.push_back({corners[0], corners[i - 1], corners[i]});
}

}  // namespace pointskin::io
