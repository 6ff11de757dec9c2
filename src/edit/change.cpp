#include "edit/change.hpp"

#include <pointskin/error.hpp>

#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

#include "edit/choice.hpp"
#include "edit/guide.hpp"
#include "edit/normals_around.hpp"
#include "edit/placement.hpp"
#include "edit/view_frame.hpp"
#include "exec/this_space.hpp"

namespace pointskin::edit {
namespace {

using detail::FieldData;
using detail::FieldSamples;
using detail::PointBuffers;

/// 1 for points that say something of normals.
struct IsKindOtherThan {
  ArrayView<const std::uint8_t> added;
  std::uint8_t kind;
  ArrayView<std::uint8_t> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = added[i] != kind ? 1 : 0; }
};

struct Scale {
  ArrayView<Vec3f> vectors;
  float factor;
  PSK_HD void operator()(std::int64_t i) const {
    Vec3f& v = vectors[i];
    v = {v.x * factor, v.y * factor, v.z * factor};
  }
};

GuideShape shape_of(const Guide& guide, const ViewFrame& view, const EditInput& input) {
  GuideShape shape;
  shape.interval = interval_of(guide, input.field);
  const DepthRange depths = depth_range(view, input.base_box, shape.interval);
  shape.first_depth = depths.first;
  shape.last_depth = depths.last;
  for (const Pixel& pixel : guide.stroke) shape.stroke.push_back(to_plane(guide.camera, pixel));
  return shape;
}

/// The sides of an area's polygons.
std::vector<PlaneEdge> edges_of(const Camera& camera, const Area& area) {
  std::vector<PlaneEdge> edges;
  for (const std::vector<Pixel>& polygon : area)
    for (std::size_t i = 0; i < polygon.size(); ++i)
      edges.push_back({to_plane(camera, polygon[i]), to_plane(camera, polygon[i + 1 < polygon.size() ? i + 1 : 0])});
  return edges;
}

template <exec::Space Exec>
Change find(Exec& ex, const EditInput& input, const Guide& guide) {
  const ViewFrame view = frame_of(guide.camera, input.origin);
  GuideShape shape = shape_of(guide, view, input);
  if (guide.stroke.empty()) shape.edges = edges_of(guide.camera, guide.area);
  if (!(shape.last_depth >= shape.first_depth)) return {};  // all of the cloud is behind the eye
  const FieldData& field = input.field;
  const KeepInside keep{field.view(input.options.domain_faces), field.frame, guide.inside_only};
  const bool by_stroke = guide.normals == GuideNormals::stroke;
  GuidePoints points = guide_points(ex, view, shape, keep, by_stroke);
  const std::int64_t added = points.positions.size();
  if (added == 0) return {};
  if (!by_stroke) {
    const FieldSamples& samples = field.samples;
    auto counts = exec::make_buffer<std::uint8_t>(ex, samples.added.size());
    for_each(ex, "guide.count", counts.size(), IsKindOtherThan{samples.added.cview(), kGuide, counts.view()});
    points.normals =
        interpolate_normals(ex, {field.tree.view(), samples.positions.cview(), samples.normals.cview(), counts.cview()},
                            field.frame, points.positions.cview());
  }
  if (input.normal_length != 1)
    for_each(ex, "guide.length", added, Scale{points.normals.view(), static_cast<float>(input.normal_length)});
  Change change;
  change.added = {std::move(points.positions), std::move(points.normals)};
  change.kind = kGuide;
  return change;
}

/// An area in the view of a camera that looks at points relative to `origin`.
struct AreaInView {
  const Camera& camera;
  const Area& area;
  Vec3d origin;
};

/// Indices of the points that the view shows in the area, ascending.
/// @param candidates  as points_in
template <exec::Space Exec>
exec::Buffer<std::int32_t> shown_in(Exec& ex, const AreaInView& lasso, const PointBuffers& points,
                                    ArrayView<const std::uint8_t> candidates) {
  const std::vector<PlaneEdge> edges = edges_of(lasso.camera, lasso.area);
  auto on_device = exec::make_buffer<PlaneEdge>(ex, static_cast<std::int64_t>(edges.size()));
  copy_to_device(ex, edges.data(), on_device.view());
  return points_in(ex, frame_of(lasso.camera, lasso.origin), {on_device.cview()}, points.positions.cview(), candidates);
}

/// The points that a removal or a flip is about.
/// @param candidates  as points_in
template <exec::Space Exec, class Chooser>
exec::Buffer<std::int32_t> chosen_by(Exec& ex, const EditInput& input, const Chooser& chooser,
                                     ArrayView<const std::uint8_t> candidates) {
  exec::Buffer<std::int32_t> chosen =
      shown_in(ex, {chooser.camera, chooser.area, input.origin}, input.points, candidates);
  if (!chooser.front_layer || chosen.empty()) return chosen;
  // Points whose normals are to be turned have made the surface bulge before them.
  constexpr bool kTurns = std::is_same_v<Chooser, Flip>;
  const Screen screen{input.field.view(input.options.domain_faces), input.field.frame, kTurns};
  return not_hidden(ex, frame_of(chooser.camera, input.origin), screen, input.points.positions.cview(), chosen.cview());
}

template <exec::Space Exec>
Change find(Exec& ex, const EditInput& input, const Remove& remove) {
  static_assert(kOriginal == 0);  // so that the kinds tell what was added
  Change change;
  change.removed =
      chosen_by(ex, input, remove, remove.originals ? ArrayView<const std::uint8_t>() : input.points.added.cview());
  return change;
}

template <exec::Space Exec>
Change find(Exec& ex, const EditInput& input, const Flip& flip) {
  Change change;
  change.flipped = chosen_by(ex, input, flip, {});
  return change;
}

/// From the part's coordinates, relative to its origin, to those of the cloud, relative to `origin`.
Placement placement_of(const Insert& insert, const Vec3d& origin) {
  Placement placement;
  const Similarity& s = insert.placement;
  for (std::size_t i = 0; i < 9; ++i) {
    placement.turn[i] = s.rotation[i];
    placement.matrix[i] = s.scale * s.rotation[i];
  }
  for (std::size_t r = 0; r < 3; ++r) {
    placement.shift[r] = s.translation[r] - origin[r];
    for (std::size_t c = 0; c < 3; ++c) placement.shift[r] += placement.matrix[3 * r + c] * insert.part->origin[c];
  }
  return placement;
}

struct IsInBox {
  double lower[3], upper[3];  // relative to the part's origin
  ArrayView<const Vec3f> positions;
  PSK_HD bool operator()(std::int64_t i) const {
    const Vec3f p = positions[i];
    return p.x >= lower[0] && p.y >= lower[1] && p.z >= lower[2] && p.x <= upper[0] && p.y <= upper[1] &&
           p.z <= upper[2];
  }
};

/// The part's points that its view shows in the area.
template <exec::Space Exec>
PointBuffers in_view(Exec& ex, const Insert& insert, PointBuffers part) {
  const exec::Buffer<std::int32_t> kept = shown_in(ex, {insert.camera, insert.area, insert.part->origin}, part, {});
  if (kept.empty()) throw Error(ErrorCode::usage, "the view of the inserted part shows none of its points in the area");
  return choose(ex, part, kept.cview());
}

/// The points of the part that are to be copied, in its own coordinates.
template <exec::Space Exec>
PointBuffers upload_part(Exec& ex, const Insert& insert, const EditInput& input) {
  PointBuffers part = detail::upload(ex, *insert.part);
  if (!input.points.attributes.empty()) part.attributes = detail::upload_attributes(ex, *insert.part);
  IsInBox in_box{{}, {}, part.positions.cview()};
  for (std::size_t a = 0; a < 3; ++a) {
    in_box.lower[a] = insert.lower[a] - insert.part->origin[a];
    in_box.upper[a] = insert.upper[a] - insert.part->origin[a];
  }
  const exec::Buffer<std::int32_t> kept = select(ex, "insert.box", part.positions.size(), in_box);
  if (kept.empty()) throw Error(ErrorCode::usage, "the box of the inserted part holds none of its points");
  if (kept.size() < part.positions.size()) part = choose(ex, part, kept.cview());
  return insert.area.empty() ? std::move(part) : in_view(ex, insert, std::move(part));
}

template <exec::Space Exec>
Change find(Exec& ex, const EditInput& input, const Insert& insert) {
  PointBuffers part = upload_part(ex, insert, input);
  place(ex, placement_of(insert, input.origin), part.positions.view(), part.normals.view());
  Change change;
  if (insert.snap) {
    const FieldData& field = input.field;
    const exec::Buffer<std::int32_t> ids = exec::iota(ex, field.samples.positions.size());
    const SnapTarget target{
        {field.tree.view(), field.samples.positions.cview(), ids.cview()}, field.samples.normals.cview(), field.frame};
    const auto motion = find_snap(ex, target, part.positions.cview(), part.normals.cview());
    change.snapped = motion.has_value();
    if (motion) place(ex, *motion, part.positions.view(), part.normals.view());
  }
  change.added = std::move(part);
  change.kind = kInserted;
  return change;
}

}  // namespace

template <exec::Space Exec>
Change find_change(Exec& ex, const EditInput& input, const Operation& operation) {
  return std::visit([&](const auto& kind) { return find(ex, input, kind); }, operation);
}

PSK_INSTANTIATE(find_change);

}  // namespace pointskin::edit
