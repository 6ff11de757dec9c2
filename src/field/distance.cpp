#include "field/distance.hpp"

#include <cmath>
#include <cstdint>

#include "exec/algorithms.hpp"
#include "exec/this_space.hpp"
#include "field/corner_values.hpp"
#include "octree/walk.hpp"

namespace pointskin::field {
namespace {

struct Normalise {
  ArrayView<Vec3f> normals;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f n = normals[i];
    const double x = n.x;
    const double y = n.y;
    const double z = n.z;
    const double length = std::sqrt(x * x + y * y + z * z);
    normals[i] = length > 0 ? Vec3f{static_cast<float>(x / length), static_cast<float>(y / length),
                                    static_cast<float>(z / length)}
                            : Vec3f{};
  }
};

struct DropPlane {
  ArrayView<const float> areas;
  ArrayView<Vec3f> normals;
  PSK_HD void operator()(std::int64_t i) const {
    if (areas[i] == 0) normals[i] = {};
  }
};

/// Whether a sample has a plane.
struct FlagPlane {
  ArrayView<const Vec3f> normals;
  ArrayView<std::int32_t> flags;
  PSK_HD void operator()(std::int64_t i) const { flags[i] = normals[i] == Vec3f{} ? 0 : 1; }
};

struct ListPlane {
  ArrayView<const std::int32_t> before;
  ArrayView<std::int32_t> samples;
  PSK_HD void operator()(std::int64_t i) const {
    if (before[i] < before[i + 1]) samples[before[i]] = static_cast<std::int32_t>(i);
  }
};

/// The samples that have a plane, in their order. A corner far from the surface and amid outliers would else look at all of
/// those nearer than the surface, one by one, and at none that counts.
struct WithPlanes {
  ArrayView<const std::int32_t> samples;  ///< empty, as the other: nearly all have one, and all are listed
  ArrayView<const std::int32_t> before;   ///< (all samples + 1) how many of them come before each sample

  [[nodiscard]] PSK_HD std::int32_t first_of(std::int32_t sample) const {
    return before.empty() ? sample : before[sample];
  }
  [[nodiscard]] PSK_HD std::int32_t sample(std::int32_t i) const { return samples.empty() ? i : samples[i]; }
};

struct PlaneList {
  exec::Buffer<std::int32_t> samples, before;
  [[nodiscard]] WithPlanes view() const { return {samples.cview(), before.cview()}; }
};

/// An empty list where it would spare less than it costs. Waits.
template <exec::Space Exec>
PlaneList list_planes(Exec& ex, ArrayView<const Vec3f> normals) {
  constexpr const char* kLabel = "distance.list";
  constexpr std::int64_t kFew = 50;  // one in so many without a plane
  const std::int64_t n = normals.size;
  PlaneList list{exec::make_buffer<std::int32_t>(ex, n), exec::make_buffer<std::int32_t>(ex, n + 1)};
  for_each(ex, kLabel, n, FlagPlane{normals, list.samples.view()});
  exclusive_scan(ex, kLabel, list.samples.cview(), list.before.view());
  const std::int64_t count = exec::read_element(ex, list.before.cview(), n);
  if ((n - count) * kFew <= n) return {};
  for_each(ex, kLabel, n, ListPlane{list.before.cview(), list.samples.view()});
  return list;
}

/// The samples found so far, nearest first.
struct Nearest {
  int count = 0;
  std::int32_t sample[kNearestSamples];
  float squared[kNearestSamples];

  [[nodiscard]] PSK_HD bool is_full() const { return count == kNearestSamples; }
  [[nodiscard]] PSK_HD float farthest() const { return squared[kNearestSamples - 1]; }

  PSK_HD void add(std::int32_t new_sample, float d) {
    const auto before = [&](int i) { return d < squared[i] || (d == squared[i] && new_sample < sample[i]); };
    if (is_full() && !before(kNearestSamples - 1)) return;
    int place = is_full() ? kNearestSamples - 1 : count++;
    for (; place > 0 && before(place - 1); --place) {
      sample[place] = sample[place - 1];
      squared[place] = squared[place - 1];
    }
    sample[place] = new_sample;
    squared[place] = d;
  }
};

/// The value at a corner.
struct DistanceAtCorner {
  /// Levels above the finest whose corners first look around themselves: cells of coarser ones hold too many samples.
  static constexpr int kLevelsAround = 2;
  static constexpr float kLeast = 1e-6F;  ///< a value of 0 is inside

  TangentPlanes planes;
  WithPlanes with_planes;
  Sides sides;

  PSK_HD float operator()(const octree::OctreeView& tree, int depth, std::int32_t node) const {
    const octree::LevelView& level = tree.levels[depth];
    const Vec3f x = corners::place_of(level, node);
    Nearest nearest;
    const bool is_near = depth + kLevelsAround >= tree.depth && find_around(level, node, x, nearest);
    if (!is_near) find_anywhere(tree, x, nearest);
    const float inwards = -mean_distance(x, nearest) * static_cast<float>(std::int64_t{1} << tree.depth);
    return sides.values == nullptr ? inwards : on_its_side(inwards, sides.values[level.first_node + node]);
  }

  [[nodiscard]] PSK_HD float on_its_side(float inwards, float value) const {
    const float off = value - sides.isovalue;
    if (off > kSureSide) return inwards < 0 ? -inwards : inwards;
    if (off < -kSureSide) return inwards >= 0 ? -inwards - kLeast : inwards;
    return inwards;
  }

  /// @param first  among those that are listed, as `last`
  PSK_HD void scan(const Vec3f& x, std::int32_t first, std::int32_t last, Nearest& nearest) const {
    for (std::int32_t i = first; i < last; ++i) {
      const std::int32_t sample = with_planes.sample(i);
      if (with_planes.samples.empty() && planes.normals[sample] == Vec3f{}) continue;
      nearest.add(sample, octree::squared_distance(x, planes.positions[sample]));
    }
  }

  /// The cells of the level around the corner: 8, then 64. @returns true if nearer samples cannot be elsewhere
  PSK_HD bool find_around(const octree::LevelView& level, std::int32_t node, const Vec3f& x, Nearest& nearest) const {
    const float width = (1 - 1e-5F) / static_cast<float>(1 << level.depth);
    for (int ring = 1; ring <= 2; ++ring) {
      for (int dx = -ring; dx < ring; ++dx)
        for (int dy = -ring; dy < ring; ++dy)
          for (int dz = -ring; dz < ring; ++dz) {
            const bool is_inner = dx >= -1 && dx < 1 && dy >= -1 && dy < 1 && dz >= -1 && dz < 1;
            if (ring == 2 && is_inner) continue;
            const std::int32_t cell = level.neighbour(node, dx, dy, dz);
            if (level.is_cell(cell))
              scan(x, with_planes.first_of(level.point_begin[cell]), with_planes.first_of(level.point_begin[cell + 1]),
                   nearest);
          }
      const float reach = static_cast<float>(ring) * width;
      if (nearest.is_full() && nearest.farthest() <= reach * reach) return true;
    }
    return false;
  }

  /// From the root, nothing farther than what is found.
  PSK_HD void find_anywhere(const octree::OctreeView& tree, const Vec3f& x, Nearest& nearest) const {
    const bool bounded = nearest.is_full();
    const float bound = bounded ? nearest.farthest() : 0;
    nearest.count = 0;
    const auto prune = [&](float d) { return (bounded && d > bound) || (nearest.is_full() && d > nearest.farthest()); };
    octree::walk({tree, planes.positions, {}, with_planes.before}, x, prune,
                 [&](std::int32_t first, std::int32_t last) { scan(x, first, last, nearest); });
  }

  /// Signed, positive outside, in the unit cube.
  [[nodiscard]] PSK_HD float mean_distance(const Vec3f& x, const Nearest& nearest) const {
    float sum = 0;
    float weight = 0;
    const float reach = nearest.is_full() ? nearest.farthest() : 0;
    for (int pass = 0; pass < 2 && !(weight > 0); ++pass) {
      sum = 0;
      for (int i = 0; i < nearest.count; ++i) {
        const std::int32_t s = nearest.sample[i];
        const float share = pass == 0 ? (reach > 0 ? 1 - nearest.squared[i] / reach : 0.0F) : 1.0F;
        const float a = share * share * (planes.weights.empty() ? 1.0F : planes.weights[s]);
        const Vec3f p = planes.positions[s];
        const Vec3f n = planes.normals[s];
        sum += a * ((x.x - p.x) * n.x + (x.y - p.y) * n.y + (x.z - p.z) * n.z);
        weight += a;
      }
    }
    return weight > 0 ? sum / weight : 0.0F;
  }
};

}  // namespace

template <exec::Space Exec>
void normalise(Exec& ex, ArrayView<Vec3f> normals) {
  for_each(ex, "distance.normals", normals.size, Normalise{normals});
}

template <exec::Space Exec>
void drop_planes_of_outliers(Exec& ex, ArrayView<const float> areas, ArrayView<Vec3f> normals) {
  for_each(ex, "distance.normals", normals.size, DropPlane{areas, normals});
}

template <exec::Space Exec>
exec::Buffer<float> distance_to_planes(Exec& ex, const octree::OctreeData& tree, const TangentPlanes& planes,
                                       const Sides& sides) {
  const octree::OctreeView view = tree.view();
  const PlaneList list = list_planes(ex, planes.normals);
  return fill_corners(ex, "distance.planes", view, DistanceAtCorner{planes, list.view(), sides});
}

PSK_INSTANTIATE(normalise);
PSK_INSTANTIATE(drop_planes_of_outliers);
PSK_INSTANTIATE(distance_to_planes);

}  // namespace pointskin::field
