#include "edit/points.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <limits>
#include <utility>
#include <variant>

#include "edit/guide.hpp"
#include "edit/normals_around.hpp"
#include "edit/placement.hpp"
#include "edit/point_kind.hpp"
#include "edit/view_frame.hpp"
#include "exec/this_space.hpp"

namespace pointskin::edit {
namespace {

using detail::AttributeBuffer;
using detail::FieldData;
using detail::FieldSamples;
using detail::PointBuffers;

/// 1 for points that say something of normals, and for those that may be removed.
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

template <class T, exec::Space Exec>
exec::Buffer<T> joined(Exec& ex, ArrayView<const T> first, ArrayView<const T> second) {
  auto both = exec::make_buffer<T>(ex, first.size + second.size);
  copy(ex, first, both.view().part(0, first.size));
  copy(ex, second, both.view().part(first.size, second.size));
  return both;
}

template <class T, exec::Space Exec>
exec::Buffer<T> chosen(Exec& ex, const exec::Buffer<T>& from, ArrayView<const std::int32_t> indices) {
  auto out = exec::make_buffer<T>(ex, from.empty() ? 0 : indices.size);
  if (!from.empty()) exec::gather(ex, from.cview(), indices, out.view());
  return out;
}

/// The points of these indices.
template <exec::Space Exec>
PointBuffers choose(Exec& ex, const PointBuffers& points, ArrayView<const std::int32_t> indices) {
  PointBuffers out{chosen(ex, points.positions, indices), chosen(ex, points.normals, indices)};
  for (const AttributeBuffer& attribute : points.attributes)
    out.attributes.push_back({attribute.name, exec::gather_typed(ex, attribute.values.view(), indices)});
  out.added = chosen(ex, points.added, indices);
  return out;
}

/// Both as values of their common type.
template <exec::Space Exec>
exec::TypedBuffer promoted_and_joined(Exec& ex, const exec::TypedBuffer& first, const exec::TypedBuffer& second) {
  if (first.type == second.type) return exec::join_typed(ex, first, second);
  AttributeValues values = exec::download_typed(ex, exec::copy_typed(ex, first));
  values.append(exec::download_typed(ex, exec::copy_typed(ex, second)));
  return exec::upload_typed(ex, values);
}

/// New points behind those that are there. Attributes that they lack have no value there.
/// @param attributes  of the new points, may be of other names
template <exec::Space Exec>
PointBuffers append(Exec& ex, const PointBuffers& points, const PointBuffers& added, std::uint8_t kind) {
  const std::int64_t n = added.positions.size();
  if (points.positions.size() + n > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "the cloud would have more than 2^31 - 1 points");
  auto kinds = exec::make_buffer<std::uint8_t>(ex, n);
  exec::fill(ex, kinds.view(), kind);
  PointBuffers out{joined(ex, points.positions.cview(), added.positions.cview()),
                   joined(ex, points.normals.cview(), added.normals.cview())};
  out.added = joined(ex, points.added.cview(), kinds.cview());
  for (const AttributeBuffer& attribute : points.attributes) {
    const auto same = std::find_if(added.attributes.begin(), added.attributes.end(),
                                   [&](const AttributeBuffer& other) { return other.name == attribute.name; });
    out.attributes.push_back(
        {attribute.name, same == added.attributes.end()
                             ? exec::join_typed(ex, attribute.values, exec::make_missing(ex, attribute.values.type, n))
                             : promoted_and_joined(ex, attribute.values, same->values)});
  }
  return out;
}

GuideShape shape_of(const Guide& guide, const ViewFrame& view, const EditInput& input) {
  GuideShape shape;
  const double cell = input.field.frame.size / static_cast<double>(std::int64_t{1} << input.field.tree.depth);
  shape.interval = guide.interval > 0 ? guide.interval : cell;
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
EditedPoints apply(Exec& ex, const EditInput& input, const Guide& guide) {
  const ViewFrame view = frame_of(guide.camera, input.origin);
  GuideShape shape = shape_of(guide, view, input);
  if (guide.stroke.empty()) shape.edges = edges_of(guide.camera, guide.area);
  EditedPoints edited;
  if (!(shape.last_depth >= shape.first_depth)) return edited;  // all of the cloud is behind the eye
  const FieldData& field = input.field;
  const KeepInside keep{field.view(input.options.domain_faces), field.frame, guide.inside_only};
  const bool by_stroke = guide.normals == GuideNormals::stroke;
  GuidePoints points = guide_points(ex, view, shape, keep, by_stroke);
  edited.added = points.positions.size();
  if (edited.added == 0) return edited;
  if (!by_stroke) {
    const FieldSamples& samples = field.samples;
    auto counts = exec::make_buffer<std::uint8_t>(ex, samples.added.size());
    for_each(ex, "guide.count", counts.size(), IsKindOtherThan{samples.added.cview(), kGuide, counts.view()});
    points.normals =
        interpolate_normals(ex, {field.tree.view(), samples.positions.cview(), samples.normals.cview(), counts.cview()},
                            field.frame, points.positions.cview());
  }
  if (input.normal_length != 1)
    for_each(ex, "guide.length", edited.added, Scale{points.normals.view(), static_cast<float>(input.normal_length)});
  edited.points = append(ex, input.points, {std::move(points.positions), std::move(points.normals)}, kGuide);
  return edited;
}

template <exec::Space Exec>
EditedPoints apply(Exec& ex, const EditInput& input, const Remove& remove) {
  const std::vector<PlaneEdge> edges = edges_of(remove.camera, remove.area);
  auto on_device = exec::make_buffer<PlaneEdge>(ex, static_cast<std::int64_t>(edges.size()));
  copy_to_device(ex, edges.data(), on_device.view());
  const PointBuffers& points = input.points;
  exec::Buffer<std::uint8_t> all;
  if (remove.originals) {
    all = exec::make_buffer<std::uint8_t>(ex, points.positions.size());
    exec::fill(ex, all.view(), std::uint8_t{1});
  }
  static_assert(kOriginal == 0);  // so that the kinds tell what may be removed
  const exec::Buffer<std::int32_t> kept =
      points_not_in(ex, frame_of(remove.camera, input.origin), {on_device.cview()}, points.positions.cview(),
                    remove.originals ? all.cview() : points.added.cview());
  EditedPoints edited;
  edited.removed = points.positions.size() - kept.size();
  if (kept.empty()) throw Error(ErrorCode::empty_result, "the operation would remove all points");
  if (edited.removed > 0) edited.points = choose(ex, points, kept.cview());
  return edited;
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

/// The points of the part that are to be copied, in its own coordinates.
template <exec::Space Exec>
PointBuffers upload_part(Exec& ex, const Insert& insert, const Options& options) {
  PointBuffers part = detail::upload(ex, *insert.part);
  if (options.attributes) part.attributes = detail::upload_attributes(ex, *insert.part);
  IsInBox in_box{{}, {}, part.positions.cview()};
  for (std::size_t a = 0; a < 3; ++a) {
    in_box.lower[a] = insert.lower[a] - insert.part->origin[a];
    in_box.upper[a] = insert.upper[a] - insert.part->origin[a];
  }
  const exec::Buffer<std::int32_t> kept = select(ex, "insert.box", part.positions.size(), in_box);
  if (kept.empty()) throw Error(ErrorCode::usage, "the box of the inserted part holds none of its points");
  return kept.size() == part.positions.size() ? std::move(part) : choose(ex, part, kept.cview());
}

template <exec::Space Exec>
EditedPoints apply(Exec& ex, const EditInput& input, const Insert& insert) {
  PointBuffers part = upload_part(ex, insert, input.options);
  place(ex, placement_of(insert, input.origin), part.positions.view(), part.normals.view());
  EditedPoints edited;
  if (insert.snap) {
    const FieldData& field = input.field;
    const exec::Buffer<std::int32_t> ids = exec::iota(ex, field.samples.positions.size());
    const SnapTarget target{
        {field.tree.view(), field.samples.positions.cview(), ids.cview()}, field.samples.normals.cview(), field.frame};
    const auto motion = find_snap(ex, target, part.positions.cview(), part.normals.cview());
    edited.snapped = motion.has_value();
    if (motion) place(ex, *motion, part.positions.view(), part.normals.view());
  }
  edited.added = part.positions.size();
  edited.points = append(ex, input.points, part, kInserted);
  return edited;
}

}  // namespace

template <exec::Space Exec>
EditedPoints edit_points(Exec& ex, const EditInput& input, const Operation& operation) {
  return std::visit([&](const auto& kind) { return apply(ex, input, kind); }, operation);
}

template <exec::Space Exec>
PointBuffers copy_used(Exec& ex, const PointBuffers& points) {
  const exec::Buffer<std::int32_t> all =
      points.used.empty() ? exec::iota(ex, points.positions.size()) : exec::Buffer<std::int32_t>();
  return choose(ex, points, points.used.empty() ? all.cview() : points.used.cview());
}

PSK_INSTANTIATE(edit_points);
PSK_INSTANTIATE(copy_used);

}  // namespace pointskin::edit
