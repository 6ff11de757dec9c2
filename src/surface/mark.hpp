// The first pass of the extraction: which nodes own crossed edges, and which leaves hold a piece of the surface.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/atomic.hpp"
#include "field/field_view.hpp"
#include "octree/neighbourhood.hpp"
#include "surface/extract.hpp"
#include "surface/leaf_cell.hpp"

namespace pointskin::surface::extract {

/// What a node adds to the mesh, in one byte: bits 0-2 its crossed edges by axis, bit 3 that its cell closes loops with
/// finer neighbours' edges, bits 4-6 the triangles of its cell if it is a leaf without finer neighbours.
inline constexpr unsigned kEdges = 7;
inline constexpr unsigned kTracedCell = 8;
inline constexpr int kTrianglesShift = 4;
inline constexpr unsigned kTriangles = 7U << kTrianglesShift;

/// Number of triangles of each of the 256 cases; small enough to travel as an argument.
struct TriangleCounts {
  std::uint8_t of_case[256];
};

/// Marks nodes from the signs at their cells' corners.
struct Marker {
  field::FieldView f;
  TriangleCounts counts;
  ArrayView<std::uint8_t> marks;
  ArrayView<std::uint8_t> signs;  ///< inside bits of the corners of cells with triangles; undefined for others
  std::uint64_t* lone_corners;    ///< counts those below
  KeyRange counted{};             ///< finest cells at whose corners lone ones are counted

  /// True if cells of the brick touch a face of the cube. Read off the key, without decoding it.
  PSK_HD static bool is_near_face(const octree::LevelView& l, std::int64_t brick) {
    if (l.depth == 0) return true;
    const std::uint64_t key = l.brick_key[brick];
    const std::uint64_t last = octree::kEveryThirdBit & ((std::uint64_t{1} << 3 * (l.depth - 1)) - 1);
    bool near = false;
    PSK_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
      const std::uint64_t coordinate = key >> axis & octree::kEveryThirdBit;
      near = near || coordinate == 0 || coordinate >= last;
    }
    return near;
  }

  /// @param signs  inside bits of the cell's corners, bit = slot
  PSK_HD unsigned mark_node(int level, std::int32_t node, unsigned signs, bool near_face) const {
    const bool uniform = signs == 0 || signs == 0xff;
    if (uniform && !(f.closed && near_face)) return 0;
    unsigned mark = 0;
    PSK_UNROLL
    for (int axis = 0; axis < 3; ++axis) {
      const unsigned end = signs >> (4 >> axis);  // the corner one step along the axis
      if (((signs ^ end) & 1) != 0 && is_finest_edge(level, node, axis)) mark |= 1U << axis;
    }
    if (mark == kEdges && (signs == 1 || signs == 0xfe) && is_lone(level, node, signs == 1) && is_counted(level, node))
      exec::add(lone_corners, 1);
    return mark | mark_cell(level, node, signs, uniform);
  }

  /// Of the six corners around one, those on its side, and the last of them; outside of the tree nothing is.
  struct SameSide {
    int count;
    std::int32_t last;
  };
  PSK_HD SameSide same_side(int level, std::int32_t node, bool inside) const {
    const octree::LevelView& l = f.tree.levels[level];
    SameSide same{0, -1};
    for (int i = 0; i < 6; ++i) {
      const int step = 2 * (i & 1) - 1;
      const std::int32_t other =
          l.neighbour(node, i >> 1 == 0 ? step : 0, i >> 1 == 1 ? step : 0, i >> 1 == 2 ? step : 0);
      if (other < 0 || (f.value(level, other) >= f.isovalue) != inside) continue;
      ++same.count;
      same.last = other;
    }
    return same;
  }

  PSK_HD bool is_counted(int level, std::int32_t node) const {
    return counted.holds(f.tree.levels[level].node_key(node) << 3 * (f.tree.depth - level));
  }

  /// Surface::lone_corners.
  PSK_HD bool is_lone(int level, std::int32_t node, bool inside) const {
    const SameSide same = same_side(level, node, inside);
    return same.count == 0 || (same.count == 1 && same_side(level, same.last, inside).count == 1);
  }

  PSK_HD unsigned mark_cell(int level, std::int32_t node, unsigned signs, bool uniform) const {
    if (!f.is_cell(level, node) || f.is_split(level, node)) return 0;
    const LeafCell cell(f, level, node);
    // Middles are interpolated between corners, so equal corners mean no crossing, except where a corner on the cube's
    // face was made outside.
    if (uniform && !(f.closed && cell.touches_cube_face())) return 0;
    if (cell.finer_neighbours() != 0) return kTracedCell;
    this->signs[f.tree.levels[level].first_node + node] = static_cast<std::uint8_t>(signs);
    return static_cast<unsigned>(counts.of_case[signs]) << kTrianglesShift;
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
      if (!f.is_cell(level, cell)) continue;
      if (level == f.tree.depth) return true;  // where nothing is split
      if (f.is_split(level, cell)) return false;
      any_leaf = true;
    }
    return any_leaf;
  }
};

/// A brick at a time, for spaces with few threads: most bricks do not meet the surface and are done after a look at
/// their 27 corners.
struct MarkBrick : Marker {
  PSK_HD void operator()(std::int64_t global_brick) const {
    const int level = f.tree.level_of(8 * global_brick);
    const octree::LevelView& l = f.tree.levels[level];
    const std::int64_t brick = global_brick - l.first_node / 8;
    const bool near_face = is_near_face(l, brick);
    const std::uint32_t signs = corner_signs(l, brick, near_face);
    constexpr std::uint32_t kAll = (1U << 27) - 1;
    const bool uniform = signs == 0 || signs == kAll;
    for (int s = 0; s < 8; ++s) {
      unsigned mark = 0;
      if (!uniform || (f.closed && near_face))
        mark = mark_node(level, static_cast<std::int32_t>(8 * brick + s), signs_of_cell(signs, s), near_face);
      marks[8 * global_brick + s] = static_cast<std::uint8_t>(mark);
    }
  }

  /// Signs of one cell's corners out of the brick's.
  PSK_HD static unsigned signs_of_cell(std::uint32_t signs, int slot) {
    unsigned corners = 0;
    for (int s = 0; s < 8; ++s)
      corners |=
          (signs >> grid_index(octree::slot_x(slot) + octree::slot_x(s), octree::slot_y(slot) + octree::slot_y(s),
                               octree::slot_z(slot) + octree::slot_z(s)) &
           1)
          << s;
    return corners;
  }

  /// Inside bits of the 3 x 3 x 3 corners from the brick's first one, bit = grid_index.
  PSK_HD std::uint32_t corner_signs(const octree::LevelView& l, std::int64_t brick, bool near_face) const {
    const octree::Neighbourhood around = octree::load_neighbourhood(l, brick, f.values + l.first_node);
    const octree::Coordinates b = octree::decode(l.brick_key[brick]);
    std::uint32_t signs = 0;
    PSK_UNROLL
    for (int x = 0; x < 3; ++x) {
      PSK_UNROLL
      for (int y = 0; y < 3; ++y) {
        PSK_UNROLL
        for (int z = 0; z < 3; ++z) {
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
};

/// A node at a time, for spaces with many threads.
struct MarkNode : Marker {
  PSK_HD void operator()(std::int64_t index) const {
    const int level = f.tree.level_of(index);
    const octree::LevelView& l = f.tree.levels[level];
    const auto node = static_cast<std::int32_t>(index - l.first_node);
    const bool near_face = is_near_face(l, node >> 3);
    marks[index] = static_cast<std::uint8_t>(mark_node(level, node, corner_signs(l, node, near_face), near_face));
  }

  PSK_HD unsigned corner_signs(const octree::LevelView& l, std::int32_t node, bool near_face) const {
    std::int32_t corner[8];
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) corner[s] = l.neighbour(node, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s));
    unsigned signs = 0;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const float value = corner[s] < 0 ? 0 : f.value(l.depth, corner[s]);
      if (value >= f.isovalue) signs |= 1U << s;
    }
    return near_face && signs != 0 ? allowed(l, node, corner, signs) : signs;
  }

  /// Near the cube's faces values alone do not decide.
  PSK_HD unsigned allowed(const octree::LevelView& l, std::int32_t node, const std::int32_t (&corner)[8],
                          unsigned signs) const {
    const octree::Coordinates c = octree::decode(l.node_key(node));
    unsigned result = 0;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const bool inside =
          (signs >> s & 1) != 0 && corner[s] >= 0 &&
          f.inside(l.depth, corner[s], {c.x + octree::slot_x(s), c.y + octree::slot_y(s), c.z + octree::slot_z(s)});
      if (inside) result |= 1U << s;
    }
    return result;
  }
};

}  // namespace pointskin::surface::extract
