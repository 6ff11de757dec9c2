// A tree of bounds over the triangles of a surface, and the nearest one, on every device.
// Source: Kamel & Faloutsos, "Hilbert R-tree: an improved R-tree using fractals", VLDB 1994 (rectangles in the order of a
// Hilbert curve). Differs: the tree is implicit, two neighbours of a level have one node above them, so that it needs no
// links; and nodes of few triangles have discs in place of boxes (docs/decisions/0051-exact-offsets.md).
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "core/array_view.hpp"
#include "core/hilbert.hpp"
#include "core/vec3.hpp"
#include "exec/algorithms.hpp"
#include "field/bounding_disc.hpp"
#include "octree/bounding_box.hpp"

namespace pointskin::field::offset {

/// Triangles of one node of the lowest level; two nodes a node above.
inline constexpr std::int32_t kTrianglesOfALeaf = 4;
/// Nodes of so many levels, the lowest ones, have discs; those above have boxes, as their triangles seldom lie in a plane.
inline constexpr int kDiscLevels = 8;
/// Levels over fewer than 2^31 triangles.
inline constexpr int kMostLevels = 30;

/// A triangle of the tree and how far it is.
struct NearTriangle {
  double squared = 0;
  std::int32_t place = 0;  ///< in the order of the leaves
};

/// Where the nodes of the levels are. Node i of a level holds nodes 2 i and 2 i + 1 of the level below, the last one maybe
/// the first of these alone. Those of level l begin at first[l] among the discs, or among the boxes.
struct TreeLevels {
  std::int32_t first[kMostLevels]{};
  std::int32_t nodes[kMostLevels]{};
  int count = 0;

  /// @param triangles  at least one
  static TreeLevels over(std::int64_t triangles) {
    TreeLevels result;
    std::int32_t all = 0;
    auto nodes = static_cast<std::int32_t>((triangles + kTrianglesOfALeaf - 1) / kTrianglesOfALeaf);
    for (;; nodes = nodes / 2 + nodes % 2) {
      if (result.count == kDiscLevels) all = 0;
      result.first[result.count] = all;
      result.nodes[result.count++] = nodes;
      all += nodes;
      if (nodes == 1) return result;
    }
  }
  [[nodiscard]] std::int64_t discs() const { return end_of(std::min(count, kDiscLevels)); }
  [[nodiscard]] std::int64_t boxes() const { return count > kDiscLevels ? end_of(count) : 0; }
  [[nodiscard]] std::int64_t end_of(int level) const { return std::int64_t{first[level - 1]} + nodes[level - 1]; }
};

/// The tree, as kernels ask it.
struct TriangleBoxesView {
  ArrayView<const PlacedTriangle> triangles;  ///< in the order of the leaves
  ArrayView<const BoundingDisc> discs;
  ArrayView<const Bounds> boxes;
  TreeLevels levels;

  /// The triangle nearest to q, up to rounding of float: one that is nearer by less than 1e-6 of the distance may be
  /// passed over. Seen from afar all of a small surface is equally far.
  /// @param start  place of any triangle; the nearer it is to q, the fewer others are looked at
  /// About O(log n); more where many triangles are about equally far.
  [[nodiscard]] PSK_HD NearTriangle nearest(const Vec3f& q, std::int32_t start = 0) const {
    NearTriangle result{triangles[start].squared_distance(q), start};
    const auto is_farther = [&](float squared) { return squared * (1 + 1e-6F) >= static_cast<float>(result.squared); };
    visit_near(q, is_farther, [&](double squared, std::int64_t i) {
      if (squared < result.squared) result = {squared, static_cast<std::int32_t>(i)};
      return true;
    });
    return result;
  }

  /// True if the nearest triangle is at a distance of [low, high] from q. It is cheaper than the distance: nothing
  /// beyond `high` is looked at, once a triangle is found nothing beyond `low`, and one nearer than that ends it.
  [[nodiscard]] PSK_HD bool is_within(const Vec3f& q, double low, double high) const {
    if (high < 0) return false;
    const double squared_low = low > 0 ? low * low : 0;
    const double squared_high = high * high;
    bool any = false;
    bool nearer = false;
    const auto is_farther = [&](float squared) {
      const float surely = squared * (1 - 1e-5F);
      return any ? surely >= static_cast<float>(squared_low) : surely > static_cast<float>(squared_high);
    };
    visit_near(q, is_farther, [&](double squared, std::int64_t /*place*/) {
      any = any || squared <= squared_high;
      nearer = squared < squared_low;
      return !nearer;
    });
    return any && !nearer;
  }

  /// Calls visit(squared distance, place) for the triangles of nodes that `is_farther(squared distance)` does not pass over,
  /// near nodes first, until it returns false.
  template <class IsFarther, class Visit>
  PSK_HD void visit_near(const Vec3f& q, const IsFarther& is_farther, const Visit& visit) const {
    struct Waiting {
      std::int32_t node;
      int level;
      float squared;
    };
    Waiting stack[kMostLevels];
    int waiting = 0;
    Waiting at{0, levels.count - 1, 0};
    for (;;) {
      while (at.level > 0 && !is_farther(at.squared)) {
        const int below = at.level - 1;
        const std::int32_t left = 2 * at.node;
        Waiting near{left, below, squared_to_node(q, below, left)};
        if (left + 1 < levels.nodes[below]) {
          Waiting far{left + 1, below, squared_to_node(q, below, left + 1)};
          if (far.squared < near.squared) {
            const Waiting other = near;
            near = far;
            far = other;
          }
          if (!is_farther(far.squared)) stack[waiting++] = far;
        }
        at = near;
      }
      if (at.level == 0 && !is_farther(at.squared)) {
        const std::int64_t begin = std::int64_t{kTrianglesOfALeaf} * at.node;
        for (std::int64_t i = begin; i < begin + kTrianglesOfALeaf && i < triangles.size; ++i)
          if (!visit(triangles[i].squared_distance(q), i)) return;
      }
      if (waiting == 0) return;
      at = stack[--waiting];
    }
  }

  /// At most the squared distance from q to what node i of a level holds, but for rounding.
  [[nodiscard]] PSK_HD float squared_to_node(const Vec3f& q, int level, std::int32_t i) const {
    if (level < kDiscLevels) return discs[levels.first[level] + i].squared_distance(q);
    return squared_to_box(q, boxes[levels.first[level] + i]);
  }

  PSK_HD static float squared_to_box(const Vec3f& q, const Bounds& box) {
    const auto gap = [](float v, float lower, float upper) {
      return v < lower ? lower - v : v > upper ? v - upper : 0.0F;
    };
    const float x = gap(q.x, box.lower.x, box.upper.x);
    const float y = gap(q.y, box.lower.y, box.upper.y);
    const float z = gap(q.z, box.lower.z, box.upper.z);
    return x * x + y * y + z * z;
  }
};

/// The tree with its memory: 36 bytes a triangle and 16 for the nodes.
struct TriangleBoxes {
  exec::Buffer<PlacedTriangle> triangles;
  exec::Buffer<BoundingDisc> discs;
  exec::Buffer<Bounds> boxes;
  TreeLevels levels;

  [[nodiscard]] TriangleBoxesView view() const { return {triangles.cview(), discs.cview(), boxes.cview(), levels}; }
};

/// The triangle with its corners' places in place of their numbers.
PSK_HD inline PlacedTriangle placed(ArrayView<const Vec3f> vertices, const Triangle& ids) {
  return {vertices[ids[0]], vertices[ids[1]], vertices[ids[2]]};
}

struct KeyOfTriangle {
  ArrayView<const Vec3f> vertices;
  ArrayView<const Triangle> triangles;
  ArrayView<std::uint64_t> keys;
  ArrayView<std::int32_t> order;
  PSK_HD void operator()(std::int64_t t) const {
    const auto& [a, b, c] = placed(vertices, triangles[t]);
    keys[t] = hilbert_key({(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3});
    order[t] = static_cast<std::int32_t>(t);
  }
};

struct PlaceTriangle {
  ArrayView<const Vec3f> vertices;
  ArrayView<const Triangle> triangles;
  ArrayView<const std::int32_t> order;
  ArrayView<PlacedTriangle> placed_triangles;
  PSK_HD void operator()(std::int64_t i) const { placed_triangles[i] = placed(vertices, triangles[order[i]]); }
};

struct DiscOfNode {
  ArrayView<const PlacedTriangle> triangles;
  std::int64_t triangles_of_a_node;
  ArrayView<BoundingDisc> discs;
  PSK_HD void operator()(std::int64_t node) const {
    const std::int64_t begin = triangles_of_a_node * node;
    const std::int64_t end = begin + triangles_of_a_node;
    discs[node] = disc_around(triangles, begin, end < triangles.size ? end : triangles.size);
  }
};

struct BoxOfNode {
  ArrayView<const PlacedTriangle> triangles;
  std::int64_t triangles_of_a_node;
  ArrayView<Bounds> boxes;
  PSK_HD void operator()(std::int64_t node) const {
    const std::int64_t begin = triangles_of_a_node * node;
    Bounds box = box_of(triangles[begin]);
    for (std::int64_t i = begin + 1; i < begin + triangles_of_a_node && i < triangles.size; ++i)
      box = octree::JoinBoxes{}(box, box_of(triangles[i]));
    boxes[node] = box;
  }
};

struct BoxOfTwo {
  ArrayView<const Bounds> below;
  ArrayView<Bounds> boxes;
  PSK_HD void operator()(std::int64_t i) const {
    const Bounds left = below[2 * i];
    boxes[i] = 2 * i + 1 < below.size ? octree::JoinBoxes{}(left, below[2 * i + 1]) : left;
  }
};

/// @param vertices   in the unit cube, or not far beyond
/// @param triangles  shape (t), 0 < t < 2^31, ids in range
/// O(t log t). Deterministic, the same on every device.
template <exec::Space Exec>
TriangleBoxes make_triangle_boxes(Exec& ex, ArrayView<const Vec3f> vertices, ArrayView<const Triangle> triangles) {
  constexpr const char* kLabel = "offset.boxes";
  const std::int64_t count = triangles.size;
  auto keys = exec::make_buffer<std::uint64_t>(ex, count);
  auto order = exec::make_buffer<std::int32_t>(ex, count);
  for_each(ex, kLabel, count, KeyOfTriangle{vertices, triangles, keys.view(), order.view()});
  sort_pairs(ex, kLabel, keys, order, 3 * kHilbertBits);
  keys.reset();
  TriangleBoxes result;
  result.triangles = exec::make_buffer<PlacedTriangle>(ex, count);
  for_each(ex, kLabel, count, PlaceTriangle{vertices, triangles, order.cview(), result.triangles.view()});

  result.levels = TreeLevels::over(count);
  const TreeLevels& levels = result.levels;
  result.discs = exec::make_buffer<BoundingDisc>(ex, levels.discs());
  result.boxes = exec::make_buffer<Bounds>(ex, levels.boxes());
  const auto level_of = [&](auto& nodes, int l) { return nodes.view().part(levels.first[l], levels.nodes[l]); };
  for (int l = 0; l < levels.count; ++l) {
    const std::int64_t triangles_of_a_node = std::int64_t{kTrianglesOfALeaf} << l;
    if (l < kDiscLevels) {
      for_each(ex, kLabel, levels.nodes[l],
               DiscOfNode{result.triangles.cview(), triangles_of_a_node, level_of(result.discs, l)});
    } else if (l == kDiscLevels) {
      for_each(ex, kLabel, levels.nodes[l],
               BoxOfNode{result.triangles.cview(), triangles_of_a_node, level_of(result.boxes, l)});
    } else {
      for_each(ex, kLabel, levels.nodes[l], BoxOfTwo{level_of(result.boxes, l - 1), level_of(result.boxes, l)});
    }
  }
  return result;
}

}  // namespace pointskin::field::offset
