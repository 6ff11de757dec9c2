#include "poisson/spacing.hpp"

#include <bit>
#include <cstring>

#include "exec/this_space.hpp"

namespace pointskin::poisson {
namespace {

struct Evaluate {
  octree::OctreeView tree;
  SpacingView spacing;
  ArrayView<const Vec3f> points, normals;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = spacing.cells(tree, points[i], normals[i]); }
};

/// The bits of floats that are not negative ascend with them.
struct EvaluateBits {
  octree::OctreeView tree;
  SpacingView spacing;
  ArrayView<const Vec3f> points, normals;
  ArrayView<std::uint64_t> out;
  PSK_HD void operator()(std::int64_t i) const {
    const float value = spacing.cells(tree, points[i], normals[i]);
    std::uint32_t bits;
    memcpy(&bits, &value, sizeof bits);
    out[i] = bits;
  }
};

}  // namespace

template <exec::Space Exec>
void evaluate_spacing(Exec& ex, const octree::OctreeData& tree, const Density& density, ArrayView<const Vec3f> points,
                      ArrayView<const Vec3f> normals, ArrayView<float> out) {
  for_each(ex, "trim.spacing", points.size,
           Evaluate{tree.view(), {density.depth, density.counts.data()}, points, normals, out});
}

template <exec::Space Exec>
float spacing_of_sparsest(Exec& ex, const octree::OctreeData& tree, const Density& density,
                          ArrayView<const Vec3f> positions, ArrayView<const Vec3f> normals, double sparsest) {
  const std::int64_t n = positions.size;
  auto keys = exec::make_buffer<std::uint64_t>(ex, n);
  for_each(ex, "trim.limit", n,
           EvaluateBits{tree.view(), {density.depth, density.counts.data()}, positions, normals, keys.view()});
  sort_keys(ex, "trim.limit", keys, 32);
  const std::int64_t place = place_of_sparsest(n, sparsest);
  return std::bit_cast<float>(static_cast<std::uint32_t>(exec::read_element(ex, keys.cview(), place)));
}

PSK_INSTANTIATE(evaluate_spacing);
PSK_INSTANTIATE(spacing_of_sparsest);

}  // namespace pointskin::poisson
