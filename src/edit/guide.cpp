#include "edit/guide.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <string>
#include <vector>

#include "exec/this_space.hpp"
#include "octree/access.hpp"

namespace pointskin::edit {
namespace {

/// The layers of candidates: layer k lies at depth first + k interval.
struct Layers {
  double first, interval;
  ArrayView<const std::int64_t> begin;  ///< (layers + 1) first candidate of each

  [[nodiscard]] PSK_HD double depth(std::int64_t layer) const { return first + static_cast<double>(layer) * interval; }
  [[nodiscard]] PSK_HD std::int64_t layer_of(std::int64_t candidate) const {
    std::int64_t low = 0;
    std::int64_t high = begin.size - 1;  // begin[low] <= candidate < begin[high]
    while (high - low > 1) {
      const std::int64_t middle = (low + high) / 2;
      (begin[middle] <= candidate ? low : high) = middle;
    }
    return low;
  }
};

/// A place on the plane, and the direction of the stroke there, of any length.
struct Candidate {
  PlanePoint place;
  double depth = 0;
  PlanePoint tangent{};
};

/// Candidates along a polyline.
struct OnStroke {
  ViewFrame view;
  Layers layers;
  ArrayView<const PlanePoint> points;
  ArrayView<const double> length;  ///< (points) of the polyline up to each point

  [[nodiscard]] PSK_HD Candidate operator()(std::int64_t i) const {
    const std::int64_t layer = layers.layer_of(i);
    const double depth = layers.depth(layer);
    const double at = static_cast<double>(i - layers.begin[layer]) * layers.interval / view.scale_at(depth);
    std::int64_t segment = 0;  // few points: a search by halves would be longer to read, not faster
    while (segment + 2 < points.size && length[segment + 1] < at) ++segment;
    const PlanePoint from = points[segment];
    if (points.size < 2) return {from, depth};
    const PlanePoint tangent{points[segment + 1].x - from.x, points[segment + 1].y - from.y};
    const double whole = length[segment + 1] - length[segment];
    const double t = whole > 0 ? (at - length[segment]) / whole : 0;
    return {{from.x + t * tangent.x, from.y + t * tangent.y}, depth, tangent};
  }
  [[nodiscard]] PSK_HD bool is_wanted(const Candidate& /*candidate*/) const { return true; }
};

/// Candidates on a grid over the bounding rectangle of polygons.
struct InArea {
  ViewFrame view;
  Layers layers;
  PlanePoint lower;
  double height;  ///< of the rectangle
  Polygons area;

  [[nodiscard]] PSK_HD Candidate operator()(std::int64_t i) const {
    const std::int64_t layer = layers.layer_of(i);
    const double depth = layers.depth(layer);
    const double step = layers.interval / view.scale_at(depth);
    const std::int64_t rows = static_cast<std::int64_t>(height / step) + 1;
    const std::int64_t in_layer = i - layers.begin[layer];
    // Half a step from the lower corner: an outline along the grid takes the points of one side.
    return {{lower.x + (static_cast<double>(in_layer / rows) + 0.5) * step,
             lower.y + (static_cast<double>(in_layer % rows) + 0.5) * step},
            depth};
  }
  [[nodiscard]] PSK_HD bool is_wanted(const Candidate& candidate) const { return area.contains(candidate.place); }
};

template <class Shape>
struct IsKept {
  Shape shape;
  KeepInside keep;
  PSK_HD bool operator()(std::int64_t i) const {
    const Candidate candidate = shape(i);
    if (!shape.is_wanted(candidate)) return false;
    const Vec3f p = keep.cube.to_unit(shape.view.unproject(candidate.place, candidate.depth));
    if (!(p.x >= 0 && p.x <= 1 && p.y >= 0 && p.y <= 1 && p.z >= 0 && p.z <= 1)) return false;
    const field::FieldView& f = keep.field;
    return !keep.inside_only || octree::value_at(f.tree, f.values, p, f.tree.depth) >= f.isovalue;
  }
};

template <class Shape>
struct WriteKept {
  Shape shape;
  ArrayView<const std::int32_t> kept;
  ArrayView<Vec3f> positions, normals;  // normals may be empty
  PSK_HD void operator()(std::int64_t i) const {
    const Candidate candidate = shape(kept[i]);
    positions[i] = shape.view.unproject(candidate.place, candidate.depth);
    if (!normals.empty()) normals[i] = to_the_right(candidate);
  }
  /// Line of sight x tangent.
  [[nodiscard]] PSK_HD Vec3f to_the_right(const Candidate& candidate) const {
    const PlanePoint t = candidate.tangent;
    const PlanePoint sight = shape.view.perspective ? candidate.place : PlanePoint{};  // and -1 towards the viewer
    const double x = t.y;
    const double y = -t.x;
    const double z = sight.x * t.y - sight.y * t.x;
    const double length = std::sqrt(x * x + y * y + z * z);
    const double inverse = length > 0 ? 1 / length : 0;
    return shape.view.direction(x * inverse, y * inverse, z * inverse);
  }
};

/// Where the candidates of each layer begin, and after the last one their number.
/// @param count  candidates of the layer at a depth, as a double: it may be huge
template <class Count>
std::vector<std::int64_t> layer_begins(const GuideShape& shape, const Count& count) {
  constexpr double kMost = std::numeric_limits<std::int32_t>::max();
  const double layers = std::floor((shape.last_depth - shape.first_depth) / shape.interval) + 1;
  std::vector<std::int64_t> begin{0};
  double total = layers;  // a stroke has one point a layer at least
  for (double k = 0; k < layers && total <= kMost; ++k) {
    const double here = count(shape.first_depth + k * shape.interval);
    total += here;
    if (total <= kMost) begin.push_back(begin.back() + static_cast<std::int64_t>(here));
  }
  if (!(total <= kMost))
    throw Error(ErrorCode::over_limit, "the guide would make more than 2^31 - 1 points; choose a larger interval");
  return begin;
}

template <class T, exec::Space Exec>
exec::Buffer<T> upload(Exec& ex, const std::vector<T>& from) {
  auto buffer = exec::make_buffer<T>(ex, static_cast<std::int64_t>(from.size()));
  copy_to_device(ex, from.data(), buffer.view());
  return buffer;
}

/// 1 for a candidate that is kept, of those that are looked at for a first guess.
template <class Shape>
struct CountKept {
  IsKept<Shape> is_kept;
  double step;  ///< from one to the next
  PSK_HD std::int64_t operator()(std::int64_t i) const {
    return is_kept(static_cast<std::int64_t>(static_cast<double>(i) * step)) ? 1 : 0;
  }
};

struct AddCounts {
  PSK_HD std::int64_t operator()(std::int64_t a, std::int64_t b) const { return a + b; }
};

/// Refuses what the memory that is allowed cannot hold, by the share of evenly spread candidates that are kept: looking
/// at all of them takes minutes where they are billions.
template <exec::Space Exec, class Shape>
void check_room(Exec& ex, const IsKept<Shape>& is_kept, std::int64_t candidates) {
  constexpr std::int64_t kBytesPerPoint = 24 + 68;  // as guides and as points that are sorted: less than any run takes
  constexpr std::int64_t kLookedAt = 1 << 16;
  constexpr double kSure = 0.9;  // of the guess
  if (ex.pool()->limit() == 0 || candidates <= kLookedAt) return;
  const double step = static_cast<double>(candidates) / static_cast<double>(kLookedAt);
  const auto kept =
      exec::reduce<std::int64_t>(ex, "guide.guess", kLookedAt, CountKept<Shape>{is_kept, step}, AddCounts{});
  const double points = static_cast<double>(kept) * step;
  const double least_bytes = kSure * points * static_cast<double>(kBytesPerPoint);
  if (least_bytes <= static_cast<double>(ex.pool()->limit() - ex.pool()->held_bytes())) return;
  throw Error(ErrorCode::over_limit,
              "the guide would make about " + std::to_string(static_cast<std::int64_t>(points)) +
                  " points, which do not fit into the memory that is allowed; choose a larger interval");
}

template <exec::Space Exec, class Shape>
GuidePoints keep_points(Exec& ex, const Shape& shape, std::int64_t candidates, const KeepInside& keep,
                        bool stroke_normals) {
  const IsKept<Shape> is_kept{shape, keep};
  check_room(ex, is_kept, candidates);
  const exec::Buffer<std::int32_t> kept = select(ex, "guide.keep", candidates, is_kept);
  GuidePoints points{exec::make_buffer<Vec3f>(ex, kept.size()),
                     exec::make_buffer<Vec3f>(ex, stroke_normals ? kept.size() : 0)};
  for_each(ex, "guide.write", kept.size(),
           WriteKept<Shape>{shape, kept.cview(), points.positions.view(), points.normals.view()});
  return points;
}

template <exec::Space Exec>
GuidePoints along_stroke(Exec& ex, const ViewFrame& view, const GuideShape& shape, const KeepInside& keep,
                         bool stroke_normals) {
  std::vector<double> length{0};
  for (std::size_t i = 1; i < shape.stroke.size(); ++i)
    length.push_back(length.back() +
                     std::hypot(shape.stroke[i].x - shape.stroke[i - 1].x, shape.stroke[i].y - shape.stroke[i - 1].y));
  const std::vector<std::int64_t> begin = layer_begins(
      shape, [&](double depth) { return std::floor(length.back() * view.scale_at(depth) / shape.interval) + 1; });
  const auto points = upload(ex, shape.stroke);
  const auto lengths = upload(ex, length);
  const auto begins = upload(ex, begin);
  const OnStroke stroke{view, {shape.first_depth, shape.interval, begins.cview()}, points.cview(), lengths.cview()};
  return keep_points(ex, stroke, begin.back(), keep, stroke_normals);
}

template <exec::Space Exec>
GuidePoints in_area(Exec& ex, const ViewFrame& view, const GuideShape& shape, const KeepInside& keep) {
  PlanePoint lower = shape.edges.front().from;
  PlanePoint upper = lower;
  for (const PlaneEdge& edge : shape.edges) {
    lower = {std::min(lower.x, edge.from.x), std::min(lower.y, edge.from.y)};
    upper = {std::max(upper.x, edge.from.x), std::max(upper.y, edge.from.y)};
  }
  const std::vector<std::int64_t> begin = layer_begins(shape, [&](double depth) {
    const double step = shape.interval / view.scale_at(depth);
    return (std::floor((upper.x - lower.x) / step) + 1) * (std::floor((upper.y - lower.y) / step) + 1);
  });
  const auto edges = upload(ex, shape.edges);
  const auto begins = upload(ex, begin);
  const InArea area{
      view, {shape.first_depth, shape.interval, begins.cview()}, lower, upper.y - lower.y, {edges.cview()}};
  return keep_points(ex, area, begin.back(), keep, false);
}

}  // namespace

template <exec::Space Exec>
GuidePoints guide_points(Exec& ex, const ViewFrame& view, const GuideShape& shape, const KeepInside& keep,
                         bool stroke_normals) {
  if (!shape.stroke.empty()) return along_stroke(ex, view, shape, keep, stroke_normals);
  return in_area(ex, view, shape, keep);
}

PSK_INSTANTIATE(guide_points);

}  // namespace pointskin::edit
