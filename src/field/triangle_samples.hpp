// Samples on the triangles of a surface, in an octree, and the distance to the triangle of the nearest one.
#pragma once

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "core/vec3.hpp"
#include "exec/algorithms.hpp"
#include "field/offset.hpp"
#include "octree/octree_data.hpp"
#include "octree/walk.hpp"

namespace pointskin::field::offset {

PSK_HD inline Vec3d between(const Vec3f& from, const Vec3f& to) { return to_double(to) - to_double(from); }

/// Squared distance from a + p to the segment from a to a + edge.
PSK_HD inline double squared_to_edge(const Vec3d& p, const Vec3d& edge) {
  const double along = dot(p, edge);
  const double squared = dot(edge, edge);
  const double t = !(along > 0) ? 0.0 : along >= squared ? 1.0 : along / squared;
  const Vec3d off = p - t * edge;
  return squared_length(off);
}

/// Squared distance from q to a triangle, which may have no area. In double: the triangles are small.
PSK_HD inline double squared_to_triangle(const Vec3f& q, const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3d ab = between(a, b);
  const Vec3d ac = between(a, c);
  const Vec3d bc = ac - ab;
  const Vec3d ap = between(a, q);
  const Vec3d bp = ap - ab;
  const Vec3d n = cross(ab, ac);
  const double area = dot(n, n);
  const bool above = area > 0 && dot(cross(ab, ap), n) > 0 && dot(cross(bc, bp), n) > 0 && dot(cross(ap, ac), n) > 0;
  if (above) {
    const double height = dot(ap, n);
    return height * height / area;
  }
  const double at_ab = squared_to_edge(ap, ab);
  const double at_ac = squared_to_edge(ap, ac);
  const double at_bc = squared_to_edge(bp, bc);
  const double least = at_ab < at_ac ? at_ab : at_ac;
  return least < at_bc ? least : at_bc;
}

/// Corners of triangle t.
struct Corners {
  ArrayView<const Vec3f> vertices;
  ArrayView<const Triangle> triangles;
  [[nodiscard]] PSK_HD const Vec3f& operator()(std::int64_t t, int k) const { return vertices[triangles[t].data()[k]]; }
};

/// Pieces along an edge of each triangle, squared: its pieces.
struct CountPieces {
  static constexpr std::int32_t kMost = 46340;  // whose square fits into 32 bits

  Corners corners;
  float pieces_per_unit;
  ArrayView<std::int32_t> counts;
  PSK_HD void operator()(std::int64_t t) const {
    const std::int32_t along = pieces_along(t);
    counts[t] = along * along;
  }
  [[nodiscard]] PSK_HD std::int32_t pieces_along(std::int64_t t) const {
    float longest = 0;
    for (int k = 0; k < 3; ++k) {
      const float squared = octree::squared_distance(corners(t, k), corners(t, k == 2 ? 0 : k + 1));
      if (squared > longest) longest = squared;
    }
    const float wanted = std::sqrt(longest) * pieces_per_unit;
    if (!(wanted < static_cast<float>(kMost))) return kMost;
    const auto whole = static_cast<std::int32_t>(wanted);
    return static_cast<float>(whole) < wanted || whole == 0 ? whole + 1 : whole;
  }
};

/// Triangle that item i belongs to, by where the items of each begin.
PSK_HD inline std::int32_t owner_of(ArrayView<const std::int32_t> first, std::int64_t i) {
  std::int64_t low = 0;
  std::int64_t high = first.size - 2;
  while (low < high) {
    const std::int64_t middle = (low + high + 1) / 2;
    if (first[middle] <= i)
      low = middle;
    else
      high = middle - 1;
  }
  return static_cast<std::int32_t>(low);
}

/// The largest whole r with r r <= n.
PSK_HD inline std::int32_t whole_root(std::int32_t n) {
  auto r = static_cast<std::int32_t>(std::sqrt(static_cast<double>(n)));
  while (std::int64_t{r} * r > n) --r;
  while (std::int64_t{r + 1} * (r + 1) <= n) ++r;
  return r;
}

/// Centres of the pieces: n^2 equal triangles, row r from the first corner holds 2 r + 1 of them.
struct LaySample {
  Corners corners;
  ArrayView<const std::int32_t> first;
  ArrayView<Vec3f> positions;
  ArrayView<std::int32_t> owners;
  ArrayView<std::uint64_t> ties;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t t = owner_of(first, i);
    const auto piece = static_cast<std::int32_t>(i - first[t]);
    const auto along = static_cast<float>(whole_root(first[t + 1] - first[t]));
    const std::int32_t row = whole_root(piece);
    const std::int32_t place = piece - row * row;
    const bool upright = (place & 1) == 0;
    const float u = (static_cast<float>(row) + (upright ? 2.0F : 1.0F) / 3) / along;         // towards the far edge
    const float v = (static_cast<float>(place >> 1) + (upright ? 1.0F : 2.0F) / 3) / along;  // along it
    const Vec3f a = corners(t, 0);
    const Vec3f b = corners(t, 1);
    const Vec3f c = corners(t, 2);
    positions[i] = {a.x + u * (b.x - a.x) + v * (c.x - b.x), a.y + u * (b.y - a.y) + v * (c.y - b.y),
                    a.z + u * (b.z - a.z) + v * (c.z - b.z)};
    owners[i] = t;
    ties[i] = static_cast<std::uint64_t>(i);
  }
};

/// Samples in the order of their octree.
struct TriangleSamples {
  octree::OctreeData tree;
  exec::Buffer<Vec3f> positions;
  exec::Buffer<std::int32_t> owners;  ///< triangle of each
};

/// Squared distance to a surface, as kernels ask for it.
struct SurfaceDistance {
  octree::OctreeView tree;
  ArrayView<const Vec3f> positions;
  ArrayView<const std::int32_t> owners;
  Corners corners;
  bool is_coarse = false;  ///< samples are far apart: some of them are tried

  [[nodiscard]] PSK_HD double squared(const Vec3f& q) const { return is_coarse ? least_of_some(q) : of_nearest(q); }

  /// To the triangles of the kTried nearest samples.
  [[nodiscard]] PSK_HD double least_of_some(const Vec3f& q) const {
    constexpr int kTried = 4;
    float least[kTried];
    std::int32_t nearest[kTried];
    int count = 0;
    const auto prune = [&](float d) { return count == kTried && d > least[kTried - 1]; };
    octree::walk({tree, positions, {}}, q, prune, [&](std::int32_t begin, std::int32_t end) {
      for (std::int32_t i = begin; i < end; ++i) {
        const float d = octree::squared_distance(q, positions[i]);
        if (count == kTried && d > least[kTried - 1]) continue;
        const auto before = [&](int k) { return d < least[k] || (d == least[k] && i < nearest[k]); };
        if (count == kTried && !before(kTried - 1)) continue;
        int place = count == kTried ? kTried - 1 : count++;
        for (; place > 0 && before(place - 1); --place) {
          least[place] = least[place - 1];
          nearest[place] = nearest[place - 1];
        }
        least[place] = d;
        nearest[place] = i;
      }
    });
    double squared = 0;
    for (int k = 0; k < count; ++k) {
      const double d = to_triangle_of(nearest[k], q);
      if (k == 0 || d < squared) squared = d;
    }
    return squared;
  }

  [[nodiscard]] PSK_HD double of_nearest(const Vec3f& q) const {
    float least = 0;
    std::int32_t nearest = -1;
    const auto prune = [&](float d) { return nearest >= 0 && d > least; };
    octree::walk({tree, positions, {}}, q, prune, [&](std::int32_t begin, std::int32_t end) {
      for (std::int32_t i = begin; i < end; ++i) {
        const float d = octree::squared_distance(q, positions[i]);
        if (nearest >= 0 && (d > least || (d == least && i > nearest))) continue;
        least = d;
        nearest = i;
      }
    });
    return to_triangle_of(nearest, q);
  }

  [[nodiscard]] PSK_HD double to_triangle_of(std::int32_t sample, const Vec3f& q) const {
    const std::int32_t t = owners[sample];
    return squared_to_triangle(q, corners(t, 0), corners(t, 1), corners(t, 2));
  }
};

/// @param wider  how many times larger than kPieceCells pieces may be, >= 1
/// @throws Error over_limit if there are 2^31 samples or more
template <exec::Space Exec>
TriangleSamples lay_samples(Exec& ex, const Corners& corners, int depth, double wider) {
  const std::int64_t triangles = corners.triangles.size;
  auto counts = exec::make_buffer<std::int32_t>(ex, triangles);
  for_each(
      ex, "offset.pieces", triangles,
      CountPieces{corners, static_cast<float>(1 << depth) / (kPieceCells * static_cast<float>(wider)), counts.view()});
  const std::int64_t samples = exec::sum_counts(ex, "offset.pieces", counts.cview());
  if (samples > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "the surface is too large to be offset at this depth; choose a smaller depth");
  auto first = exec::make_buffer<std::int32_t>(ex, triangles + 1);
  exclusive_scan(ex, "offset.pieces", counts.cview(), first.view());
  counts.reset();
  auto positions = exec::make_buffer<Vec3f>(ex, samples);
  auto owners = exec::make_buffer<std::int32_t>(ex, samples);
  auto ties = exec::make_buffer<std::uint64_t>(ex, samples);
  for_each(ex, "offset.samples", samples,
           LaySample{corners, first.cview(), positions.view(), owners.view(), ties.view()});
  first.reset();
  const octree::SortedPoints sorted = octree::sort_points(ex, positions.cview(), ties.cview());
  ties.reset();
  TriangleSamples result;
  result.positions = exec::make_buffer<Vec3f>(ex, samples);
  result.owners = exec::make_buffer<std::int32_t>(ex, samples);
  exec::gather<Vec3f>(ex, positions.cview(), sorted.order.cview(), result.positions.view());
  exec::gather<std::int32_t>(ex, owners.cview(), sorted.order.cview(), result.owners.view());
  result.tree = octree::build_octree(
      ex, sorted.keys.cview(),
      std::max(1, depth - 1 - static_cast<int>(std::log2(wider))));  // about 30 samples a finest cell
  return result;
}

}  // namespace pointskin::field::offset
