#include "deform/spacing.hpp"

#include <algorithm>
#include <cmath>

#include "exec/this_space.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "octree/search.hpp"

namespace pointskin::deform {
namespace {

constexpr int kNeighbours = 6;

/// Means the distances of the nearest points but the first, which is the point itself.
struct MeanDistance {
  ArrayView<const std::int32_t> ids;  ///< (n, kNeighbours + 1)
  ArrayView<const float> squared;
  float size_world;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const {
    float sum = 0;
    int found = 0;
    for (std::int64_t k = 1; k <= kNeighbours; ++k) {
      const std::int64_t at = i * (kNeighbours + 1) + k;
      if (ids[at] < 0) continue;
      sum += std::sqrt(squared[at]);
      ++found;
    }
    out[i] = found > 0 ? sum / static_cast<float>(found) * size_world : 0.0F;
  }
};

struct ByIndex {
  ArrayView<std::uint64_t> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = static_cast<std::uint64_t>(i); }
};

/// Smallest depth at which a surface's cells hold about as many points as a search looks at in one go.
int search_depth(std::int64_t points) {
  constexpr int kDeepest = 12;
  int depth = 1;
  while (depth < kDeepest && (std::int64_t{8} << 2 * depth) < points) ++depth;
  return depth;
}

}  // namespace

template <exec::Space Exec>
std::vector<float> neighbour_distances(Exec& ex, ArrayView<const Vec3f> positions) {
  const std::int64_t n = positions.size;
  const octree::Frame frame = octree::fit_frame(ex, positions, 1);
  auto unit = exec::make_buffer<Vec3f>(ex, n);
  for_each(ex, "deform.spacing", n, octree::ToUnit{frame, positions, unit.view()});
  auto ties = exec::make_buffer<std::uint64_t>(ex, n);
  for_each(ex, "deform.spacing", n, ByIndex{ties.view()});
  const octree::SortedPoints sorted = octree::sort_points(ex, unit.cview(), ties.cview());
  const octree::OctreeData tree = octree::build_octree(ex, sorted.keys.cview(), search_depth(n));
  auto by_key = exec::make_buffer<Vec3f>(ex, n);
  exec::gather(ex, unit.cview(), sorted.order.cview(), by_key.view());

  const octree::SearchView points{tree.view(), by_key.cview(), sorted.order.cview()};
  constexpr std::int64_t kAtOnce = std::int64_t{1} << 20;
  std::vector<float> means(static_cast<std::size_t>(n));
  for (std::int64_t first = 0; first < n; first += kAtOnce) {  // in key order: neighbours look at the same cells
    const std::int64_t count = std::min(kAtOnce, n - first);
    auto ids = exec::make_buffer<std::int32_t>(ex, count * (kNeighbours + 1));
    auto squared = exec::make_buffer<float>(ex, count * (kNeighbours + 1));
    octree::find_nearest(ex, points, by_key.cview().part(first, count), kNeighbours + 1, ids.view(), squared.view());
    auto mean = exec::make_buffer<float>(ex, count);
    for_each(ex, "deform.spacing", count,
             MeanDistance{ids.cview(), squared.cview(), static_cast<float>(frame.size), mean.view()});
    copy_to_host(ex, mean.cview(), means.data() + first);
  }
  std::vector<std::int32_t> order(means.size());
  copy_to_host(ex, sorted.order.cview(), order.data());
  std::vector<float> out(means.size());
  for (std::size_t i = 0; i < order.size(); ++i) out[static_cast<std::size_t>(order[i])] = means[i];
  return out;
}

PSK_INSTANTIATE(neighbour_distances);

}  // namespace pointskin::deform
