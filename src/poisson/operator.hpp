// The matrix-free operator of one level: Laplacian plus screening, for one corner or for all 8 corners of a brick, one
// after another or as the lanes of a vector.
//
// All give the same bits. Values and cells around a corner are named by their side along each axis, and every sum is a
// tree that does not change when the two sides of an axis change places. So a thread that has one corner may call the
// side away from the corner's brick -1, whichever it is, and keep all it loads in registers.
#pragma once

#include <cstdint>

#include "core/float8.hpp"
#include "octree/keys.hpp"
#include "octree/neighbourhood.hpp"
#include "octree/view.hpp"
#include "poisson/screening.hpp"
#include "poisson/stencil.hpp"

namespace pointskin::poisson {

/// One level's linear system  A u = b, in units of h:  A = Laplacian + screening.
struct LevelSystem {
  octree::LevelView level;
  const float* b = nullptr;  ///< divergence, (nodes of the level)
  ScreeningView screening;
  float screening_scale = 0;      ///< w 4^(d - D): turns a collapsed weight into a matrix weight; 0: no screening
  AxisRowsF rows{};               ///< for corners on the cube's faces
  const float* lumped = nullptr;  ///< (nodes of the level) instead of samples: a matrix weight at every corner, that
                                  ///< pulls it to 0 by itself; null: none
};

/// Values at the 27 corners around one corner, in registers; offsets -1, 0, 1 along each axis.
struct CornerValues {
  float value[27];
  PSK_HD float operator()(int x, int y, int z) const { return value[octree::neighbour_index(x, y, z)]; }
};

/// Values around corner (x, y, z) of a brick.
struct BrickCornerValues {
  const octree::Neighbourhood& around;
  int x, y, z;
  PSK_HD float operator()(int dx, int dy, int dz) const { return around.at(x + dx, y + dy, z + dz); }
};

/// Sum of the 12 edge and 8 corner neighbours with their coefficients, and the corner itself.
template <class Values>
PSK_HD PSK_INLINE auto laplacian_inside(const Values& u) {
  constexpr auto kCentre = static_cast<float>(InsideLaplacian::kCentre);
  constexpr auto kEdge = static_cast<float>(InsideLaplacian::kEdge);
  constexpr auto kCorner = static_cast<float>(InsideLaplacian::kCorner);
  const auto edges = ((u(-1, -1, 0) + u(-1, 1, 0)) + (u(1, -1, 0) + u(1, 1, 0))) +
                     ((u(-1, 0, -1) + u(-1, 0, 1)) + (u(1, 0, -1) + u(1, 0, 1))) +
                     ((u(0, -1, -1) + u(0, -1, 1)) + (u(0, 1, -1) + u(0, 1, 1)));
  const auto corners = ((u(-1, -1, -1) + u(-1, -1, 1)) + (u(-1, 1, -1) + u(-1, 1, 1))) +
                       ((u(1, -1, -1) + u(1, -1, 1)) + (u(1, 1, -1) + u(1, 1, 1)));
  return kCentre * u(0, 0, 0) + kEdge * edges + kCorner * corners;
}

/// Side of coordinate c of a corner of level `depth`.
PSK_HD inline int side_of(std::int32_t c, int depth) {
  return static_cast<int>(c == 0 ? AxisSide::lower_face : c == (1 << depth) ? AxisSide::upper_face : AxisSide::inside);
}

/// One-dimensional coefficients of one axis of a corner.
struct AxisCoefficients {
  float mass[3], stiffness[3];

  PSK_HD AxisCoefficients(const AxisRowsF& rows, int side, bool mirrored) {
    for (int i = 0; i < 3; ++i) {
      mass[i] = rows.mass[side][mirrored ? 2 - i : i];
      stiffness[i] = rows.stiffness[side][mirrored ? 2 - i : i];
    }
  }
  PSK_HD static float apply(const float (&row)[3], float lower, float middle, float upper) {
    return (row[0] * lower + row[2] * upper) + row[1] * middle;
  }
};

/// The same for a corner on the cube's faces, axis by axis: rows with one cell missing (natural boundary condition).
template <class Values>
PSK_HD inline float laplacian_at_face(const Values& u, const AxisCoefficients& x, const AxisCoefficients& y,
                                      const AxisCoefficients& z) {
  const auto along = [](const float(&row)[3], const float(&v)[3]) {
    return AxisCoefficients::apply(row, v[0], v[1], v[2]);
  };
  float mass_mass[3], rest[3];  // along y and z: M M, and K M + M K
  PSK_UNROLL
  for (int i = 0; i < 3; ++i) {
    float mass[3], stiffness[3];  // along z
    PSK_UNROLL
    for (int j = 0; j < 3; ++j) {
      const float row[3] = {u(i - 1, j - 1, -1), u(i - 1, j - 1, 0), u(i - 1, j - 1, 1)};
      mass[j] = along(z.mass, row);
      stiffness[j] = along(z.stiffness, row);
    }
    mass_mass[i] = along(y.mass, mass);
    rest[i] = along(y.stiffness, mass) + along(y.mass, stiffness);
  }
  return along(x.stiffness, mass_mass) + along(x.mass, rest);
}

/// True if some corner of the brick may lie on a face of the cube: a coordinate is 0 or 2^(depth - 1). Read off the
/// key, without decoding it.
PSK_HD inline bool touches_faces(std::uint64_t brick_key, int depth) {
  bool touches = depth == 0;
  PSK_UNROLL
  for (int axis = 0; axis < 3; ++axis) {
    const std::uint64_t coordinate = brick_key >> axis & octree::kEveryThirdBit;
    touches = touches || coordinate == 0 || coordinate == std::uint64_t{1} << 3 * (depth - 1);
  }
  return touches;
}

/// Sum over the 8 cells around a corner; the sides of an axis may change places.
template <class Float>
PSK_HD PSK_INLINE Float sum_of_cells(const Float (&cell)[8]) {
  return ((cell[0] + cell[1]) + (cell[2] + cell[3])) + ((cell[4] + cell[5]) + (cell[6] + cell[7]));
}

/// What the collapsed sample of a cell does, seen from one of the cell's corners.
struct Pull {
  float residual = 0, diagonal = 0;
};

/// Trilinear interpolation; weight[a][0] and u(0, ..) belong to this corner, weight[a][1] to the other end of axis a.
template <class Float, class Values>
PSK_HD PSK_INLINE Float value_in_cell(const Float (&weight)[3][2], const Values& u, int dx, int dy, int dz) {
  const auto mix = [](const Float(&w)[2], const Float& own, const Float& other) { return w[0] * own + w[1] * other; };
  const Float near = mix(weight[1], mix(weight[2], u(0, 0, 0), u(0, 0, dz)), mix(weight[2], u(0, dy, 0), u(0, dy, dz)));
  const Float far =
      mix(weight[1], mix(weight[2], u(dx, 0, 0), u(dx, 0, dz)), mix(weight[2], u(dx, dy, 0), u(dx, dy, dz)));
  return mix(weight[0], near, far);
}

/// Residual b - A u at a corner and a diagonal that bounds A: the diagonal matrix minus A is positive semidefinite, so
/// all eigenvalues of diagonal^-1 A lie in [0, 1].
struct CornerResidual {
  float residual = 0, diagonal = kLargestEigenvalue;

  PSK_HD void add(const float (&residuals)[8], const float (&diagonals)[8]) {
    residual += sum_of_cells(residuals);
    diagonal += sum_of_cells(diagonals);
  }
  /// A weight that pulls the corner's value to 0.
  PSK_HD void hold(float weight, float value) {
    residual -= weight * value;
    diagonal += weight;
  }
};

/// Laplacian at corner `slot` of a brick.
/// @param mirrored  u calls the side away from the brick -1, on every axis
template <class Values>
PSK_HD PSK_INLINE float laplacian_at(const LevelSystem& system, std::uint64_t brick_key, int slot, bool mirrored,
                                     const Values& u) {
  const int depth = system.level.depth;
  if (!touches_faces(brick_key, depth)) return laplacian_inside(u);
  const octree::Coordinates at = octree::decode(brick_key);
  const auto along = [&](std::int32_t brick_coordinate, int upper) {
    return AxisCoefficients(system.rows, side_of(2 * brick_coordinate + upper, depth), mirrored && upper != 0);
  };
  return laplacian_at_face(u, along(at.x, octree::slot_x(slot)), along(at.y, octree::slot_y(slot)),
                           along(at.z, octree::slot_z(slot)));
}

/// What a collapsed sample does at a corner.
/// @param side      bit 4, 2, 1: on which side of the corner the cell lies along x, y, z, in the words of u
/// @param at_upper  bit 4, 2, 1: the corner is the cell's upper end along x, y, z
template <class Values>
PSK_HD PSK_INLINE Pull pull_at_corner(const CollapsedSample& sample, float screening_scale, int side, int at_upper,
                                      const Values& u) {
  if (!(sample.weight > 0)) return {};
  const float local[3] = {sample.x, sample.y, sample.z};
  float weight[3][2];
  PSK_UNROLL
  for (int a = 0; a < 3; ++a) {
    const bool upper = (at_upper >> (2 - a) & 1) != 0;
    weight[a][0] = upper ? local[a] : 1 - local[a];
    weight[a][1] = upper ? 1 - local[a] : local[a];
  }
  const float value = value_in_cell(weight, u, 2 * octree::slot_x(side) - 1, 2 * octree::slot_y(side) - 1,
                                    2 * octree::slot_z(side) - 1);
  const float total = screening_scale * sample.weight;
  const float own = weight[0][0] * weight[1][0] * weight[2][0];
  return {own * (total * (0.5F - value)), own * total};
}

/// The operator at one unknown corner, for spaces with many threads. What does not change from iteration to iteration
/// is looked up once.
class CornerOperator {
 public:
  PSK_HD CornerOperator(const LevelSystem& system, std::int64_t node)
      : system_(system),
        slot_(static_cast<int>(node & 7)),
        b_(system.b[node]),
        lumped_(system.lumped == nullptr ? 0.0F : system.lumped[node]),
        brick_key_(system.level.brick_key[node >> 3]) {
    const std::int32_t* bricks = system.level.neighbours + (node >> 3) * octree::kNeighbours;
    find_bricks(bricks, static_cast<std::int32_t>(node >> 3));
    if (system.screening_scale > 0) any_samples_ = (system.screening.corners[node >> 3] >> (node & 7) & 1) != 0;
    if (any_samples_) find_samples(bricks);
  }

  /// @param value  receives the corner's own value
  [[nodiscard]] PSK_HD CornerResidual residual(const float* u, float& value) const {
    const CornerValues values = load(u);
    value = values(0, 0, 0);
    CornerResidual out;
    out.residual = b_ - laplacian_at(system_, brick_key_, slot_, true, values);
    if (any_samples_) screen(values, out);
    out.hold(lumped_, value);
    return out;
  }

 private:
  /// Bricks that hold the values around: the corner's own (0) and the seven beyond the corner. The side away from the
  /// own brick is called -1 here. Beyond the cube there is none: the own one stands in, its values will count zero.
  PSK_HD void find_bricks(const std::int32_t* bricks, std::int32_t own) {
    const int step[3] = {2 * octree::slot_x(slot_) - 1, 2 * octree::slot_y(slot_) - 1, 2 * octree::slot_z(slot_) - 1};
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const std::int32_t brick = bricks[octree::neighbour_index(
          octree::slot_x(s) * step[0], octree::slot_y(s) * step[1], octree::slot_z(s) * step[2])];
      brick_[s] = brick < 0 ? own : brick;
    }
  }

  [[nodiscard]] PSK_HD CornerValues load(const float* u) const {
    CornerValues values;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const int dx = octree::slot_x(s);
      const int dy = octree::slot_y(s);
      const int dz = octree::slot_z(s);
      const float* corners = u + std::int64_t{8} * brick_[s];
      // Along an axis the brick beyond holds the value at -1, the own brick those at 0 and 1.
      PSK_UNROLL
      for (int x = -1; x <= 1; ++x) {
        PSK_UNROLL
        for (int y = -1; y <= 1; ++y) {
          PSK_UNROLL
          for (int z = -1; z <= 1; ++z) {
            if ((x == -1) != (dx != 0) || (y == -1) != (dy != 0) || (z == -1) != (dz != 0)) continue;
            const int other = slot_ ^ octree::slot_of(x != 0 ? 1 : 0, y != 0 ? 1 : 0, z != 0 ? 1 : 0);
            values.value[octree::neighbour_index(x, y, z)] = corners[other];
          }
        }
      }
    }
    return values;
  }

  /// Collapsed samples of the 8 cells around, by side: 0 beyond the corner, 1 on the brick's side. A cell belongs to
  /// the node at its lower corner, so cells beyond an upper corner (slot 1) are the brick's own.
  PSK_HD void find_samples(const std::int32_t* bricks) {
    std::int32_t place[8];
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const int before = ~(s | slot_) & 7;  // axes along which the cell is of the brick before
      const std::int32_t brick =
          bricks[octree::neighbour_index(-octree::slot_x(before), -octree::slot_y(before), -octree::slot_z(before))];
      place[s] = brick < 0 ? -1 : system_.screening.brick_index[brick];
    }
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      sample_[s].weight = 0;
      if (place[s] >= 0) sample_[s] = system_.screening.samples[8 * std::int64_t{place[s]} + (7 - s)];
    }
  }

  PSK_HD void screen(const CornerValues& u, CornerResidual& out) const {
    float residuals[8], diagonals[8];
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      const int at_upper = ~(s ^ slot_) & 7;  // cells beyond a lower corner end there, so do those beside an upper one
      const Pull pull = pull_at_corner(sample_[s], system_.screening_scale, s, at_upper, u);
      residuals[s] = pull.residual;
      diagonals[s] = pull.diagonal;
    }
    out.add(residuals, diagonals);
  }

  const LevelSystem& system_;
  int slot_;
  float b_, lumped_;
  std::uint64_t brick_key_;
  std::int32_t brick_[8];
  CollapsedSample sample_[8];
  bool any_samples_ = false;
};

/// Residual and bounding diagonal at the 8 corners of a brick. Entries of corners that are no unknowns mean nothing.
struct BrickResidual {
  CornerResidual corner[8];
};

/// The collapsed samples of the 27 cells around a brick's corners.
struct BrickPulls {
  CollapsedSample sample[27];
  float pull[27];  // weight (1/2 - value)
};

/// Finds the samples around a brick, and how hard they pull.
PSK_HD inline void load_pulls(const LevelSystem& system, std::int64_t brick, const octree::Neighbourhood& u,
                              BrickPulls& out) {
  const std::int32_t* bricks = system.level.neighbours + brick * octree::kNeighbours;
  PSK_UNROLL
  for (int x = -1; x <= 1; ++x) {
    PSK_UNROLL
    for (int y = -1; y <= 1; ++y) {
      PSK_UNROLL
      for (int z = -1; z <= 1; ++z) {
        const int j = octree::neighbour_index(x, y, z);
        out.sample[j] = {};
        out.pull[j] = 0;
        const std::int32_t other =
            bricks[octree::neighbour_index(octree::brick_step(x), octree::brick_step(y), octree::brick_step(z))];
        const std::int32_t place = other < 0 ? -1 : system.screening.brick_index[other];
        if (place < 0) continue;
        const CollapsedSample& sample =
            system.screening.samples[8 * std::int64_t{place} + octree::slot_of(x & 1, y & 1, z & 1)];
        if (!(sample.weight > 0)) continue;
        const float weight[3][2] = {{1 - sample.x, sample.x}, {1 - sample.y, sample.y}, {1 - sample.z, sample.z}};
        const float value = value_in_cell(weight, BrickCornerValues{u, x, y, z}, 1, 1, 1);
        const float total = system.screening_scale * sample.weight;
        out.sample[j] = {sample.x, sample.y, sample.z, total};
        out.pull[j] = total * (0.5F - value);
      }
    }
  }
}

/// Adds the screening of the 8 cells around corner (x, y, z) of the brick.
PSK_HD inline void screen_corner(const BrickPulls& pulls, int x, int y, int z, CornerResidual& out) {
  float residuals[8], diagonals[8];
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) {
    const int i = octree::slot_x(s);  // the corner is end 1 - i of its cell along x
    const int j = octree::slot_y(s);
    const int k = octree::slot_z(s);
    const int cell = octree::neighbour_index(x + i - 1, y + j - 1, z + k - 1);
    const CollapsedSample& sample = pulls.sample[cell];
    residuals[s] = 0;
    diagonals[s] = 0;
    if (!(sample.weight > 0)) continue;
    const float own =
        (i == 0 ? sample.x : 1 - sample.x) * (j == 0 ? sample.y : 1 - sample.y) * (k == 0 ? sample.z : 1 - sample.z);
    residuals[s] = own * pulls.pull[cell];
    diagonals[s] = own * sample.weight;
  }
  out.add(residuals, diagonals);
}

/// Residual and bounding diagonal of a whole brick, for spaces with few threads.
PSK_HD inline BrickResidual brick_residual(const LevelSystem& system, std::int64_t brick,
                                           const octree::Neighbourhood& u) {
  BrickResidual out;
  const std::uint64_t brick_key = system.level.brick_key[brick];
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) {
    const BrickCornerValues values{u, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s)};
    out.corner[s].residual = system.b[8 * brick + s] - laplacian_at(system, brick_key, s, false, values);
    out.corner[s].hold(system.lumped == nullptr ? 0.0F : system.lumped[8 * brick + s], values(0, 0, 0));
  }
  if (!(system.screening_scale > 0) || system.screening.corners[brick] == 0) return out;
  BrickPulls pulls;
  load_pulls(system, brick, u, pulls);
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) {
    if ((system.screening.corners[brick] >> s & 1) != 0)
      screen_corner(pulls, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s), out.corner[s]);
  }
  return out;
}

#if PSK_WIDE

/// Residual and bounding diagonal at the 8 corners of a brick, a lane each.
struct BrickResidual8 {
  Float8 residual, diagonal;
};

/// Collapsed samples of 8 cells, with the weight they have in the matrix.
struct CellLanes {
  Float8 x{}, y{}, z{}, weight{};
};

/// The cells around a brick's corners: [s] lies at offset slot(s) - 1 from each corner.
struct CellsAround {
  CellLanes cell[8];

  /// Turns the cells of whole bricks (before, own) into those at offsets -1 and 0 along an axis.
  template <int Axis>
  PSK_INLINE void step_along() {
    constexpr int kBit = 4 >> Axis;
    PSK_UNROLL
    for (int s = 0; s < 8; ++s) {
      if ((s & kBit) != 0) continue;
      const CellLanes& upper = cell[s | kBit];
      cell[s].x = between<Axis>(cell[s].x, upper.x);
      cell[s].y = between<Axis>(cell[s].y, upper.y);
      cell[s].z = between<Axis>(cell[s].z, upper.z);
      cell[s].weight = between<Axis>(cell[s].weight, upper.weight);
    }
  }
};

/// Finds the samples around a brick.
PSK_INLINE void load_cells(const LevelSystem& system, std::int64_t brick, CellsAround& out) {
  const std::int32_t* bricks = system.level.neighbours + brick * octree::kNeighbours;
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) {
    const std::int32_t other =
        bricks[octree::neighbour_index(octree::slot_x(s) - 1, octree::slot_y(s) - 1, octree::slot_z(s) - 1)];
    const std::int32_t place = other < 0 ? -1 : system.screening.brick_index[other];
    out.cell[s] = {};
    if (place < 0) continue;
    Float8 column[4];
    load_columns(&system.screening.samples[8 * std::int64_t{place}].x, column);
    out.cell[s] = {column[0], column[1], column[2], system.screening_scale * column[3]};
  }
  out.step_along<0>();
  out.step_along<1>();
  out.step_along<2>();
}

/// Values at the corners of the cells at offset slot(s) - 1, for value_in_cell.
struct CellCornerLanes {
  const octree::NeighbourLanes& around;
  int s;
  PSK_INLINE const Float8& operator()(int dx, int dy, int dz) const {
    return around(octree::slot_x(s) - 1 + dx, octree::slot_y(s) - 1 + dy, octree::slot_z(s) - 1 + dz);
  }
};

/// Adds the screening of the 8 cells around each corner: load_pulls and screen_corner, 8 corners at once.
PSK_INLINE void screen_lanes(const LevelSystem& system, std::int64_t brick, const octree::NeighbourLanes& u,
                             BrickResidual8& out) {
  CellsAround cells;
  load_cells(system, brick, cells);
  Float8 residuals[8], diagonals[8];
  PSK_UNROLL
  for (int s = 0; s < 8; ++s) {
    const CellLanes& cell = cells.cell[s];
    const Float8 weight[3][2] = {{1 - cell.x, cell.x}, {1 - cell.y, cell.y}, {1 - cell.z, cell.z}};
    const Float8 value = value_in_cell(weight, CellCornerLanes{u, s}, 1, 1, 1);
    const Float8 own =  // the corner is the upper end of the cell below it
        weight[0][1 - octree::slot_x(s)] * weight[1][1 - octree::slot_y(s)] * weight[2][1 - octree::slot_z(s)];
    const Mask8 has_sample = cell.weight > 0;
    residuals[s] = select(has_sample, own * (cell.weight * (0.5F - value)), Float8{});
    diagonals[s] = select(has_sample, own * cell.weight, Float8{});
  }
  const Mask8 screened = mask_of_bits(system.screening.corners[brick]);
  out.residual = select(screened, out.residual + sum_of_cells(residuals), out.residual);
  out.diagonal = select(screened, out.diagonal + sum_of_cells(diagonals), out.diagonal);
}

/// brick_residual, with the same bits, of a brick that does not touch the cube's faces.
PSK_INLINE void residual_lanes(const LevelSystem& system, std::int64_t brick, const octree::NeighbourLanes& u,
                               BrickResidual8& out) {
  out.residual = load8(system.b + 8 * brick) - laplacian_inside(u);
  out.diagonal = Float8{} + kLargestEigenvalue;
  if (system.screening_scale > 0 && system.screening.corners[brick] != 0) screen_lanes(system, brick, u, out);
  const Float8 lumped = system.lumped == nullptr ? Float8{} : load8(system.lumped + 8 * brick);
  out.residual = out.residual - lumped * u(0, 0, 0);
  out.diagonal = out.diagonal + lumped;
}

#endif

}  // namespace pointskin::poisson
