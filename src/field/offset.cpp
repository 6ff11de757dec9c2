#include "field/offset.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "exec/this_space.hpp"
#include "field/corner_values.hpp"
#include "field/triangle_boxes.hpp"

namespace pointskin::field {
namespace {

using namespace offset;

/// From the unit cube of one frame into that of another.
struct BetweenFrames {
  double scale = 1;
  Vec3d shift{0, 0, 0};

  static BetweenFrames make(const octree::Frame& from, const octree::Frame& to) {
    BetweenFrames result;
    result.scale = from.size / to.size;
    for (std::size_t a = 0; a < 3; ++a) result.shift[a] = (from.lower[a] - to.lower[a]) / to.size;
    return result;
  }
  [[nodiscard]] PSK_HD Vec3f operator()(const Vec3f& p) const {
    return {static_cast<float>(p.x * scale + shift[0]), static_cast<float>(p.y * scale + shift[1]),
            static_cast<float>(p.z * scale + shift[2])};
  }
};

struct MoveVertices {
  BetweenFrames move;
  ArrayView<const Vec3f> in;
  ArrayView<Vec3f> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = move(in[i]); }
};

/// Distance from the surface in the unit cube of the offset, positive outside.
struct SignedDistance {
  TriangleBoxesView surface;
  FieldView original;
  BetweenFrames to_original;

  [[nodiscard]] PSK_HD bool is_within(const Vec3f& q, double low, double high) const {
    return is_inside(to_original(q)) ? surface.is_within(q, -high, -low) : surface.is_within(q, low, high);
  }
  [[nodiscard]] PSK_HD bool is_inside(const Vec3f& p) const {
    const bool in_cube = p.x > 0 && p.y > 0 && p.z > 0 && p.x < 1 && p.y < 1 && p.z < 1;
    return in_cube && octree::value_at(original.tree, original.values, p, original.tree.depth) >= original.isovalue;
  }
};

/// True for cells that may hold a place at the offset. Distances change by no more than the way between two places.
struct MayHoldOffset {
  ArrayView<const std::uint64_t> cells;
  int depth;
  SignedDistance signed_distance;
  double offset, slack;  // in the unit cube
  PSK_HD bool operator()(std::int64_t i) const {
    constexpr double kHalfDiagonal = 0.8660254037844387;
    const octree::Coordinates c = octree::decode(cells[i]);
    const float width = 1.0F / static_cast<float>(1 << depth);
    const Vec3f centre{(static_cast<float>(c.x) + 0.5F) * width, (static_cast<float>(c.y) + 0.5F) * width,
                       (static_cast<float>(c.z) + 0.5F) * width};
    const double reach = kHalfDiagonal * width + slack;
    return signed_distance.is_within(centre, offset - reach, offset + reach);
  }
};

/// The first cells: all of a level, in the order of their keys.
struct AllCells {
  ArrayView<std::uint64_t> cells;
  PSK_HD void operator()(std::int64_t i) const { cells[i] = static_cast<std::uint64_t>(i); }
};

struct ChildrenOf {
  ArrayView<const std::uint64_t> cells;
  ArrayView<const std::int32_t> kept;
  ArrayView<std::uint64_t> children;
  PSK_HD void operator()(std::int64_t i) const {
    children[i] = cells[kept[i >> 3]] << 3 | static_cast<std::uint64_t>(i & 7);
  }
};

/// A cell as the key of a point in it.
struct PointInCell {
  ArrayView<const std::uint64_t> cells;
  ArrayView<const std::int32_t> kept;
  int depth;
  ArrayView<std::uint64_t> keys;
  PSK_HD void operator()(std::int64_t i) const { keys[i] = cells[kept[i]] << 3 * (octree::kPointBits - depth); }
};

/// Values at the corners of a level, after those of the level above. A corner that is no unknown has the interpolation of
/// these, and an unknown that is one of theirs, too, the same value. For all others the nearest triangle is searched, from
/// that of the parent's corner on.
struct FillLevel {
  octree::OctreeView tree;
  int depth;
  SignedDistance signed_distance;
  ArrayView<const std::int32_t> nearest_above;  ///< at the nodes of the level above
  ArrayView<std::int32_t> nearest;              ///< at the nodes of this level; empty: not kept
  float* values;                                ///< of all levels

  PSK_HD void operator()(std::int64_t n) const {
    const octree::LevelView& level = tree.levels[depth];
    std::int32_t at = 0;
    float value = 0;
    if (depth > 0) {
      const octree::LevelView& above = tree.levels[depth - 1];
      const std::int32_t parent = level.parent[n >> 3];
      const float* values_above = values + above.first_node;
      at = nearest_above[parent];
      if (!corners::is_unknown(level, n)) {
        value = octree::prolonged(above, values_above, parent, static_cast<int>(n & 7));
      } else if ((n & 7) == 0 && corners::is_unknown(above, parent)) {
        value = values_above[parent];
      } else {
        value = search(level, n, at);
      }
    } else if (corners::is_unknown(level, n)) {
      value = search(level, n, at);
    }
    values[level.first_node + n] = value;
    if (!nearest.empty()) nearest[n] = at;
  }

  /// Minus the signed distance, in finest cells.
  /// @param at  the triangle to begin at; then the nearest one
  [[nodiscard]] PSK_HD float search(const octree::LevelView& level, std::int64_t n, std::int32_t& at) const {
    const Vec3f x = corners::place_of(level, static_cast<std::int32_t>(n));
    const NearTriangle found = signed_distance.surface.nearest(x, at);
    at = found.place;
    const double cells = std::sqrt(found.squared) * static_cast<double>(std::int64_t{1} << tree.depth);
    return static_cast<float>(signed_distance.is_inside(signed_distance.to_original(x)) ? cells : -cells);
  }
};

/// At all levels, level-major. One launch a level; besides the result 4 bytes a node of two levels at a time, the finest not
/// among them.
template <exec::Space Exec>
exec::Buffer<float> fill_levels(Exec& ex, const octree::OctreeView& tree, const SignedDistance& signed_distance) {
  auto values = exec::make_buffer<float>(ex, tree.nodes);
  exec::Buffer<std::int32_t> above;
  for (int d = 0; d <= tree.depth; ++d) {
    const std::int64_t nodes = tree.levels[d].nodes();
    auto nearest = exec::make_buffer<std::int32_t>(ex, d < tree.depth ? nodes : 0);
    for_each(ex, "offset.distance", nodes,
             FillLevel{tree, d, signed_distance, above.cview(), nearest.view(), values.data()});
    above = std::move(nearest);
  }
  return values;
}

/// Keys of points, one in every cell of level `depth` that may hold a place at the offset.
template <exec::Space Exec>
exec::Buffer<std::uint64_t> find_band(Exec& ex, const SignedDistance& signed_distance, int depth, double offset_cells) {
  constexpr const char* kLabel = "offset.band";
  // Next to the triangles signs may be wrong, as these are flat and the field is not. Finest cells at the offset are not
  // next to them if it is far enough; what is left is rounding.
  const auto slack_cells = [&](int level) { return level == depth && std::abs(offset_cells) > 2 ? 0.01 : 0.25; };
  const double cell = 1 / static_cast<double>(std::int64_t{1} << depth);
  int level = std::min(depth, octree::kCompleteDepth);
  auto cells = exec::make_buffer<std::uint64_t>(ex, std::int64_t{1} << 3 * level);
  for_each(ex, kLabel, cells.size(), AllCells{cells.view()});
  for (;; ++level) {
    const exec::Buffer<std::int32_t> kept =
        select(ex, kLabel, cells.size(),
               MayHoldOffset{cells.cview(), level, signed_distance, offset_cells * cell, slack_cells(level) * cell});
    if (kept.empty())
      throw Error(ErrorCode::empty_result, "nothing is left of the surface at this offset; choose a smaller distance");
    if (kept.size() > std::numeric_limits<std::int32_t>::max() / 8)
      throw Error(ErrorCode::over_limit, "the offset surface is too large for this depth; choose a smaller depth");
    auto next = exec::make_buffer<std::uint64_t>(ex, level == depth ? kept.size() : 8 * kept.size());
    if (level == depth) {
      for_each(ex, kLabel, next.size(), PointInCell{cells.cview(), kept.cview(), depth, next.view()});
      return next;
    }
    for_each(ex, kLabel, next.size(), ChildrenOf{cells.cview(), kept.cview(), next.view()});
    cells = std::move(next);
  }
}

}  // namespace

template <exec::Space Exec>
OffsetField make_offset(Exec& ex, const SurfaceOfField& surface, const octree::Frame& frame, int depth,
                        double offset_cells) {
  auto vertices = exec::make_buffer<Vec3f>(ex, surface.vertices.size);
  for_each(ex, "offset.vertices", vertices.size(),
           MoveVertices{BetweenFrames::make(surface.frame, frame), surface.vertices, vertices.view()});
  const TriangleBoxes boxes = make_triangle_boxes(ex, vertices.cview(), surface.triangles);
  vertices.reset();
  const SignedDistance signed_distance{boxes.view(), surface.field, BetweenFrames::make(frame, surface.frame)};

  OffsetField result;
  const exec::Buffer<std::uint64_t> band = find_band(ex, signed_distance, depth, offset_cells);
  result.band_cells = band.size();
  result.tree = octree::build_octree(ex, band.cview(), depth);
  result.values = fill_levels(ex, result.tree.view(), signed_distance);
  return result;
}

PSK_INSTANTIATE(make_offset);

}  // namespace pointskin::field
