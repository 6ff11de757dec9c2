#pragma once

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

/// V at the corners of a level times h^3, one array an axis.
struct VectorField {
  ArrayView<float> axis[3];
};

/// V at the corners of a brick.
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
      for (int s = 0; s < 8; ++s) field.axis[a][8 * brick + s] = sum[a][s];
  }

  PSK_HD void add(std::int32_t sample, const octree::Coordinates& origin, float scale, float (&sum)[3][8]) const {
    const BrickWeights weights = brick_weights<QuadraticKernel>(samples.positions[sample], origin, scale);
    const Vec3f n = samples.normals[sample];
    const float area = samples.areas[sample] * area_scale;
    const float v[3] = {-area * n.x, -area * n.y, -area * n.z};
    for (int s = 0; s < 8; ++s) {
      const float w = weights.at(s);
      for (int a = 0; a < 3; ++a) sum[a][s] += w * v[a];
    }
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

/// b of a level's brick from V at that level.
struct Divergence {
  octree::LevelView level;
  VectorField field;
  Coefficients coefficients;
  ArrayView<float> b;

  PSK_HD void operator()(std::int64_t brick) const {
    const int unknowns = level.unknowns[brick];
    float sum[8] = {};
    for (int axis = 0; axis < 3; ++axis) {
      const octree::Neighbourhood v = octree::load_neighbourhood(level, brick, field.axis[axis].data);
      PSK_UNROLL for (int s = 0; s < 8; ++s) {
        sum[s] += (unknowns >> s & 1) != 0 ? inside(v, s, coefficients.inside[axis])
                                           : at_border(brick, v, s, coefficients.element[axis]);
      }
    }
    for (int s = 0; s < 8; ++s) b[8 * brick + s] = sum[s];
  }

  PSK_HD static float inside(const octree::Neighbourhood& v, int s, const float* coefficient) {
    float sum = 0;
    PSK_UNROLL for (int dx = -1; dx <= 1; ++dx)
      PSK_UNROLL for (int dy = -1; dy <= 1; ++dy)
        PSK_UNROLL for (int dz = -1; dz <= 1; ++dz)
          sum += coefficient[octree::neighbour_index(dx, dy, dz)] *
                 v.at(octree::slot_x(s) + dx, octree::slot_y(s) + dy, octree::slot_z(s) + dz);
    return sum;
  }

  /// Sum over the existing cells around corner `s` of their element matrices' rows.
  PSK_HD float at_border(std::int64_t brick, const octree::Neighbourhood& v, int s, const float (&element)[8][8]) const {
    float sum = 0;
    for (int t = 0; t < 8; ++t) {
      const int x = octree::slot_x(s) + octree::slot_x(t) - 1;
      const int y = octree::slot_y(s) + octree::slot_y(t) - 1;
      const int z = octree::slot_z(s) + octree::slot_z(t) - 1;
      const std::int32_t cell = level.neighbour(static_cast<std::int32_t>(8 * brick), x, y, z);
      if (!level.is_cell(cell)) continue;
      for (int j = 0; j < 8; ++j)  // the corner is number 7 - t of that cell
        sum += element[7 - t][j] * v.at(x + octree::slot_x(j), y + octree::slot_y(j), z + octree::slot_z(j));
    }
    return sum;
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

struct DepthOf {
  ArrayView<const std::uint8_t> depths;
  PSK_HD std::int32_t operator()(std::int64_t i) const { return depths[i]; }
};
struct Smaller {
  PSK_HD std::int32_t operator()(std::int32_t a, std::int32_t b) const { return a < b ? a : b; }
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

/// Writes the divergence of what is splatted at `level` to `b`. @returns false, nothing written, if nothing is.
template <exec::Space Exec>
bool splat_level(Exec& ex, const octree::LevelView& level, int tree_depth, const SamplesView& samples,
                 ArrayView<float> b, bool all_samples) {
  ChosenSamples subset;
  if (!all_samples) subset = choose_samples(ex, samples, level.depth);
  if (subset.none) return false;
  const std::int64_t n = level.nodes();
  auto values = exec::make_buffer<float>(ex, 3 * n);
  const VectorField field{{values.view().part(0, n), values.view().part(n, n), values.view().part(2 * n, n)}};
  const float area_scale = 1.0F / static_cast<float>(std::int64_t{1} << 2 * (tree_depth - level.depth));
  for_each(ex, "splat.normals", level.bricks,
           SplatNormals{level, samples, {subset.rank.cview(), subset.chosen.cview()}, area_scale, field});
  for_each(ex, "splat.divergence", level.bricks, Divergence{level, field, make_coefficients(), b});
  return true;
}

}  // namespace divergence

template <exec::Space Exec>
exec::Buffer<float> splat_divergence(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples) {
  using namespace divergence;
  const octree::OctreeView view = tree.view();
  auto b = exec::make_buffer<float>(ex, view.nodes);
  exec::fill(ex, b.view().part(view.finest().first_node, view.finest().nodes()), 0.0F);
  const int coarsest = exec::reduce<std::int32_t>(ex, "splat.coarsest", samples.positions.size,
                                                  DepthOf{samples.splat_depths}, Smaller{});
  for (int d = view.depth; d >= 0; --d) {
    const octree::LevelView& level = view.levels[d];
    const ArrayView<float> own = b.view().part(level.first_node, level.nodes());
    const bool splatted = d >= coarsest && splat_level(ex, level, view.depth, samples, own, coarsest == view.depth);
    if (d == view.depth) continue;
    const octree::LevelView& below = view.levels[d + 1];
    for_each(ex, "splat.restrict", level.nodes(),
             AddRestriction{level, below, b.data() + below.first_node, splatted, own});
  }
  return b;
}

}  // namespace pointskin::poisson
