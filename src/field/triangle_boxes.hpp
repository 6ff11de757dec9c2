// A tree of boxes over the triangles of a surface, and the distance to the nearest one, on every device.
// Source: Karras, "Maximizing parallelism in the construction of BVHs, octrees, and k-d trees", HPG 2012 (triangles in
// Morton order). Differs: the tree is implicit, two neighbours of a level have one box above them, so that it needs no
// links and is built in one pass over each level.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>

#include <cstdint>

#include "core/array_view.hpp"
#include "core/triangle_distance.hpp"
#include "core/vec3.hpp"
#include "exec/algorithms.hpp"
#include "octree/bounding_box.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::field::offset {

/// The corners of a triangle.
struct PlacedTriangle {
  Vec3f a, b, c;

  /// Squared distance from q. In double: the triangles are small.
  [[nodiscard]] PSK_HD double squared_distance(const Vec3f& q) const {
    const Vec3d at = to_double(a);
    return pointskin::squared_distance(to_double(q), {at, to_double(b) - at, to_double(c) - at});
  }
};

PSK_HD inline Bounds box_of(const PlacedTriangle& t) {
  const octree::JoinBoxes join;
  return join(join({t.a, t.a}, {t.b, t.b}), {t.c, t.c});
}

/// Triangles of one box of the lowest level; two boxes a box above.
inline constexpr std::int32_t kTrianglesOfALeaf = 4;
/// Levels of boxes over fewer than 2^31 triangles.
inline constexpr int kMostBoxLevels = 30;

/// The tree, as kernels ask it. Level l of the boxes begins at first[l]; box i of it holds boxes 2 i and 2 i + 1 of the
/// level below, the last one maybe the first of these alone.
struct TriangleBoxesView {
  ArrayView<const PlacedTriangle> triangles;  ///< in the order of the leaves
  ArrayView<const Bounds> boxes;
  std::int32_t first[kMostBoxLevels + 1]{};
  int levels = 0;

  /// Squared distance from q to the nearest triangle, up to rounding of float: a triangle that is nearer by less than
  /// 5e-7 of the distance may be passed over. Seen from afar all of a small surface is equally far.
  /// About O(log n); more where many triangles are about equally far.
  [[nodiscard]] PSK_HD double squared_distance(const Vec3f& q) const {
    double least = 0;
    bool any = false;
    const auto is_farther = [&](float squared) { return any && squared * (1 + 1e-6F) >= static_cast<float>(least); };
    visit_near(q, is_farther, [&](double squared) {
      if (!any || squared < least) least = squared;
      any = true;
      return true;
    });
    return least;
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
    visit_near(q, is_farther, [&](double squared) {
      any = any || squared <= squared_high;
      nearer = squared < squared_low;
      return !nearer;
    });
    return any && !nearer;
  }

  /// Calls visit(squared distance) for the triangles that `is_farther(squared distance of a box)` does not pass over,
  /// near boxes first, until it returns false.
  template <class IsFarther, class Visit>
  PSK_HD void visit_near(const Vec3f& q, const IsFarther& is_farther, const Visit& visit) const {
    struct Waiting {
      std::int32_t box;
      int level;
      float squared;
    };
    Waiting stack[kMostBoxLevels];
    int waiting = 0;
    Waiting at{0, levels - 1, 0};
    for (;;) {
      while (at.level > 0 && !is_farther(at.squared)) {
        const int below = at.level - 1;
        const std::int32_t left = 2 * at.box;
        Waiting near{left, below, squared_to_box(q, boxes[first[below] + left])};
        if (left + 1 < first[below + 1] - first[below]) {
          Waiting far{left + 1, below, squared_to_box(q, boxes[first[below] + left + 1])};
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
        const std::int64_t begin = std::int64_t{kTrianglesOfALeaf} * at.box;
        for (std::int64_t i = begin; i < begin + kTrianglesOfALeaf && i < triangles.size; ++i) {
          const PlacedTriangle t = triangles[i];
          if (is_farther(squared_to_box(q, box_of(t)))) continue;
          if (!visit(t.squared_distance(q))) return;
        }
      }
      if (waiting == 0) return;
      at = stack[--waiting];
    }
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

/// The tree with its memory: 36 bytes a triangle and about 12 for the boxes.
struct TriangleBoxes {
  exec::Buffer<PlacedTriangle> triangles;
  exec::Buffer<Bounds> boxes;
  std::int32_t first[kMostBoxLevels + 1]{};
  int levels = 0;

  [[nodiscard]] TriangleBoxesView view() const {
    TriangleBoxesView result{triangles.cview(), boxes.cview()};
    for (int l = 0; l <= levels; ++l) result.first[l] = first[l];
    result.levels = levels;
    return result;
  }
};

struct MiddleOfTriangle {
  ArrayView<const Vec3f> vertices;
  ArrayView<const Triangle> triangles;
  ArrayView<Vec3f> middles;
  ArrayView<std::uint64_t> ties;
  PSK_HD void operator()(std::int64_t t) const {
    const std::int32_t* ids = triangles[t].data();
    const Vec3f& a = vertices[ids[0]];
    const Vec3f& b = vertices[ids[1]];
    const Vec3f& c = vertices[ids[2]];
    middles[t] = {(a.x + b.x + c.x) / 3, (a.y + b.y + c.y) / 3, (a.z + b.z + c.z) / 3};
    ties[t] = static_cast<std::uint64_t>(t);
  }
};

struct PlaceTriangle {
  ArrayView<const Vec3f> vertices;
  ArrayView<const Triangle> triangles;
  ArrayView<const std::int32_t> order;
  ArrayView<PlacedTriangle> placed;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t* ids = triangles[order[i]].data();
    placed[i] = {vertices[ids[0]], vertices[ids[1]], vertices[ids[2]]};
  }
};

struct BoxOfLeaf {
  ArrayView<const PlacedTriangle> triangles;
  ArrayView<Bounds> boxes;
  PSK_HD void operator()(std::int64_t leaf) const {
    const octree::JoinBoxes join;
    const std::int64_t begin = kTrianglesOfALeaf * leaf;
    Bounds box = box_of(triangles[begin]);
    for (std::int64_t i = begin + 1; i < begin + kTrianglesOfALeaf && i < triangles.size; ++i)
      box = join(box, box_of(triangles[i]));
    boxes[leaf] = box;
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
  auto middles = exec::make_buffer<Vec3f>(ex, count);
  auto ties = exec::make_buffer<std::uint64_t>(ex, count);
  for_each(ex, kLabel, count, MiddleOfTriangle{vertices, triangles, middles.view(), ties.view()});
  const octree::SortedPoints sorted = octree::sort_points(ex, middles.cview(), ties.cview());
  middles.reset();
  ties.reset();
  TriangleBoxes result;
  result.triangles = exec::make_buffer<PlacedTriangle>(ex, count);
  for_each(ex, kLabel, count, PlaceTriangle{vertices, triangles, sorted.order.cview(), result.triangles.view()});

  std::int64_t boxes = (count + kTrianglesOfALeaf - 1) / kTrianglesOfALeaf;
  std::int64_t all = 0;
  for (;; boxes = (boxes + 1) / 2) {
    result.first[result.levels++] = static_cast<std::int32_t>(all);
    all += boxes;
    if (boxes == 1) break;
  }
  result.first[result.levels] = static_cast<std::int32_t>(all);
  result.boxes = exec::make_buffer<Bounds>(ex, all);
  const auto level = [&](int l) {
    return result.boxes.view().part(result.first[l], result.first[l + 1] - result.first[l]);
  };
  for_each(ex, kLabel, level(0).size, BoxOfLeaf{result.triangles.cview(), level(0)});
  for (int l = 1; l < result.levels; ++l) for_each(ex, kLabel, level(l).size, BoxOfTwo{level(l - 1), level(l)});
  return result;
}

}  // namespace pointskin::field::offset
