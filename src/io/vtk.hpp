// What legacy and XML files of VTK have in common: cells that are made of triangles, and names of arrays.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "io/numpy_table.hpp"
#include "io/polygon.hpp"

namespace pointskin::io {

/// Types of cells that are made of triangles, as vtkCellType.h numbers them.
enum class VtkCell : std::int64_t { triangle = 5, strip = 6, polygon = 7, pixel = 8, quad = 9 };

/// Appends the triangles of a strip, all turned as the first one is.
inline void append_strip(const std::vector<std::int32_t>& corners, std::vector<Triangle>& triangles) {
  for (std::size_t i = 2; i < corners.size(); ++i)
    triangles.push_back(i % 2 == 0 ? Triangle{corners[i - 2], corners[i - 1], corners[i]}
                                   : Triangle{corners[i - 1], corners[i - 2], corners[i]});
}

/// Appends the triangles of a cell; none of points, lines and solids. A pixel's corners come row by row, and are put in
/// the order around it.
inline void append_cell(VtkCell type, std::vector<std::int32_t>& corners, std::vector<Triangle>& triangles) {
  using enum VtkCell;
  if (type == pixel && corners.size() == 4) std::swap(corners[2], corners[3]);
  if (type == strip) append_strip(corners, triangles);
  if (type == triangle || type == polygon || type == pixel || type == quad) append_fan(corners, triangles);
}

/// True for arrays that hold red, green and blue where they are bytes.
inline bool vtk_names_colours(std::string_view name) {
  return names_colours(std::string(name)) || name == "RGB" || name == "RGBA";
}

}  // namespace pointskin::io
