// The divergence of a vector field at the corners of bricks.
#pragma once

#include <cstdint>

#include "octree/neighbourhood.hpp"
#include "poisson/splat_to_bricks.hpp"
#include "poisson/stencil.hpp"

namespace pointskin::poisson {

/// Coefficients of the divergence over single cells: [axis][corner i][corner j] of D S S and its permutations. With M
/// in place of S they would be the integral over a unit cell of phi_j d phi_i / d axis; S also averages across the
/// axis.
struct Coefficients {
  float element[3][8][8];
};

inline constexpr Coefficients make_coefficients() {
  constexpr double kSpread[2][2] = {{1 / 6.0, 2 / 6.0}, {2 / 6.0, 1 / 6.0}};
  Coefficients c{};
  for (std::size_t axis = 0; axis < 3; ++axis)
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 8; ++j) {
        double product = 1;
        for (int a = 0; a < 3; ++a) {
          const int bi = i >> (2 - a) & 1;
          const int bj = j >> (2 - a) & 1;
          product *= a == static_cast<int>(axis) ? (bi != 0 ? 0.5 : -0.5) : kSpread[bi][bj];
        }
        c.element[axis][i][j] = static_cast<float>(product);
      }
  return c;
}

/// D S S and its permutations around a corner whose 8 cells are all leaves; v(x, y, z) at offsets -1, 0, 1.
template <class Values>
PSK_HD PSK_INLINE auto divergence_inside(int axis, const Values& v) {
  using Float = std::decay_t<decltype(v(0, 0, 0))>;
  constexpr auto kWeight =
      static_cast<float>(kAxisRows.derivative[0][2] * kAxisRows.spread[0][0] * kAxisRows.spread[0][0]);
  static_assert(kAxisRows.derivative[0][1] == 0 && kAxisRows.derivative[0][0] == -kAxisRows.derivative[0][2]);
  static_assert(nearly(kAxisRows.spread[0][0], kAxisRows.spread[0][1]) &&
                nearly(kAxisRows.spread[0][0], kAxisRows.spread[0][2]));
  const auto sum = [](const Float(&u)[3]) { return (u[0] + u[2]) + u[1]; };
  Float along[3];
  PSK_UNROLL
  for (int j = -1; j <= 1; ++j) {
    Float slope[3];
    PSK_UNROLL
    for (int k = -1; k <= 1; ++k)
      slope[k + 1] = axis == 0   ? v(1, j, k) - v(-1, j, k)
                     : axis == 1 ? v(j, 1, k) - v(j, -1, k)
                                 : v(j, k, 1) - v(j, k, -1);
    along[j + 1] = sum(slope);
  }
  return kWeight * sum(along);
}

/// Sum over the leaf cells around a corner of their element matrices' rows. Bit t of `leaves`: the cell at offset
/// slot(t) - 1 is a leaf.
template <class Values>
PSK_HD float divergence_by_cells(int leaves, const float (&element)[8][8], const Values& v) {
  float sum = 0;
  PSK_UNROLL
  for (int t = 0; t < 8; ++t) {
    if ((leaves >> t & 1) == 0) continue;
    const int x = octree::slot_x(t) - 1;
    const int y = octree::slot_y(t) - 1;
    const int z = octree::slot_z(t) - 1;
    PSK_UNROLL
    for (int j = 0; j < 8; ++j)  // the corner is number 7 - t of that cell
      sum += element[7 - t][j] * v(x + octree::slot_x(j), y + octree::slot_y(j), z + octree::slot_z(j));
  }
  return sum;
}

/// Divergence of V over the leaf cells of a level, tested with the hats at its corners.
struct Divergence {
  octree::LevelView level;
  std::int32_t finer_cell_bricks;  // of the level below; 0 at the finest level, where all cells are leaves
  VectorField field;
  Coefficients coefficients;
  ArrayView<float> b;
  const std::uint8_t* counts = nullptr;        // (bricks) whether a brick's cells count; null: all do
  const std::uint8_t* finer_counts = nullptr;  // the same of the level below

  [[nodiscard]] PSK_HD bool is_leaf(std::int32_t node) const {
    if (!level.is_cell(node) || (counts != nullptr && counts[node >> 3] == 0)) return false;
    if (finer_cell_bricks == 0) return true;
    const std::int32_t brick = level.child_brick[node];
    return brick < 0 || brick >= finer_cell_bricks || (finer_counts != nullptr && finer_counts[brick] == 0);
  }

  [[nodiscard]] PSK_HD int leaves_around(std::int32_t node) const {
    int leaves = 0;
    PSK_UNROLL
    for (int t = 0; t < 8; ++t) {
      const std::int32_t cell =
          level.neighbour(node, octree::slot_x(t) - 1, octree::slot_y(t) - 1, octree::slot_z(t) - 1);
      if (is_leaf(cell)) leaves |= 1 << t;
    }
    return leaves;
  }

  template <class Values>
  [[nodiscard]] PSK_HD float along(int axis, int leaves, const Values& v) const {
    return leaves == 0xff ? divergence_inside(axis, v) : divergence_by_cells(leaves, coefficients.element[axis], v);
  }
};

/// A brick at a time. A GPU has a kernel of its own for it (divergence_kernel.cuh).
struct DivergenceOfBricks : Divergence {
  PSK_HD void operator()(std::int64_t brick) const {
    float sum[8] = {};
    int leaves[8];
    for (int s = 0; s < 8; ++s) leaves[s] = leaves_around(static_cast<std::int32_t>(8 * brick + s));
    for (int axis = 0; axis < 3; ++axis) {
      const octree::Neighbourhood around = octree::load_neighbourhood(level, brick, field.axis[axis].data);
      PSK_UNROLL
      for (int s = 0; s < 8; ++s) {
        const auto v = [&](int x, int y, int z) {
          return around.at(octree::slot_x(s) + x, octree::slot_y(s) + y, octree::slot_z(s) + z);
        };
        sum[s] += along(axis, leaves[s], v);
      }
    }
    for (int s = 0; s < 8; ++s) b[8 * brick + s] = sum[s];
  }

#if PSK_WIDE
  /// 8 corners at once.
  PSK_INLINE void wide(std::int64_t brick) const {
    int inside = 0xff;  // bit s: all cells around corner s are leaves
    int leaves[8];      // of the cells at offset slot(t) - 1: bit s for the one seen from corner s
    find_leaves(brick, leaves);
    int any = 0;
    PSK_UNROLL
    for (int t = 0; t < 8; ++t) {
      inside &= leaves[t];
      any |= leaves[t];
    }
    Float8 sum = {};
    for (int axis = 0; any != 0 && axis < 3; ++axis) {
      octree::NeighbourLanes around;
      octree::load_lanes(level, brick, field.axis[axis].data, around);
      Float8 along = {};
      if (inside != 0xff) add_cells(leaves, coefficients.element[axis], around, along);
      sum += select(mask_of_bits(inside), divergence_inside(axis, around), along);
    }
    store8(sum, &b[8 * brick]);
  }

 private:
  PSK_INLINE void find_leaves(std::int64_t brick, int (&leaves)[8]) const {
    if (finer_cell_bricks == 0 && counts == nullptr && level.depth > 0) return find_finest_cells(brick, leaves);
    PSK_UNROLL
    for (int t = 0; t < 8; ++t) leaves[t] = 0;
    for (int s = 0; s < 8; ++s) {
      const int around = leaves_around(static_cast<std::int32_t>(8 * brick + s));
      PSK_UNROLL
      for (int t = 0; t < 8; ++t) leaves[t] |= (around >> t & 1) << s;
    }
  }

  /// On the finest level all cells are leaves, and but for the root cells are whole bricks.
  PSK_INLINE void find_finest_cells(std::int64_t brick, int (&leaves)[8]) const {
    const std::int32_t* bricks = level.neighbours + brick * octree::kNeighbours;
    PSK_UNROLL
    for (int t = 0; t < 8; ++t) {
      const std::int32_t other =
          bricks[octree::neighbour_index(octree::slot_x(t) - 1, octree::slot_y(t) - 1, octree::slot_z(t) - 1)];
      leaves[t] = other >= 0 && other < level.cell_bricks ? 0xff : 0;
    }
    step_along<4>(leaves);
    step_along<2>(leaves);
    step_along<1>(leaves);
  }

  /// Turns bits of whole bricks (before, own) into those at offsets -1 and 0 along the axis of a slot's bit. All bits
  /// of a brick agree at first.
  template <int Bit>
  PSK_INLINE static void step_along(int (&leaves)[8]) {
    constexpr int kUpper = Bit == 4 ? 0xf0 : Bit == 2 ? 0xcc : 0xaa;  // corners at the upper end of the axis
    PSK_UNROLL
    for (int t = 0; t < 8; ++t)
      if ((t & Bit) == 0) leaves[t] = (leaves[t] & ~kUpper) | (leaves[t | Bit] & kUpper);
  }

  /// divergence_by_cells at all corners.
  PSK_INLINE static void add_cells(const int (&leaves)[8], const float (&element)[8][8],
                                   const octree::NeighbourLanes& v, Float8& sum) {
    PSK_UNROLL
    for (int t = 0; t < 8; ++t) {
      if (leaves[t] == 0) continue;
      const int x = octree::slot_x(t) - 1;
      const int y = octree::slot_y(t) - 1;
      const int z = octree::slot_z(t) - 1;
      Float8 with_cell = sum;
      PSK_UNROLL
      for (int j = 0; j < 8; ++j)
        with_cell += element[7 - t][j] * v(x + octree::slot_x(j), y + octree::slot_y(j), z + octree::slot_z(j));
      sum = select(mask_of_bits(leaves[t]), with_cell, sum);
    }
  }
#endif
};

}  // namespace pointskin::poisson
