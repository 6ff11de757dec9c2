// The first pass of the extraction: which nodes own crossed edges, and which leaves hold a piece of the surface.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "field/field_view.hpp"
#include "octree/neighbourhood.hpp"
#include "surface/leaf_cell.hpp"

namespace pointskin::surface::extract {

/// What a node adds to the mesh: bits 0-2 its crossed edges by axis, then how its cell is triangulated.
inline constexpr unsigned kEdges = 7;
inline constexpr unsigned kTableCell = 8;    ///< a leaf without finer neighbours
inline constexpr unsigned kTracedCell = 16;  ///< a leaf that closes loops with finer neighbours' edges
inline constexpr unsigned kCells = kTableCell | kTracedCell;

/// Marks the nodes of one brick; most bricks do not meet the surface and are done after a look at their 27 corners.
struct MarkBrick {
  field::FieldView f;
  ArrayView<std::uint8_t> marks;

  PSK_HD void operator()(std::int64_t global_brick) const {
    const int level = f.tree.level_of(8 * global_brick);
    const octree::LevelView& l = f.tree.levels[level];
    const std::int64_t brick = global_brick - l.first_node / 8;
    const bool near_face = is_near_face(l, brick);
    const std::uint32_t signs = corner_signs(l, brick, near_face);
    constexpr std::uint32_t kAll = (1U << 27) - 1;
    const bool uniform = signs == 0 || signs == kAll;
    for (int s = 0; s < 8; ++s) {
      const auto node = static_cast<std::int32_t>(8 * brick + s);
      const unsigned mark = uniform && !(f.closed && near_face) ? 0 : mark_node(level, node, signs, uniform);
      marks[8 * global_brick + s] = static_cast<std::uint8_t>(mark);
    }
  }

  /// True if cells of the brick touch a face of the cube.
  PSK_HD static bool is_near_face(const octree::LevelView& l, std::int64_t brick) {
    const octree::Coordinates b = octree::decode(l.brick_key[brick]);
    const std::int32_t last = l.depth == 0 ? 0 : (1 << (l.depth - 1)) - 1;
    return b.x == 0 || b.y == 0 || b.z == 0 || b.x >= last || b.y >= last || b.z >= last;
  }

  /// Inside bits of the 3 x 3 x 3 corners from the brick's first one, bit = grid_index.
  PSK_HD std::uint32_t corner_signs(const octree::LevelView& l, std::int64_t brick, bool near_face) const {
    const octree::Neighbourhood around = octree::load_neighbourhood(l, brick, f.values + l.first_node);
    const octree::Coordinates b = octree::decode(l.brick_key[brick]);
    std::uint32_t signs = 0;
    PSK_UNROLL for (int x = 0; x < 3; ++x) {
      PSK_UNROLL for (int y = 0; y < 3; ++y) {
        PSK_UNROLL for (int z = 0; z < 3; ++z) {
          bool inside = around.at(x, y, z) >= f.isovalue;
          if (inside && near_face) {
            const std::int32_t corner = l.neighbour(static_cast<std::int32_t>(8 * brick), x, y, z);
            inside = corner >= 0 && f.inside(l.depth, corner, {2 * b.x + x, 2 * b.y + y, 2 * b.z + z});
          }
          if (inside) signs |= 1U << grid_index(x, y, z);
        }
      }
    }
    return signs;
  }

  PSK_HD unsigned mark_node(int level, std::int32_t node, std::uint32_t signs, bool uniform) const {
    const int x = octree::slot_x(node & 7);
    const int y = octree::slot_y(node & 7);
    const int z = octree::slot_z(node & 7);
    const auto sign = [&](int dx, int dy, int dz) { return signs >> grid_index(x + dx, y + dy, z + dz) & 1; };
    unsigned mark = 0;
    if (!uniform) {
      const unsigned own = sign(0, 0, 0);
      if (own != sign(1, 0, 0) && is_finest_edge(level, node, 0)) mark |= 1;
      if (own != sign(0, 1, 0) && is_finest_edge(level, node, 1)) mark |= 2;
      if (own != sign(0, 0, 1) && is_finest_edge(level, node, 2)) mark |= 4;
    }
    unsigned corners = 0;
    for (int s = 0; s < 8; ++s) corners |= sign(octree::slot_x(s), octree::slot_y(s), octree::slot_z(s)) << s;
    return mark | mark_cell(level, node, corners == 0 || corners == 0xff);
  }

  PSK_HD unsigned mark_cell(int level, std::int32_t node, bool uniform) const {
    const octree::LevelView& l = f.tree.levels[level];
    if (!l.is_cell(node) || f.tree.is_split(level, node)) return 0;
    const LeafCell cell(f, level, node);
    // Middles are interpolated between corners, so equal corners mean no crossing, except where a corner on the cube's
    // face was made outside.
    if (uniform && !(f.closed && cell.touches_cube_face())) return 0;
    if (cell.has_finer_neighbour()) return kTracedCell;
    return uniform ? 0 : kTableCell;
  }

  /// True if some cell around the edge is a leaf of this level and none is split.
  PSK_HD bool is_finest_edge(int level, std::int32_t node, int axis) const {
    const octree::LevelView& l = f.tree.levels[level];
    bool any_leaf = false;
    for (int i = 0; i < 4; ++i) {
      int d[3] = {0, 0, 0};
      d[(axis + 1) % 3] = -(i >> 1);
      d[(axis + 2) % 3] = -(i & 1);
      const std::int32_t cell = l.neighbour(node, d[0], d[1], d[2]);
      if (!l.is_cell(cell)) continue;
      if (f.tree.is_split(level, cell)) return false;
      any_leaf = true;
    }
    return any_leaf;
  }
};

}  // namespace pointskin::surface::extract
