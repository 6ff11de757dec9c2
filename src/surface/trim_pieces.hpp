// The two sides of a cut, and the connected pieces of each: which are large enough to stay.
//
// Sides are settled at the vertices. A triangle across the line has one vertex alone on its side; the line cuts off the
// corner there. Two parts of triangles touch only where their vertices of that side are joined by edges of that side,
// so the pieces are the connected sets of vertices.
#pragma once

#include <cmath>
#include <cstdint>

#include <pointskin/vector.hpp>

#include "exec/algorithms.hpp"
#include "exec/disjoint_sets.hpp"
#include "exec/exact_sum.hpp"
#include "surface/edge_vertex.hpp"
#include "surface/trim.hpp"

namespace pointskin::surface::trim {

/// A triangle of which `alone` is on another side than the two that follow it.
struct SplitTriangle {
  std::int32_t alone, next, last;
};

/// The mesh with its sides.
struct SidesView {
  ArrayView<const Vec3f> positions;
  ArrayView<const Triangle> triangles;
  ArrayView<const float> values;
  float limit;
  ArrayView<const std::uint8_t> kept;  // (v) 1: stays

  /// Vertices of triangle t that stay: 0 to 3.
  PSK_HD int kept_corners(std::int64_t t) const {
    const std::int32_t* v = triangles[t].data();
    return kept[v[0]] + kept[v[1]] + kept[v[2]];
  }

  /// For triangles with one or two vertices that stay.
  PSK_HD SplitTriangle split(std::int64_t t) const {
    const std::int32_t* v = triangles[t].data();
    const int first = kept[v[1]] == kept[v[2]] ? 0 : kept[v[0]] == kept[v[2]] ? 1 : 2;
    return {v[first], v[(first + 1) % 3], v[(first + 2) % 3]};
  }

  /// Where the line crosses the edge from `a` to `b`, in (0, 1). From the smaller id to the larger one, so both
  /// triangles at the edge find the same place.
  PSK_HD float crossing(std::int32_t a, std::int32_t b) const {
    if (a > b) return 1 - crossing_upwards(b, a);
    return crossing_upwards(a, b);
  }
  PSK_HD float crossing_upwards(std::int32_t a, std::int32_t b) const {
    const float t = (limit - values[a]) / (values[b] - values[a]);
    return t < kCrossingMargin ? kCrossingMargin : t > 1 - kCrossingMargin ? 1 - kCrossingMargin : t;
  }

  /// In double.
  PSK_HD double area(std::int64_t t) const {
    const Vec3f& a = positions[triangles[t].data()[0]];
    const Vec3f& b = positions[triangles[t].data()[1]];
    const Vec3f& c = positions[triangles[t].data()[2]];
    const double ux = static_cast<double>(b.x) - a.x, uy = static_cast<double>(b.y) - a.y;
    const double uz = static_cast<double>(b.z) - a.z;
    const double vx = static_cast<double>(c.x) - a.x, vy = static_cast<double>(c.y) - a.y;
    const double vz = static_cast<double>(c.z) - a.z;
    const double x = uy * vz - uz * vy, y = uz * vx - ux * vz, z = ux * vy - uy * vx;
    return 0.5 * std::sqrt(x * x + y * y + z * z);
  }

  /// Share of a split triangle's area at the vertex that is alone.
  PSK_HD double corner_share(const SplitTriangle& s) const {
    return static_cast<double>(crossing(s.alone, s.next)) * static_cast<double>(crossing(s.alone, s.last));
  }
};

struct IsKept {
  ArrayView<const float> values;
  float limit;
  ArrayView<std::uint8_t> kept;
  PSK_HD void operator()(std::int64_t v) const { kept[v] = values[v] <= limit ? 1 : 0; }
};

/// Units of exact sums of areas, 2^-this. A triangle in the unit cube is far below the 2^5 that a term may have.
inline constexpr int kAreaFraction = 90;

/// Areas and numbers of triangles by what becomes of them.
struct Extent {
  exec::ExactSum area, kept_area;     // in units of 2^-kAreaFraction
  std::int64_t whole = 0, split = 0;  // triangles
};
struct ExtentOf {
  SidesView mesh;
  PSK_HD Extent operator()(std::int64_t t) const {
    const double area = mesh.area(t);
    const exec::ExactSum all = exec::exact_term(area, kAreaFraction);
    const int corners = mesh.kept_corners(t);
    if (corners == 0) return {all, {}, 0, 0};
    if (corners == 3) return {all, all, 1, 0};
    const double corner = mesh.corner_share(mesh.split(t));
    return {all, exec::exact_term(area * (corners == 1 ? corner : 1 - corner), kAreaFraction), 0, 1};
  }
};
struct AddExtents {
  PSK_HD Extent operator()(const Extent& a, const Extent& b) const {
    const exec::AddExactly add;
    return {add(a.area, b.area), add(a.kept_area, b.kept_area), a.whole + b.whole, a.split + b.split};
  }
};

struct Unite {
  SidesView mesh;
  exec::DisjointSets pieces;
  PSK_HD void operator()(std::int64_t t) const {
    const std::int32_t* v = mesh.triangles[t].data();
    const int corners = mesh.kept_corners(t);
    if (corners == 0 || corners == 3) {
      pieces.unite(v[0], v[1]);
      pieces.unite(v[1], v[2]);
    } else {
      const SplitTriangle s = mesh.split(t);
      pieces.unite(s.next, s.last);
    }
  }
};

/// Areas of pieces are integers, in units of 2^-48: sums of any order are the same. All of a mesh with 32-bit ids is
/// below 2^13, so 64 bits hold it.
inline constexpr double kAreaUnits = 0x1p48;
PSK_HD inline std::uint64_t area_units(double area) { return static_cast<std::uint64_t>(area * kAreaUnits); }

/// Adds the areas of kTriangles triangles to their pieces. Neighbours in memory are mostly of one piece, which then
/// gets one addition, not one a triangle.
struct SumAreas {
  static constexpr std::int64_t kTriangles = 32;
  SidesView mesh;
  exec::DisjointSets pieces;
  ArrayView<std::uint64_t> areas;  // (v) at the roots

  PSK_HD void operator()(std::int64_t block) const {
    const std::int64_t first = block * kTriangles;
    const std::int64_t end = first + kTriangles < mesh.triangles.size ? first + kTriangles : mesh.triangles.size;
    std::int32_t piece = -1;
    std::uint64_t sum = 0;
    const auto count = [&](std::int32_t vertex, double area) {
      const std::int32_t root = pieces.root(vertex);
      if (root != piece) {
        if (sum > 0) exec::add(areas.data + piece, sum);
        piece = root;
        sum = 0;
      }
      sum += area_units(area);
    };
    for (std::int64_t t = first; t < end; ++t) {
      const double area = mesh.area(t);
      const int corners = mesh.kept_corners(t);
      if (corners == 0 || corners == 3) {
        count(mesh.triangles[t].data()[0], area);
        continue;
      }
      const SplitTriangle s = mesh.split(t);
      const double corner = area * mesh.corner_share(s);
      count(s.alone, corner);
      count(s.next, area - corner);
    }
    if (sum > 0) exec::add(areas.data + piece, sum);
  }
};

/// Pieces of either side below an area.
struct SmallPieces {
  std::int64_t kept = 0, cut = 0;
};
struct CountSmall {
  ArrayView<const std::uint8_t> kept;
  exec::DisjointSets pieces;
  ArrayView<const std::uint64_t> areas;
  std::uint64_t least;
  PSK_HD SmallPieces operator()(std::int64_t v) const {
    if (!pieces.is_root(static_cast<std::int32_t>(v)) || areas[v] >= least) return {};
    return {kept[v] != 0 ? 1 : 0, kept[v] != 0 ? 0 : 1};
  }
};
struct AddSmall {
  PSK_HD SmallPieces operator()(const SmallPieces& a, const SmallPieces& b) const {
    return {a.kept + b.kept, a.cut + b.cut};
  }
};

/// Moves the small pieces of one side to the other.
struct FlipSmall {
  exec::DisjointSets pieces;
  ArrayView<const std::uint64_t> areas;
  std::uint64_t least;
  std::uint8_t from;
  ArrayView<std::uint8_t> kept;
  PSK_HD void operator()(std::int64_t v) const {
    if (kept[v] == from && areas[pieces.root(static_cast<std::int32_t>(v))] < least) kept[v] = from == 0 ? 1 : 0;
  }
};

/// The pieces of both sides.
template <exec::Space Exec>
class Pieces {
 public:
  Pieces(Exec& ex, const SidesView& mesh, std::uint64_t least)
      : ex_(ex),
        vertices_(mesh.positions.size),
        least_(least),
        parents_(exec::iota(ex, vertices_)),
        areas_(exec::make_buffer<std::uint64_t>(ex, vertices_)) {
    for_each(ex, "trim.pieces", mesh.triangles.size, Unite{mesh, sets()});
    exec::fill<std::uint64_t>(ex, areas_.view(), 0);
    const std::int64_t blocks = (mesh.triangles.size + SumAreas::kTriangles - 1) / SumAreas::kTriangles;
    for_each(ex, "trim.areas", blocks, SumAreas{mesh, sets(), areas_.view()});
  }

  [[nodiscard]] SmallPieces count_small(ArrayView<const std::uint8_t> kept) const {
    return exec::reduce<SmallPieces>(ex_, "trim.small", vertices_, CountSmall{kept, sets(), areas_.cview(), least_},
                                     AddSmall{});
  }

  void flip_small(ArrayView<std::uint8_t> kept, std::uint8_t from) const {
    for_each(ex_, "trim.flip", vertices_, FlipSmall{sets(), areas_.cview(), least_, from, kept});
  }

 private:
  [[nodiscard]] exec::DisjointSets sets() const { return {parents_.view()}; }

  Exec& ex_;
  std::int64_t vertices_;
  std::uint64_t least_;
  exec::Buffer<std::int32_t> parents_;
  exec::Buffer<std::uint64_t> areas_;
};

/// Lets pieces below `least` change sides: first those that would be cut away, then those that would stay.
template <exec::Space Exec>
SmallPieces clear_small_pieces(Exec& ex, const SidesView& mesh, std::uint64_t least, ArrayView<std::uint8_t> kept) {
  SmallPieces small;
  {
    const Pieces<Exec> pieces(ex, mesh, least);
    small = pieces.count_small(kept);
    if (small.cut == 0) {
      if (small.kept > 0) pieces.flip_small(kept, 1);
      return small;
    }
    pieces.flip_small(kept, 0);
  }
  const Pieces<Exec> pieces(ex, mesh, least);
  small.kept = pieces.count_small(kept).kept;
  if (small.kept > 0) pieces.flip_small(kept, 1);
  return small;
}

}  // namespace pointskin::surface::trim
