// Closed loops of the isosurface around one cell whose faces and edges may be subdivided by finer neighbours.
//
// The cell's surface is a polyhedron of polygons. On each polygon, every run of inside corners is cut off by one
// segment from where the boundary enters the inside to where it leaves. The rule looks at the polygon alone, so the
// cells on both sides of a face agree, and every crossing of an edge starts one segment and ends one: the segments form
// closed loops. Source: Lorensen & Cline, "Marching cubes", 1987; the face rule is that of Montani, Scateni & Scopigno,
// "A modified look-up table for implicit disambiguation of marching cubes", 1994.
#pragma once

#include <cstdint>

#include "core/bits.hpp"
#include "core/host_device.hpp"

namespace pointskin::surface {

/// Positions on a cell are a 3 x 3 x 3 grid: 0 and 2 are its corners, 1 the middles that finer neighbours have.
PSK_HD constexpr int grid_index(int x, int y, int z) { return x * 9 + y * 3 + z; }

/// A crossing is named by the sum of its edge's end positions, each coordinate 0..4.
PSK_HD constexpr int crossing_index(int x, int y, int z) { return x * 25 + y * 5 + z; }
inline constexpr int kCrossings = 125;

/// Sum of two grid indices as a crossing index.
PSK_HD constexpr int crossing_between(int p, int q) {
  return crossing_index(p / 9 + q / 9, p / 3 % 3 + q / 3 % 3, p % 3 + q % 3);
}

/// Collects the segments of a cell's polygons and walks along their loops.
class CellTracer {
 public:
  /// @param inside  bit grid_index of every position that exists: inside the surface
  PSK_HD explicit CellTracer(std::uint32_t inside) : inside_(inside) {}

  /// Adds the polygons of face (axis, side), side 0 or 1: four quarters if it is subdivided, else one polygon that
  /// takes in the middles of its subdivided edges.
  /// @param split_edges  bit (of edge_bit) set for edges with a middle
  PSK_HD void add_face(int axis, int side, bool subdivided, std::uint32_t split_edges) {
    if (subdivided) {
      for (int q = 0; q < 4; ++q) add_quad(axis, side, q >> 1, q & 1, 1, 0);
    } else {
      add_quad(axis, side, 0, 0, 2, split_edges);
    }
  }

  /// Next crossing along the loop; `crossing` is on one.
  [[nodiscard]] PSK_HD int next(int crossing) const { return next_[crossing]; }

  /// Calls visit(first crossing, length) for every loop, by ascending first crossing.
  template <class Visit>
  PSK_HD void for_loops(const Visit& visit) const {
    std::uint64_t low = crossings_[0];
    std::uint64_t high = crossings_[1];
    while ((low | high) != 0) {
      const int start = low != 0 ? lowest_bit(low) : 64 + lowest_bit(high);
      int length = 0;
      int at = start;
      do {
        (at < 64 ? low : high) &= ~(std::uint64_t{1} << (at & 63));
        at = next_[at];
        ++length;
      } while (at != start);
      visit(start, length);
    }
  }

  /// Bit of the edge along `axis` at the lower (0) or upper (1) side of the two following axes.
  PSK_HD static constexpr std::uint32_t edge_bit(int axis, int side_b, int side_c) {
    return 1U << (axis * 4 + side_b * 2 + side_c);
  }

 private:
  PSK_HD static int position(int axis, int a, int b, int c) {
    return axis == 0 ? grid_index(a, b, c) : axis == 1 ? grid_index(c, a, b) : grid_index(b, c, a);
  }

  /// The quadrilateral of width `width` at (b, c) of a face, counter-clockwise seen from outside of the cell.
  PSK_HD void add_quad(int axis, int side, int b, int c, int width, std::uint32_t split_edges) {
    const int a = 2 * side;
    const auto sign = [&](int at_b, int at_c) { return inside_ >> position(axis, a, at_b, at_c) & 1; };
    const std::uint32_t inside_corners =
        sign(b, c) + sign(b + width, c) + sign(b, c + width) + sign(b + width, c + width);
    if (split_edges == 0 && (inside_corners & 3) == 0) return;  // none or all four: nothing to cut off
    int points[8];
    int count = 0;
    const int axis_b = (axis + 1) % 3;
    const int axis_c = (axis + 2) % 3;
    // Edges along b have the axes (c, a) following, edges along c the axes (a, b).
    const bool low_c = (split_edges & edge_bit(axis_b, 0, side)) != 0;
    const bool high_c = (split_edges & edge_bit(axis_b, 1, side)) != 0;
    const bool low_b = (split_edges & edge_bit(axis_c, side, 0)) != 0;
    const bool high_b = (split_edges & edge_bit(axis_c, side, 1)) != 0;
    points[count++] = position(axis, a, b, c);
    if (low_c) points[count++] = position(axis, a, 1, 0);
    points[count++] = position(axis, a, b + width, c);
    if (high_b) points[count++] = position(axis, a, 2, 1);
    points[count++] = position(axis, a, b + width, c + width);
    if (high_c) points[count++] = position(axis, a, 1, 2);
    points[count++] = position(axis, a, b, c + width);
    if (low_b) points[count++] = position(axis, a, 0, 1);
    add_polygon(points, count, side == 0);
  }

  /// Cuts off every run of inside points. `reversed`: the points run clockwise.
  PSK_HD void add_polygon(const int* points, int count, bool reversed) {
    unsigned inside = 0;
    for (int i = 0; i < count; ++i) inside |= (inside_ >> points[i] & 1) << i;
    if (inside == 0 || inside == (1U << count) - 1) return;
    const auto after = [&](int i) { return reversed ? (i == 0 ? count - 1 : i - 1) : (i + 1 == count ? 0 : i + 1); };
    const auto is_inside = [&](int i) { return (inside >> i & 1) != 0; };
    for (int i = 0; i < count; ++i) {
      if (is_inside(i) || !is_inside(after(i))) continue;  // not an entry
      int exit = after(i);
      while (is_inside(after(exit))) exit = after(exit);
      const int entry = crossing_between(points[i], points[after(i)]);
      next_[entry] = static_cast<std::int8_t>(crossing_between(points[exit], points[after(exit)]));
      crossings_[entry >> 6] |= std::uint64_t{1} << (entry & 63);
    }
  }

  std::uint32_t inside_;
  std::uint64_t crossings_[2] = {0, 0};  // bit c: next_[c] is set
  std::int8_t next_[kCrossings];
};

}  // namespace pointskin::surface
