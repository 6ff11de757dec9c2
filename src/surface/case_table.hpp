// Marching cubes cases of a cell without finer neighbours, derived from the same tracer that handles all other cells.
#pragma once

#include <array>
#include <cstdint>

#include "core/host_device.hpp"

namespace pointskin::surface {

/// Triangles of one of the 256 cases. Edges are numbered axis * 4 + side_b * 2 + side_c (CellTracer::edge_bit).
struct Case {
  static constexpr int kMaxTriangles = 5;

  std::uint8_t triangles = 0;
  std::uint8_t edges[3 * kMaxTriangles] = {};

  /// True for a single quadrilateral, with the corners edges[3], edges[0], edges[1], edges[2] in order. Neither of its
  /// diagonals lies in a face of the cell.
  [[nodiscard]] PSK_HD constexpr bool is_quadrilateral() const {
    return triangles == 2 && edges[0] == edges[4] && edges[2] == edges[5];
  }
};
static_assert(sizeof(Case) == 16);

/// All cases, indexed by the inside bits of the cell's corners (bit = slot). Loops are triangulated so that no diagonal
/// lies in a face of the cell: a neighbour might have the same one, and four triangles would meet there. All 256 cases
/// allow that.
std::array<Case, 256> make_case_table();

}  // namespace pointskin::surface
