#pragma once

#include <algorithm>
#include <type_traits>
#include <vector>

#include "exec/algorithms.hpp"
#include "octree/access.hpp"
#include "octree/neighbourhood.hpp"
#include "poisson/divergence.hpp"
#include "poisson/splat_kernel.hpp"
#include "poisson/stencil.hpp"

namespace pointskin::poisson {
namespace divergence {

/// Samples splatted at one level: positions among all samples (`rank`) and the samples themselves (`chosen`). Where
/// most samples are wanted both are empty, and others are passed over.
struct Subset {
  ArrayView<const std::int32_t> rank;    // (n + 1) chosen samples before a sample
  ArrayView<const std::int32_t> chosen;  // sample of each rank

  [[nodiscard]] PSK_HD bool is_list() const { return !rank.empty(); }
  [[nodiscard]] PSK_HD std::int32_t rank_of(std::int32_t sample) const { return is_list() ? rank[sample] : sample; }
  [[nodiscard]] PSK_HD std::int32_t sample_of(std::int32_t rank_in_list) const {
    return is_list() ? chosen[rank_in_list] : rank_in_list;
  }
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
    std::int32_t corner[8];
    PSK_UNROLL for (int s = 0; s < 8; ++s) corner[s] =
        (s & ~slot) != 0 ? -1 : above.neighbour(parent, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s));
    const float share = 0.5F / static_cast<float>(1 << count_bits(static_cast<std::uint64_t>(slot)));
    PSK_UNROLL for (int a = 0; a < 3; ++a) {
      float sum = 0;
      PSK_UNROLL for (int s = 0; s < 8; ++s) if (corner[s] >= 0) sum += above_field.axis[a][corner[s]];
      field.axis[a][n] = sum * share;
    }
  }
};

/// Samples to be splatted at one level.
struct SplatSource {
  octree::LevelView level;
  SamplesView samples;
  Subset subset;
  float area_scale;  // finest cells^2 -> cells^2 of this level

  [[nodiscard]] PSK_HD bool is_splatted(std::int32_t sample) const {
    return subset.is_list() || splat_share(samples.splat_depths[sample], level.depth) > 0;
  }

  /// What the sample adds to V of the level: -area n.
  [[nodiscard]] PSK_HD Vec3f vector(std::int32_t sample) const {
    const Vec3f n = samples.normals[sample];
    const float area = samples.areas[sample] * (area_scale * splat_share(samples.splat_depths[sample], level.depth));
    return {-area * n.x, -area * n.y, -area * n.z};
  }
};

/// Adds samples to V at the corners of a brick. A GPU has a kernel of its own for it (splat_kernel.cuh).
struct SplatToBricks {
  SplatSource source;
  VectorField field;

  PSK_HD void operator()(std::int64_t brick) const {
    const octree::Coordinates origin = brick_origin(source.level, brick);
    const auto scale = static_cast<float>(1 << source.level.depth);
    float sum[3][8] = {};
    bool any = false;
    for_points_around(source.level, brick, [&](std::int32_t first, std::int32_t last) {
      const std::int32_t end = source.subset.rank_of(last);
      for (std::int32_t rank = source.subset.rank_of(first); rank < end; ++rank) {
        add(source.subset.sample_of(rank), origin, scale, sum);
        any = true;
      }
    });
    if (!any) return;
    for (int a = 0; a < 3; ++a)
      for (int s = 0; s < 8; ++s) field.axis[a][8 * brick + s] += sum[a][s];
  }

  PSK_HD void add(std::int32_t sample, const octree::Coordinates& origin, float scale, float (&sum)[3][8]) const {
    if (!source.is_splatted(sample)) return;
    const BrickSample at(source.samples.positions[sample], origin, scale);
    if (!at.reaches<QuadraticKernel>()) return;
    float w[8];
    at.weights<QuadraticKernel>(w);
    const Vec3f v = source.vector(sample);
    for (int s = 0; s < 8; ++s) sum[0][s] += w[s] * v.x;
    for (int s = 0; s < 8; ++s) sum[1][s] += w[s] * v.y;
    for (int s = 0; s < 8; ++s) sum[2][s] += w[s] * v.z;
  }

#if PSK_WIDE
  static constexpr int kBatch = 64;  ///< samples that are tested before those that reach the brick are added

  /// Sums over the samples so far, a lane for each corner.
  struct Sums {
    Float8 axis[3] = {};
    bool any = false;
  };

  PSK_INLINE void wide(std::int64_t brick) const {
    const octree::Coordinates origin = brick_origin(source.level, brick);
    Sums sums;
    for_points_around(source.level, brick, [&](std::int32_t first, std::int32_t last) {
      const std::int32_t end = source.subset.rank_of(last);
      for (std::int32_t rank = source.subset.rank_of(first); rank < end; rank += kBatch)
        add_batch(rank, rank + kBatch < end ? rank + kBatch : end, origin, sums);
    });
    if (!sums.any) return;
    PSK_UNROLL for (int a = 0; a < 3; ++a) {
      float* v = &field.axis[a][8 * brick];
      store8(load8(v) + sums.axis[a], v);
    }
  }

  /// Samples of ranks [first, last), at most kBatch: those that reach the brick are listed before they are added.
  PSK_INLINE void add_batch(std::int32_t first, std::int32_t last, const octree::Coordinates& origin,
                            Sums& sums) const {
    const auto scale = static_cast<float>(1 << source.level.depth);
    std::int32_t reaching[kBatch];
    int count = 0;
    for (std::int32_t rank = first; rank < last; ++rank) {
      const std::int32_t sample = source.subset.sample_of(rank);
      const BrickSample at(source.samples.positions[sample], origin, scale);
      reaching[count] = sample;
      count += at.reaches_unordered<QuadraticKernel>() ? 1 : 0;
    }
    for (int i = 0; i < count; ++i) {
      if (!source.is_splatted(reaching[i])) continue;
      Float8 w;
      BrickSample(source.samples.positions[reaching[i]], origin, scale).weights<QuadraticKernel>(w);
      const Vec3f v = source.vector(reaching[i]);
      sums.axis[0] += w * v.x;
      sums.axis[1] += w * v.y;
      sums.axis[2] += w * v.z;
      sums.any = true;
    }
  }
#endif
};

/// Coefficients of the divergence over single cells: [axis][corner i][corner j] of D S S and its permutations. With M
/// in place of S they would be the integral over a unit cell of phi_j d phi_i / d axis; S also averages across the
/// axis.
struct Coefficients {
  float element[3][8][8];
};
constexpr Coefficients make_coefficients() {
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
  PSK_UNROLL for (int j = -1; j <= 1; ++j) {
    Float slope[3];
    PSK_UNROLL for (int k = -1; k <= 1; ++k) slope[k + 1] = axis == 0   ? v(1, j, k) - v(-1, j, k)
                                                            : axis == 1 ? v(j, 1, k) - v(j, -1, k)
                                                                        : v(j, k, 1) - v(j, k, -1);
    along[j + 1] = sum(slope);
  }
  return kWeight * sum(along);
}

/// Sum over the leaf cells around a corner of their element matrices' rows. Bit t of `leaves`: the cell at offset
/// slot(t) - 1 is a leaf.
template <class Values>
PSK_HD inline float divergence_by_cells(int leaves, const float (&element)[8][8], const Values& v) {
  float sum = 0;
  PSK_UNROLL for (int t = 0; t < 8; ++t) {
    if ((leaves >> t & 1) == 0) continue;
    const int x = octree::slot_x(t) - 1;
    const int y = octree::slot_y(t) - 1;
    const int z = octree::slot_z(t) - 1;
    PSK_UNROLL for (int j = 0; j < 8; ++j)  // the corner is number 7 - t of that cell
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
    PSK_UNROLL for (int t = 0; t < 8; ++t) {
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
      PSK_UNROLL for (int s = 0; s < 8; ++s) {
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
    PSK_UNROLL for (int t = 0; t < 8; ++t) {
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
    PSK_UNROLL for (int t = 0; t < 8; ++t) leaves[t] = 0;
    for (int s = 0; s < 8; ++s) {
      const int around = leaves_around(static_cast<std::int32_t>(8 * brick + s));
      PSK_UNROLL for (int t = 0; t < 8; ++t) leaves[t] |= (around >> t & 1) << s;
    }
  }

  /// On the finest level all cells are leaves, and but for the root cells are whole bricks.
  PSK_INLINE void find_finest_cells(std::int64_t brick, int (&leaves)[8]) const {
    const std::int32_t* bricks = level.neighbours + brick * octree::kNeighbours;
    PSK_UNROLL for (int t = 0; t < 8; ++t) {
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
    PSK_UNROLL for (int t = 0; t < 8; ++t) if ((t & Bit) == 0) leaves[t] =
        (leaves[t] & ~kUpper) | (leaves[t | Bit] & kUpper);
  }

  /// divergence_by_cells at all corners.
  PSK_INLINE static void add_cells(const int (&leaves)[8], const float (&element)[8][8],
                                   const octree::NeighbourLanes& v, Float8& sum) {
    PSK_UNROLL for (int t = 0; t < 8; ++t) {
      if (leaves[t] == 0) continue;
      const int x = octree::slot_x(t) - 1;
      const int y = octree::slot_y(t) - 1;
      const int z = octree::slot_z(t) - 1;
      Float8 with_cell = sum;
      PSK_UNROLL for (int j = 0; j < 8; ++j) with_cell +=
          element[7 - t][j] * v(x + octree::slot_x(j), y + octree::slot_y(j), z + octree::slot_z(j));
      sum = select(mask_of_bits(leaves[t]), with_cell, sum);
    }
  }
#endif
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

/// The complete levels above all samples' splat depths, one a round.
struct RestrictLevels : exec::SweepAll {
  octree::OctreeView tree;
  int first;  // depth of round 0
  float* b;

  PSK_HD void operator()(int round, int n, Nothing) const {
    const octree::LevelView& level = tree.levels[first - round];
    const octree::LevelView& below = tree.levels[first - round + 1];
    if (n < level.nodes()) b[level.first_node + n] = 0.5F * octree::restricted(level, below, b + below.first_node, n);
  }
};

struct FlagLevel {
  ArrayView<const float> splat_depths;
  int depth;
  ArrayView<std::int32_t> flags;
  PSK_HD void operator()(std::int64_t i) const { flags[i] = splat_share(splat_depths[i], depth) > 0 ? 1 : 0; }
};
struct ListChosen {
  ArrayView<const std::int32_t> rank;
  ArrayView<std::int32_t> chosen;
  PSK_HD void operator()(std::int64_t i) const {
    if (rank[i] < rank[i + 1]) chosen[rank[i]] = static_cast<std::int32_t>(i);
  }
};

/// The samples that are splatted at level `depth`.
struct ChosenSamples {
  exec::Buffer<std::int32_t> rank, chosen;
};
template <exec::Space Exec>
ChosenSamples choose_samples(Exec& ex, const SamplesView& samples, int depth) {
  const std::int64_t n = samples.positions.size;
  ChosenSamples result{exec::make_buffer<std::int32_t>(ex, n + 1), exec::make_buffer<std::int32_t>(ex, n)};
  for_each(ex, "splat.choose", n, FlagLevel{samples.splat_depths, depth, result.chosen.view()});
  exclusive_scan(ex, "splat.choose", result.chosen.cview(), result.rank.view());
  for_each(ex, "splat.choose", n, ListChosen{result.rank.cview(), result.chosen.view()});
  return result;
}

template <exec::Space Exec>
void splat_to_bricks(Exec& ex, const SplatSource& source, const VectorField& field) {
  for_each(ex, "splat.normals", source.level.bricks, SplatToBricks{source, field});
}

template <exec::Space Exec>
void find_divergence(Exec& ex, const Divergence& divergence) {
  for_each(ex, "splat.divergence", divergence.level.bricks, DivergenceOfBricks{divergence});
}

/// Adds the samples that are splatted at the level to V.
template <exec::Space Exec>
void splat_samples(Exec& ex, const octree::OctreeView& tree, const octree::LevelView& level, const SamplesView& samples,
                   const VectorField& field) {
  if ((samples.splat_depth_set >> level.depth & 1) == 0) return;
  ChosenSamples chosen;
  if (level.depth < tree.depth) chosen = choose_samples(ex, samples, level.depth);
  const float area_scale = 1.0F / static_cast<float>(std::int64_t{1} << 2 * (tree.depth - level.depth));
  const SplatSource source{level, samples, {chosen.rank.cview(), chosen.chosen.cview()}, area_scale};
  splat_to_bricks(ex, source, field);
}

/// V of one level.
struct FieldLevel {
  exec::Buffer<float> values;
  [[nodiscard]] VectorField view() const {
    const std::int64_t n = values.size() / 3;
    return {{values.view().part(0, n), values.view().part(n, n), values.view().part(2 * n, n)}};
  }
};

/// V of one level: what is splatted there and, since hats are nested, all that was splatted at coarser ones.
/// @param above  of the level above; empty at the coarsest level that has a field
template <exec::Space Exec>
FieldLevel splat_level(Exec& ex, const octree::OctreeView& tree, const SamplesView& samples, int depth,
                       const FieldLevel& above) {
  const octree::LevelView& level = tree.levels[depth];
  FieldLevel own{exec::make_buffer<float>(ex, 3 * level.nodes())};
  if (above.values.empty())
    exec::fill(ex, own.values.view(), 0.0F);
  else
    for_each(ex, "splat.prolong", level.nodes(), ProlongField{level, tree.levels[depth - 1], above.view(), own.view()});
  splat_samples(ex, tree, level, samples, own.view());
  return own;
}

/// The divergence of V alone, level by level from the coarsest that has a field: no more than two levels of V are there
/// at once, and of the finest one, beside the divergence, that one alone. Where there is no field nothing is set.
/// @returns shape (nodes of all levels)
template <exec::Space Exec>
exec::Buffer<float> divergence_of_field(Exec& ex, const octree::OctreeView& tree, const SamplesView& samples,
                                        const Resolution& resolution) {
  const int coarsest = samples.coarsest_splat_depth;
  const octree::LevelView& finest = tree.levels[tree.depth];
  const auto find = [&](int depth, const FieldLevel& field, const exec::Buffer<float>& b) {
    const octree::LevelView& level = tree.levels[depth];
    const octree::LevelView* below = depth < tree.depth ? &tree.levels[depth + 1] : nullptr;
    find_divergence(ex, {level, below != nullptr ? below->cell_bricks : 0, field.view(), make_coefficients(),
                         b.view().part(level.first_node, level.nodes()), resolution.counts(level),
                         below != nullptr ? resolution.counts(*below) : nullptr});
  };
  exec::Buffer<float> coarse;  // of all levels but the finest
  if (coarsest < tree.depth) coarse = exec::make_buffer<float>(ex, finest.first_node);
  FieldLevel field;
  for (int d = coarsest; d < tree.depth; ++d) {
    field = splat_level(ex, tree, samples, d, field);
    find(d, field, coarse);
  }
  field = splat_level(ex, tree, samples, tree.depth, field);
  auto b = exec::make_buffer<float>(ex, tree.nodes);
  if (!coarse.empty()) {
    const std::int64_t first = tree.levels[coarsest].first_node;
    const std::int64_t count = finest.first_node - first;
    exec::copy(ex, coarse.cview().part(first, count), b.view().part(first, count));
    coarse.reset();
  }
  find(tree.depth, field, b);
  return b;
}

}  // namespace divergence

template <exec::Space Exec>
exec::Buffer<float> splat_divergence(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples,
                                     const Resolution& resolution) {
  using namespace divergence;
  const octree::OctreeView view = tree.view();
  const int coarsest = samples.coarsest_splat_depth;
  exec::Buffer<float> b = divergence_of_field(ex, view, samples, resolution);
  const int complete = std::min({view.depth - 1, coarsest - 1, octree::kCompleteDepth});
  for (int d = view.depth - 1; d > complete; --d) {
    const octree::LevelView& level = view.levels[d];
    const octree::LevelView& below = view.levels[d + 1];
    for_each(ex, "splat.restrict", level.nodes(),
             AddRestriction{level, below, b.data() + below.first_node, d >= coarsest,
                            b.view().part(level.first_node, level.nodes())});
  }
  if (complete >= 0)
    sweep(ex, "splat.restrict", complete + 1, view.levels[complete].nodes(),
          RestrictLevels{{}, view, complete, b.data()});
  return b;
}

}  // namespace pointskin::poisson
