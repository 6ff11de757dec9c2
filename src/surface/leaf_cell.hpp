// What one leaf cell contributes: its signs, its subdivided faces and edges, and its crossings' owners.
#pragma once

#include <cstdint>

#include "field/field_view.hpp"
#include "octree/view.hpp"
#include "surface/cell_tracer.hpp"

namespace pointskin::surface {

/// Owner of an edge (P3): the node it starts at, its level and its axis.
struct EdgeOwner {
  int level;
  std::int32_t node;
  int axis;
};

/// A leaf of the octree.
class LeafCell {
 public:
  PSK_HD LeafCell(const field::FieldView& f, int level, std::int32_t node)
      : f_(f), level_(level), node_(node), at_(octree::decode(f.tree.levels[level].node_key(node))) {}

  /// Bit neighbour_index(dx, dy, dz): the cell there has children. Cells across corners alone do not matter and are
  /// left out.
  [[nodiscard]] PSK_HD std::uint32_t finer_neighbours() const {
    std::uint32_t finer = 0;
    if (level_ == f_.tree.depth) return finer;
    PSK_UNROLL
    for (int j = 0; j < octree::kNeighbours; ++j) {
      const int d[3] = {j / 9 - 1, j / 3 % 3 - 1, j % 3 - 1};
      const int distance = (d[0] != 0) + (d[1] != 0) + (d[2] != 0);
      if (distance == 0 || distance == 3) continue;
      if (f_.is_split(level_, f_.tree.levels[level_].neighbour(node_, d[0], d[1], d[2]))) finer |= 1U << j;
    }
    return finer;
  }

  /// True if the cell touches a face of the cube, where signs do not follow the interpolated values.
  [[nodiscard]] PSK_HD bool touches_cube_face() const {
    const std::int32_t last = (1 << level_) - 1;
    return at_.x == 0 || at_.y == 0 || at_.z == 0 || at_.x == last || at_.y == last || at_.z == last;
  }

  /// The loops around this cell with its finer neighbours' faces and edges.
  [[nodiscard]] PSK_HD CellTracer trace() const {
    const std::uint32_t finer = finer_neighbours();
    std::uint32_t split_edges = 0;
    PSK_UNROLL
    for (int e = 0; e < 12; ++e)
      if (edge_is_split(finer, e / 4, e / 2 & 1, e & 1)) split_edges |= CellTracer::edge_bit(e / 4, e / 2 & 1, e & 1);
    CellTracer tracer(grid_signs(split_edges != 0));
    for (int face = 0; face < 6; ++face) {
      int d[3] = {0, 0, 0};
      d[face / 2] = face % 2 == 0 ? -1 : 1;
      const bool subdivided = (finer >> octree::neighbour_index(d[0], d[1], d[2]) & 1) != 0;
      tracer.add_face(face / 2, face % 2, subdivided, split_edges);
    }
    return tracer;
  }

  /// Owner of the edge that a crossing of trace() lies on.
  [[nodiscard]] PSK_HD EdgeOwner owner_of(int crossing) const {
    const int c[3] = {crossing / 25, crossing / 5 % 5, crossing % 5};
    for (int axis = 0; axis < 3; ++axis)
      if ((c[axis] & 1) != 0) return {level_ + 1, fine_node(c[0] / 2, c[1] / 2, c[2] / 2), axis};
    const int axis = c[0] == 2 ? 0 : c[1] == 2 ? 1 : 2;
    const octree::LevelView& l = f_.tree.levels[level_];
    return {level_, l.neighbour(node_, c[0] / 4, c[1] / 4, c[2] / 4), axis};
  }

  /// Owner of edge number axis * 4 + side_b * 2 + side_c of a cell without finer neighbours.
  [[nodiscard]] PSK_HD EdgeOwner owner_of_edge(int edge) const {
    const int axis = edge / 4;
    int d[3] = {0, 0, 0};
    d[(axis + 1) % 3] = edge / 2 & 1;
    d[(axis + 2) % 3] = edge & 1;
    return {level_, f_.tree.levels[level_].neighbour(node_, d[0], d[1], d[2]), axis};
  }

 private:
  /// True if one of the three other cells around an edge has children.
  PSK_HD static bool edge_is_split(std::uint32_t finer, int axis, int side_b, int side_c) {
    int b[3] = {0, 0, 0};
    int c[3] = {0, 0, 0};
    b[(axis + 1) % 3] = side_b == 0 ? -1 : 1;
    c[(axis + 2) % 3] = side_c == 0 ? -1 : 1;
    const std::uint32_t around = 1U << octree::neighbour_index(b[0], b[1], b[2]) |
                                 1U << octree::neighbour_index(c[0], c[1], c[2]) |
                                 1U << octree::neighbour_index(b[0] + c[0], b[1] + c[1], b[2] + c[2]);
    return (finer & around) != 0;
  }

  /// Node of the finer level at grid position (x, y, z) of this cell, or -1.
  [[nodiscard]] PSK_HD std::int32_t fine_node(int x, int y, int z) const {
    const octree::LevelView& l = f_.tree.levels[level_];
    const std::int32_t corner = l.neighbour(node_, x >> 1, y >> 1, z >> 1);
    const std::int32_t brick = corner < 0 ? -1 : l.child_brick[corner];
    return brick < 0 ? -1 : 8 * brick + octree::slot_of(x & 1, y & 1, z & 1);
  }

  /// True if the cell or one next to it touches a face of the cube: rules of the faces reach that far.
  [[nodiscard]] PSK_HD bool is_near_cube_face() const {
    const std::int32_t last = (1 << level_) - 2;
    return at_.x <= 1 || at_.y <= 1 || at_.z <= 1 || at_.x >= last || at_.y >= last || at_.z >= last;
  }

  /// Inside bits over the 3 x 3 x 3 grid; positions that do not exist count as outside and are never used.
  [[nodiscard]] PSK_HD std::uint32_t grid_signs(bool with_middles) const {
    return f_.closed && is_near_cube_face() ? grid_signs_at_face(with_middles) : grid_signs_inside(with_middles);
  }

  /// By values alone: all looked up at once.
  [[nodiscard]] PSK_HD std::uint32_t grid_signs_inside(bool with_middles) const {
    std::uint32_t signs = 0;
    PSK_UNROLL
    for (int i = 0; i < 27; ++i) {
      const int x = i / 9;
      const int y = i / 3 % 3;
      const int z = i % 3;
      const bool is_corner = ((x | y | z) & 1) == 0;
      const std::int32_t node = is_corner      ? f_.tree.levels[level_].neighbour(node_, x / 2, y / 2, z / 2)
                                : with_middles ? fine_node(x, y, z)
                                               : -1;
      const bool inside = node >= 0 && f_.value(is_corner ? level_ : level_ + 1, node) >= f_.isovalue;
      if (inside) signs |= 1U << grid_index(x, y, z);
    }
    return signs;
  }

  /// The rules of a closed cube's faces as well.
  [[nodiscard]] PSK_HD std::uint32_t grid_signs_at_face(bool with_middles) const {
    std::uint32_t signs = 0;
    for (int x = 0; x < 3; ++x)
      for (int y = 0; y < 3; ++y)
        for (int z = 0; z < 3; ++z)
          if (inside_grid(x, y, z, with_middles)) signs |= 1U << grid_index(x, y, z);
    return signs;
  }

  [[nodiscard]] PSK_HD bool inside_grid(int x, int y, int z, bool with_middles) const {
    if (((x | y | z) & 1) == 0) {
      const octree::LevelView& l = f_.tree.levels[level_];
      return f_.inside(level_, l.neighbour(node_, x / 2, y / 2, z / 2), {at_.x + x / 2, at_.y + y / 2, at_.z + z / 2});
    }
    if (!with_middles) return false;
    const std::int32_t node = fine_node(x, y, z);
    return node >= 0 && f_.inside(level_ + 1, node, {2 * at_.x + x, 2 * at_.y + y, 2 * at_.z + z});
  }

  const field::FieldView& f_;
  int level_;
  std::int32_t node_;
  octree::Coordinates at_;
};

}  // namespace pointskin::surface
