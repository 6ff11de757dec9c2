#pragma once

#include <vector>

#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "octree/neighbourhood.hpp"
#include "poisson/divergence.hpp"
#include "poisson/splat_kernel.hpp"
#include "poisson/stencil.hpp"

namespace pointskin::poisson {
namespace divergence {

/// Samples of one splat depth: positions among all samples (`rank`) and the samples themselves (`chosen`).
struct Subset {
  ArrayView<const std::int32_t> rank;    // (n + 1) chosen samples before a sample; empty: all samples are chosen
  ArrayView<const std::int32_t> chosen;  // sample of each rank; empty as above
};

/// V at the corners of a level in units of 1 / h, one array an axis.
struct VectorField {
  ArrayView<float> axis[3];
};

/// V of the level above, on this level's finer hats. In units of 1 / h it halves.
struct ProlongField {
  octree::LevelView level, above;
  VectorField above_field, field;
  PSK_HD void operator()(std::int64_t n) const {
    const std::int32_t parent = level.parent[n >> 3];
    const int slot = static_cast<int>(n & 7);
    for (int a = 0; a < 3; ++a)
      field.axis[a][n] = 0.5F * octree::prolonged(above, above_field.axis[a].data, parent, slot);
  }
};

/// Adds the samples of one splat depth to V at the corners of a brick.
struct SplatNormals {
  octree::LevelView level;
  SamplesView samples;
  Subset subset;
  float area_scale;  // finest cells^2 -> cells^2 of this level
  VectorField field;

  PSK_HD void operator()(std::int64_t brick) const {
    const octree::Coordinates origin = brick_origin(level, brick);
    const auto scale = static_cast<float>(1 << level.depth);
    float sum[3][8] = {};
    for_points_around(level, brick, [&](std::int32_t first, std::int32_t last) {
      const bool all = subset.rank.empty();
      const std::int32_t begin = all ? first : subset.rank[first];
      const std::int32_t end = all ? last : subset.rank[last];
      for (std::int32_t i = begin; i < end; ++i) add(all ? i : subset.chosen[i], origin, scale, sum);
    });
    for (int a = 0; a < 3; ++a)
      for (int s = 0; s < 8; ++s) field.axis[a][8 * brick + s] += sum[a][s];
  }

  PSK_HD void add(std::int32_t sample, const octree::Coordinates& origin, float scale, float (&sum)[3][8]) const {
    const BrickSample at(samples.positions[sample], origin, scale);
    if (!at.reaches<QuadraticKernel>()) return;
    float w[8];
    at.weights<QuadraticKernel>(w);
    const Vec3f n = samples.normals[sample];
    const float area = samples.areas[sample] * area_scale;
    const float v[3] = {-area * n.x, -area * n.y, -area * n.z};
    for (int a = 0; a < 3; ++a)
      for (int s = 0; s < 8; ++s) sum[a][s] += w[s] * v[a];
  }
};

/// Coefficients of the divergence: of a corner whose 8 cells all exist, and of single cells.
struct Coefficients {
  float inside[3][27];     ///< [axis][neighbour index]
  float element[3][8][8];  ///< [axis][corner i][corner j]: integral over a unit cell of phi_j d phi_i / d axis
};
constexpr Coefficients make_coefficients() {
  constexpr double kMass[2][2] = {{2 / 6.0, 1 / 6.0}, {1 / 6.0, 2 / 6.0}};
  Coefficients c{};
  for (std::size_t axis = 0; axis < 3; ++axis) {
    for (std::size_t j = 0; j < 27; ++j)
      c.inside[axis][j] = static_cast<float>(divergence_coefficient(axis, {j / 9, j / 3 % 3, j % 3}));
    for (int i = 0; i < 8; ++i)
      for (int j = 0; j < 8; ++j) {
        double product = 1;
        for (int a = 0; a < 3; ++a) {
          const int bi = i >> (2 - a) & 1;
          const int bj = j >> (2 - a) & 1;
          product *= a == static_cast<int>(axis) ? (bi != 0 ? 0.5 : -0.5) : kMass[bi][bj];
        }
        c.element[axis][i][j] = static_cast<float>(product);
      }
  }
  return c;
}

/// Divergence of V over the leaf cells of a level, tested with the hats at a brick's corners.
struct Divergence {
  octree::LevelView level;
  std::int32_t finer_cell_bricks;  // of the level below; 0 at the finest level, where all cells are leaves
  VectorField field;
  Coefficients coefficients;
  ArrayView<float> b;

  PSK_HD void operator()(std::int64_t brick) const {
    // Corners inside the finest level see 8 leaves, so their cells' matrices are summed beforehand.
    const int inside_corners = finer_cell_bricks == 0 ? level.unknowns[brick] & ~face_corners(brick) : 0;
    float sum[8] = {};
    for (int axis = 0; axis < 3; ++axis) {
      const octree::Neighbourhood v = octree::load_neighbourhood(level, brick, field.axis[axis].data);
      PSK_UNROLL for (int s = 0; s < 8; ++s) {
        sum[s] += (inside_corners >> s & 1) != 0 ? inside(v, s, coefficients.inside[axis])
                                                 : by_cells(brick, v, s, coefficients.element[axis]);
      }
    }
    for (int s = 0; s < 8; ++s) b[8 * brick + s] = sum[s];
  }

  /// Corners of the brick that lie on a face of the cube: unknowns with fewer than 8 cells.
  PSK_HD int face_corners(std::int64_t brick) const {
    const octree::Coordinates c = octree::decode(level.brick_key[brick]);
    const std::int32_t last = 1 << level.depth;
    int mask = 0;
    for (int s = 0; s < 8; ++s) {
      const std::int32_t x = 2 * c.x + octree::slot_x(s);
      const std::int32_t y = 2 * c.y + octree::slot_y(s);
      const std::int32_t z = 2 * c.z + octree::slot_z(s);
      if (x == 0 || y == 0 || z == 0 || x == last || y == last || z == last) mask |= 1 << s;
    }
    return mask;
  }

  PSK_HD static float inside(const octree::Neighbourhood& v, int s, const float* coefficient) {
    float sum = 0;
    PSK_UNROLL for (int dx = -1; dx <= 1; ++dx) PSK_UNROLL for (int dy = -1; dy <= 1; ++dy)
        PSK_UNROLL for (int dz = -1; dz <= 1; ++dz) sum +=
        coefficient[octree::neighbour_index(dx, dy, dz)] *
        v.at(octree::slot_x(s) + dx, octree::slot_y(s) + dy, octree::slot_z(s) + dz);
    return sum;
  }

  /// Sum over the leaf cells around corner `s` of their element matrices' rows.
  PSK_HD float by_cells(std::int64_t brick, const octree::Neighbourhood& v, int s, const float (&element)[8][8]) const {
    float sum = 0;
    for (int t = 0; t < 8; ++t) {
      const int x = octree::slot_x(s) + octree::slot_x(t) - 1;
      const int y = octree::slot_y(s) + octree::slot_y(t) - 1;
      const int z = octree::slot_z(s) + octree::slot_z(t) - 1;
      if (!is_leaf(level.neighbour(static_cast<std::int32_t>(8 * brick), x, y, z))) continue;
      for (int j = 0; j < 8; ++j)  // the corner is number 7 - t of that cell
        sum += element[7 - t][j] * v.at(x + octree::slot_x(j), y + octree::slot_y(j), z + octree::slot_z(j));
    }
    return sum;
  }

  PSK_HD bool is_leaf(std::int32_t node) const {
    if (!level.is_cell(node)) return false;
    if (finer_cell_bricks == 0) return true;
    const std::int32_t brick = level.child_brick[node];
    return brick < 0 || brick >= finer_cell_bricks;
  }
};

/// Adds the restriction of the finer level's b. It conserves the integral; in units of h, b halves.
struct AddRestriction {
  octree::LevelView level, below;
  const float* below_b;
  bool add;
  ArrayView<float> b;
  PSK_HD void operator()(std::int64_t n) const {
    const float finer = 0.5F * octree::restricted(level, below, below_b, static_cast<std::int32_t>(n));
    b[n] = add ? b[n] + finer : finer;
  }
};

struct IsAtDepth {
  ArrayView<const std::uint8_t> depths;
  int depth;
  PSK_HD bool operator()(std::int64_t i) const { return depths[i] == depth; }
};
struct FlagDepth {
  IsAtDepth is_at;
  ArrayView<std::int32_t> flags;
  PSK_HD void operator()(std::int64_t i) const { flags[i] = is_at(i) ? 1 : 0; }
};

/// The samples whose splat depth is `depth`.
struct ChosenSamples {
  exec::Buffer<std::int32_t> rank, chosen;
  bool none = false;
};
template <exec::Space Exec>
ChosenSamples choose_samples(Exec& ex, const SamplesView& samples, int depth) {
  const IsAtDepth is_at{samples.splat_depths, depth};
  ChosenSamples result;
  result.chosen = select(ex, "splat.choose", samples.positions.size, is_at);
  result.none = result.chosen.empty();
  if (result.none) return result;
  auto flags = exec::make_buffer<std::int32_t>(ex, samples.positions.size);
  for_each(ex, "splat.choose", flags.size(), FlagDepth{is_at, flags.view()});
  result.rank = exec::make_buffer<std::int32_t>(ex, flags.size() + 1);
  exclusive_scan(ex, "splat.choose", flags.cview(), result.rank.view());
  return result;
}

/// V of one level.
struct FieldLevel {
  exec::Buffer<float> values;
  [[nodiscard]] VectorField view() const {
    const std::int64_t n = values.size() / 3;
    return {{values.view().part(0, n), values.view().part(n, n), values.view().part(2 * n, n)}};
  }
};

/// V on the levels from `coarsest` to the finest: what is splatted at a depth and, since hats are nested, all that was
/// splatted at coarser ones.
template <exec::Space Exec>
std::vector<FieldLevel> splat_field(Exec& ex, const octree::OctreeView& tree, const SamplesView& samples,
                                    int coarsest) {
  std::vector<FieldLevel> field(static_cast<std::size_t>(tree.depth) + 1);
  for (int d = coarsest; d <= tree.depth; ++d) {
    const octree::LevelView& level = tree.levels[d];
    FieldLevel& own = field[static_cast<std::size_t>(d)];
    own.values = exec::make_buffer<float>(ex, 3 * level.nodes());
    if (d == coarsest)
      exec::fill(ex, own.values.view(), 0.0F);
    else
      for_each(ex, "splat.prolong", level.nodes(),
               ProlongField{level, tree.levels[d - 1], field[static_cast<std::size_t>(d) - 1].view(), own.view()});
    ChosenSamples subset;
    if (coarsest < tree.depth) subset = choose_samples(ex, samples, d);
    if (subset.none) continue;
    const float area_scale = 1.0F / static_cast<float>(std::int64_t{1} << 2 * (tree.depth - d));
    for_each(ex, "splat.normals", level.bricks,
             SplatNormals{level, samples, {subset.rank.cview(), subset.chosen.cview()}, area_scale, own.view()});
  }
  return field;
}

}  // namespace divergence

template <exec::Space Exec>
exec::Buffer<float> splat_divergence(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples) {
  using namespace divergence;
  const octree::OctreeView view = tree.view();
  const int coarsest = samples.coarsest_splat_depth;
  std::vector<FieldLevel> field = splat_field(ex, view, samples, coarsest);
  auto b = exec::make_buffer<float>(ex, view.nodes);
  for (int d = view.depth; d >= 0; --d) {
    const octree::LevelView& level = view.levels[d];
    const ArrayView<float> own = b.view().part(level.first_node, level.nodes());
    const bool finest = d == view.depth;
    const bool has_field = d >= coarsest;
    if (has_field)
      for_each(ex, "splat.divergence", level.bricks,
               Divergence{level, finest ? 0 : view.levels[d + 1].cell_bricks, field[static_cast<std::size_t>(d)].view(),
                          make_coefficients(), own});
    field[static_cast<std::size_t>(d)] = {};
    if (finest) continue;
    const octree::LevelView& below = view.levels[d + 1];
    for_each(ex, "splat.restrict", level.nodes(),
             AddRestriction{level, below, b.data() + below.first_node, has_field, own});
  }
  return b;
}

}  // namespace pointskin::poisson
