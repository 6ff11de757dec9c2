#include "poisson/divergence.hpp"

#include <algorithm>
#include <type_traits>
#include <vector>

#include "exec/this_space.hpp"
#include "octree/access.hpp"
#include "octree/neighbourhood.hpp"
#include "octree/placed.hpp"
#include "poisson/divergence_of_bricks.hpp"
#include "poisson/in_blocks.hpp"
#include "poisson/splat_kernel.hpp"
#include "poisson/splat_to_bricks.hpp"
#include "poisson/stencil.hpp"

namespace pointskin::poisson {
namespace {

/// V of the level above, on this level's finer hats. In units of 1 / h it halves.
struct ProlongField {
  octree::LevelView level, above;
  VectorField above_field, field;
  PSK_HD void operator()(std::int64_t n) const {
    const std::int32_t parent = level.parent[n >> 3];
    const int slot = static_cast<int>(n & 7);
    std::int32_t corner[8];
    PSK_UNROLL
    for (int s = 0; s < 8; ++s)
      corner[s] =
          (s & ~slot) != 0 ? -1 : above.neighbour(parent, octree::slot_x(s), octree::slot_y(s), octree::slot_z(s));
    const float share = 0.5F / static_cast<float>(1 << count_bits(static_cast<std::uint64_t>(slot)));
    PSK_UNROLL
    for (int a = 0; a < 3; ++a) {
      float value[8];
      PSK_UNROLL
      for (int s = 0; s < 8; ++s) value[s] = corner[s] < 0 ? 0.0F : above_field.axis[a][corner[s]];
      float sum = 0;
      PSK_UNROLL
      for (int s = 0; s < 8; ++s) sum += value[s];
      field.axis[a][n] = sum * share;
    }
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

/// The complete levels above all samples' splat depths, one a round.
struct RestrictLevels : exec::SweepAll {
  octree::OctreeView tree;
  int first;  // depth of round 0
  float* b;

  [[nodiscard]] PSK_HD int indices(int round) const { return static_cast<int>(tree.levels[first - round].nodes()); }
  PSK_HD void operator()(int round, int n, Nothing) const {
    const octree::LevelView& level = tree.levels[first - round];
    const octree::LevelView& below = tree.levels[first - round + 1];
    b[level.first_node + n] = 0.5F * octree::restricted(level, below, b + below.first_node, n);
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
requires(!Exec::kOwnKernels) void splat_to_bricks(Exec& ex, const SplatSource& source, const VectorField& field) {
  for_each(ex, "splat.normals", source.level.bricks, SplatToBricks{source, field});
}

template <exec::Space Exec>
requires(!Exec::kOwnKernels) void find_divergence(Exec& ex, const Divergence& divergence) {
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

/// Memory for V of one level, axis after axis; 0 everywhere if asked for.
template <exec::Space Exec>
exec::Buffer<float> make_field(Exec& ex, const octree::LevelView& level, bool is_zero) {
  std::vector<std::int64_t> borders;
  for (std::int64_t axis = 0; axis < 3; ++axis) octree::append_borders(borders, axis * level.bricks, level);
  const exec::Placed placed(ex, borders, 3 * std::int64_t{level.bricks});
  auto values = exec::make_buffer<float>(ex, 3 * level.nodes());
  if (is_zero) exec::fill(ex, values.view(), 0.0F);
  return values;
}

/// V of one level: what is splatted there and, since hats are nested, all that was splatted at coarser ones.
/// @param above  of the level above; empty at the coarsest level that has a field
template <exec::Space Exec>
FieldLevel splat_level(Exec& ex, const octree::OctreeView& tree, const SamplesView& samples, int depth,
                       const FieldLevel& above) {
  const octree::LevelView& level = tree.levels[depth];
  FieldLevel own{make_field(ex, level, above.values.empty())};
  const auto placed = octree::placed_on_level(ex, level);
  if (!above.values.empty())
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
    const auto placed = octree::placed_on_level(ex, level);
    find_divergence(ex, Divergence{level, below != nullptr ? below->cell_bricks : 0, field.view(), make_coefficients(),
                                   b.view().part(level.first_node, level.nodes()), resolution.counts(level),
                                   below != nullptr ? resolution.counts(*below) : nullptr});
  };
  exec::Buffer<float> coarse;  // of all levels but the finest
  if (coarsest < tree.depth) {
    const auto placed = octree::placed_on_levels(ex, tree, tree.depth - 1);
    coarse = exec::make_buffer<float>(ex, finest.first_node);
  }
  FieldLevel field;
  for (int d = coarsest; d < tree.depth; ++d) {
    field = splat_level(ex, tree, samples, d, field);
    find(d, field, coarse);
  }
  field = splat_level(ex, tree, samples, tree.depth, field);
  exec::Buffer<float> b;
  {
    const auto placed = octree::placed_on_levels(ex, tree, tree.depth);
    b = exec::make_buffer<float>(ex, tree.nodes);
  }
  if (!coarse.empty()) {
    const std::int64_t first = tree.levels[coarsest].first_node;
    const std::int64_t count = finest.first_node - first;
    exec::copy(ex, coarse.cview().part(first, count), b.view().part(first, count));
    coarse.reset();
  }
  find(tree.depth, field, b);
  return b;
}

}  // namespace

template <exec::Space Exec>
exec::Buffer<float> splat_divergence(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples,
                                     const Resolution& resolution) {
  const octree::OctreeView view = tree.view();
  const int coarsest = samples.coarsest_splat_depth;
  exec::Buffer<float> b = divergence_of_field(ex, view, samples, resolution);
  const int complete = std::min({view.depth - 1, coarsest - 1, octree::kCompleteDepth});
  for (int d = view.depth - 1; d > complete; --d) {
    const octree::LevelView& level = view.levels[d];
    const octree::LevelView& below = view.levels[d + 1];
    const auto placed = octree::placed_on_level(ex, level);
    for_each(ex, "splat.restrict", level.nodes(),
             AddRestriction{level, below, b.data() + below.first_node, d >= coarsest,
                            b.view().part(level.first_node, level.nodes())});
  }
  if (complete >= 0)
    sweep(ex, "splat.restrict", complete + 1, view.levels[complete].nodes(),
          RestrictLevels{{}, view, complete, b.data()});
  return b;
}

template <exec::Space Exec>
exec::Buffer<float> splat_coarse_levels(Exec& ex, const octree::OctreeView& tree, int depth,
                                        const SamplesView& samples) {
  octree::OctreeView whole = tree;  // areas are in cells of the whole octree
  whole.depth = depth;
  FieldLevel field;
  for (int d = samples.coarsest_splat_depth; d <= tree.depth; ++d) field = splat_level(ex, whole, samples, d, field);
  return std::move(field.values);
}

template <exec::Space Exec>
void find_coarse_divergence(Exec& ex, const octree::OctreeView& tree, int depth, const SamplesView& samples,
                            const Resolution& resolution, ArrayView<float> b) {
  octree::OctreeView whole = tree;
  whole.depth = depth;
  const auto own = [&](int d) { return b.part(tree.levels[d].first_node, tree.levels[d].nodes()); };
  FieldLevel field;
  for (int d = samples.coarsest_splat_depth; d < tree.depth; ++d) {
    field = splat_level(ex, whole, samples, d, field);
    const octree::LevelView& below = tree.levels[d + 1];
    find_divergence(ex, Divergence{tree.levels[d], below.cell_bricks, field.view(), make_coefficients(), own(d),
                                   resolution.counts(tree.levels[d]), resolution.counts(below)});
  }
  for (int d = tree.depth - 1; d >= 0; --d) {
    const octree::LevelView& below = tree.levels[d + 1];
    for_each(
        ex, "splat.restrict", tree.levels[d].nodes(),
        AddRestriction{tree.levels[d], below, b.data + below.first_node, d >= samples.coarsest_splat_depth, own(d)});
  }
}

template <exec::Space Exec>
exec::Buffer<float> splat_divergence_below(Exec& ex, const octree::OctreeData& tree, const SamplesView& samples,
                                           const Resolution& resolution, int level, ArrayView<const float> given) {
  const octree::OctreeView view = tree.view();
  auto b = exec::make_buffer<float>(ex, view.nodes);
  const auto own = [&](int d) { return b.view().part(view.levels[d].first_node, view.levels[d].nodes()); };
  FieldLevel field{exec::make_buffer<float>(ex, given.size)};
  copy(ex, given, field.values.view());
  for (int d = std::max(level, samples.coarsest_splat_depth); d <= view.depth; ++d) {
    if (d > level) field = splat_level(ex, view, samples, d, field);
    const octree::LevelView* below = d < view.depth ? &view.levels[d + 1] : nullptr;
    find_divergence(ex, Divergence{view.levels[d], below != nullptr ? below->cell_bricks : 0, field.view(),
                                   make_coefficients(), own(d), resolution.counts(view.levels[d]),
                                   below != nullptr ? resolution.counts(*below) : nullptr});
  }
  for (int d = view.depth - 1; d >= level; --d) {
    const octree::LevelView& below = view.levels[d + 1];
    for_each(
        ex, "splat.restrict", view.levels[d].nodes(),
        AddRestriction{view.levels[d], below, b.data() + below.first_node, d >= samples.coarsest_splat_depth, own(d)});
  }
  return b;
}

PSK_INSTANTIATE(splat_divergence);
PSK_INSTANTIATE(splat_coarse_levels);
PSK_INSTANTIATE(find_coarse_divergence);
PSK_INSTANTIATE(splat_divergence_below);

}  // namespace pointskin::poisson
