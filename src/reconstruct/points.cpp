#include "reconstruct/points.hpp"

#include <pointskin/error.hpp>

#include <limits>
#include <string>
#include <type_traits>
#include <utility>
#include <vector>

#include "exec/host_array.hpp"
#include "exec/this_space.hpp"
#include "octree/extent.hpp"
#include "octree/octree_data.hpp"
#include "reconstruct/point_hash.hpp"

namespace pointskin::detail {
namespace {

struct ToWorld {
  octree::Frame frame;
  ArrayView<Vec3f> positions;
  PSK_HD void operator()(std::int64_t i) const { positions[i] = frame.to_world(positions[i]); }
};

struct Turn {
  ArrayView<const Vec3f> normals;
  ArrayView<Vec3f> turned;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f n = normals[i];
    turned[i] = {-n.x, -n.y, -n.z};
  }
};

/// A point's place in the unit cube, and its hash.
struct UnitAndHash {
  octree::ToUnit unit;
  HashPoint hash;
  PSK_HD void operator()(std::int64_t i) const {
    unit(i);
    hash(i);
  }
};

/// What may be wrong with points.
struct Flaws {
  std::int64_t not_finite = 0;
  std::int64_t with_normal = 0;  // normals that are not zero
};
struct FindFlaws {
  ArrayView<const Vec3f> positions, normals;
  octree::Selection selection{};

  PSK_HD Flaws operator()(std::int64_t i) const {
    const std::int64_t from = selection(i);
    const Vec3f n = normals.empty() ? Vec3f{} : normals[from];
    return {is_finite(positions[from]) && is_finite(n) ? 0 : 1, n.x != 0 || n.y != 0 || n.z != 0 ? 1 : 0};
  }
};
struct AddFlaws {
  static constexpr bool kAnyOrder = true;
  PSK_HD Flaws operator()(const Flaws& a, const Flaws& b) const {
    return {a.not_finite + b.not_finite, a.with_normal + b.with_normal};
  }
};

/// What one look at all points tells.
struct FirstLook {
  octree::Extent extent;
  Flaws flaws;
};
struct JoinLooks {
  static constexpr bool kAnyOrder = true;
  PSK_HD FirstLook operator()(const FirstLook& a, const FirstLook& b) const {
    return {octree::JoinExtents{}(a.extent, b.extent), AddFlaws{}(a.flaws, b.flaws)};
  }
};

/// The points of a lane of exec/reduce_order.hpp.
struct LookAtLane {
  struct Part {
    Bounds box;
    Flaws flaws;
  };
  struct Join {
    PSK_HD Part operator()(const Part& a, const Part& b) const {
      return {octree::JoinBoxes{}(a.box, b.box), AddFlaws{}(a.flaws, b.flaws)};
    }
  };
  struct Point {
    octree::BoxOf box;
    FindFlaws flaws;
    PSK_HD Part operator()(std::int64_t i) const { return {box(i), flaws(i)}; }
  };

  ArrayView<const Vec3f> positions, normals;
  std::int64_t lanes;
  ArrayView<FirstLook> out;
  PSK_HD void operator()(std::int64_t lane) const {
    const Point point{{positions}, {positions, normals}};
    const Part part = exec::combine_lane(point, Join{}, positions.size, lanes, lane);
    out[lane] = {octree::extent_of_lane(part.box), part.flaws};
  }
};

/// Extent and flaws of all points. Waits.
template <exec::Space Exec>
FirstLook look_at_points(Exec& ex, const PointBuffers& points) {
  const std::int64_t lanes = exec::reduce_lanes(points.positions.size());
  auto seen = exec::make_buffer<FirstLook>(ex, lanes);
  for_each_long(ex, "upload.check", lanes,
                LookAtLane{points.positions.cview(), points.normals.cview(), lanes, seen.view()});
  return exec::read_element(ex, exec::reduce_lane_values(ex, "upload.check", std::move(seen), JoinLooks{}).cview(), 0);
}

/// Flaws of the points to use. Waits.
template <exec::Space Exec>
Flaws find_flaws(Exec& ex, const PointBuffers& points) {
  return exec::reduce<Flaws>(ex, "upload.check", points.used_count(),
                             FindFlaws{points.positions.cview(), points.normals.cview(), {points.used.cview()}},
                             AddFlaws{});
}

void require_finite(const Flaws& flaws) {
  if (flaws.not_finite > 0)
    throw Error(
        ErrorCode::invalid_input,
        std::to_string(flaws.not_finite) + " points have coordinates or normals that are not finite; leave them out");
}

/// The attributes in the order of the samples, but for those that no sample has a value of.
/// @param order  index of the caller's point of every sample
template <exec::Space Exec>
field::AttributeSamples sort_attributes(Exec& ex, const PointBuffers& points, ArrayView<const std::int32_t> order) {
  field::AttributeSamples sorted;
  for (const AttributeBuffer& attribute : points.attributes) {
    const TypedView values = attribute.values.view();
    const bool is_label = attribute.is_label();
    field::ValueRange range;
    if (!is_label || values.missing != nullptr) {
      range = field::find_range(ex, values, points.used.cview());
      if (range.counted == 0) {
        sorted.without_values.push_back(attribute.name);
        continue;
      }
    }
    const std::size_t place = sorted.names.size();
    sorted.names.push_back(attribute.name);
    if (is_label)
      sorted.labels.push_back({place, exec::gather_typed(ex, values, order)});
    else
      sorted.channels.push_back(field::make_channel(ex, place, values, range, order));
  }
  return sorted;
}

void require_normals(const Flaws& flaws) {
  if (flaws.with_normal == 0)
    throw Error(ErrorCode::no_normals, "all normals have zero length; a surface needs oriented points");
}

void require_points(const Input& input) {
  if (input.size() == 0) throw Error(ErrorCode::empty_result, "the cloud has no points; nothing to reconstruct");
  if (input.size() > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "the cloud has more than 2^31 - 1 points; thin it or split it");
}

template <exec::Space Exec>
exec::Buffer<Vec3f> copied(Exec& ex, const std::vector<Vec3f>& from) {
  auto to = exec::make_buffer<Vec3f>(ex, static_cast<std::int64_t>(from.size()));
  copy_to_device(ex, from.data(), to.view());
  return to;
}

/// Positions and, if they have them, normals, as they came.
template <exec::Space Exec>
PointBuffers taken(Exec& ex, const Input& input) {
  PointBuffers points;
  if (const DevicePoints* const given = input.points()) {
    points.positions = borrowed(given->positions);
    if (input.has_normals()) points.normals = borrowed(given->normals);
  } else {
    points.positions = copied(ex, input.cloud()->positions);
    if (input.has_normals()) points.normals = copied(ex, input.cloud()->normals);
  }
  return points;
}

/// All normals the other way round, in memory of their own.
template <exec::Space Exec>
exec::Buffer<Vec3f> turned(Exec& ex, const exec::Buffer<Vec3f>& normals) {
  auto out = exec::make_buffer<Vec3f>(ex, normals.size());
  for_each(ex, "upload.turn", normals.size(), Turn{normals.cview(), out.view()});
  return out;
}

void require_length(const std::string& name, std::int64_t length, std::int64_t points, const char* what) {
  if (length != points)
    throw Error(ErrorCode::invalid_input, "the attribute " + name + " has " + std::to_string(length) + " values for " +
                                              std::to_string(points) + " " + what);
}

}  // namespace

template <exec::Space Exec>
PointBuffers upload_some(Exec& ex, const Input& input) {
  require_points(input);
  PointBuffers points = taken(ex, input);
  require_finite(find_flaws(ex, points));
  return points;
}

template <exec::Space Exec>
PointBuffers upload(Exec& ex, const Input& input, octree::Extent* extent) {
  require_points(input);
  if (!input.has_normals())
    throw Error(ErrorCode::no_normals, "the points have no normals; a surface needs oriented points");
  PointBuffers points = taken(ex, input);
  const FirstLook seen = look_at_points(ex, points);
  require_finite(seen.flaws);
  require_normals(seen.flaws);
  if (extent != nullptr) *extent = seen.extent;
  if (input.turned()) points.normals = turned(ex, points.normals);
  return points;
}

template <exec::Space Exec>
std::vector<AttributeBuffer> upload_attributes(Exec& ex, const Input& input, const char* what) {
  std::vector<AttributeBuffer> attributes;
  if (const DevicePoints* const given = input.points()) {
    for (const DeviceAttribute& from : given->attributes)
      attributes.push_back({from.name, borrowed(from, input.size())});
    return attributes;
  }
  for (const Attribute& from : input.cloud()->attributes) {
    require_length(from.name, static_cast<std::int64_t>(from.values.size()), input.size(), what);
    attributes.push_back({from.name, exec::upload_typed(ex, from.values)});
  }
  return attributes;
}

template <exec::Space Exec>
PointBuffers copy_points(Exec& ex, const Cloud& cloud) {
  PointBuffers points = taken(ex, cloud);
  points.attributes = upload_attributes(ex, cloud, "points");
  return points;
}

template <exec::Space Exec>
Cloud download_points(Exec& ex, const DevicePoints& points) {
  Cloud cloud;
  cloud.origin = points.origin;
  const auto fetch = [&](const DeviceSpan<const Vec3f>& from, std::vector<Vec3f>& to) {
    exec::resize_to_overwrite(to, static_cast<std::size_t>(from.size));
    copy_to_host(ex, ArrayView<const Vec3f>{from.data, from.size}, to.data());
  };
  fetch(points.positions, cloud.positions);
  fetch(points.normals, cloud.normals);
  for (const DeviceAttribute& from : points.attributes)
    cloud.attributes.push_back({from.name, exec::download_typed(ex, borrowed(from, points.positions.size))});
  return cloud;
}

template <exec::Space Exec>
void leave_out(Exec& ex, const octree::StrayPoints& strays, PointBuffers& points) {
  if (strays.indices.empty()) return;
  points.used = octree::without_strays(ex, points.positions.size(), strays);
  if (!points.normals.empty()) require_normals(find_flaws(ex, points));
}

template <exec::Space Exec>
SortedSamples sort_into_cube(Exec& ex, const PointBuffers& points, const octree::Frame& frame) {
  const std::int64_t n = points.used_count();
  const octree::Selection selection{points.used.cview()};
  auto unit = exec::make_buffer<Vec3f>(ex, n);
  auto hashes = exec::make_buffer<std::uint64_t>(ex, n);
  for_each(ex, "octree.unit", n,
           UnitAndHash{{frame, points.positions.cview(), unit.view(), selection},
                       {points.positions.cview(), points.normals.cview(), hashes.view(), selection}});
  for (const AttributeBuffer& attribute : points.attributes)
    for_each(ex, "octree.hash", n, HashAttribute{attribute.values.view(), hashes.view(), selection});
  SortedSamples out;
  poisson::Samples& samples = out.samples;
  octree::SortedPoints sorted =
      octree::sort_points(ex, unit.cview(), hashes.cview(), [&](const octree::SortedPoints& in_order) {
        samples.positions = exec::make_buffer<Vec3f>(ex, n);
        exec::gather(ex, unit.cview(), in_order.order.cview(), samples.positions.view());
      });
  hashes.reset();
  unit.reset();
  if (!points.used.empty())  // from here on, the order leads to the caller's points
    exec::gather(ex, points.used.cview(), sorted.order.cview(), sorted.order.view());
  if (!points.normals.empty()) {
    samples.normals = exec::make_buffer<Vec3f>(ex, n);
    exec::gather(ex, points.normals.cview(), sorted.order.cview(), samples.normals.view());
  }
  if (!points.added.empty()) {
    out.added = exec::make_buffer<std::uint8_t>(ex, n);
    exec::gather(ex, points.added.cview(), sorted.order.cview(), out.added.view());
  }
  out.keys = std::move(sorted.keys);
  out.attributes = sort_attributes(ex, points, sorted.order.cview());
  return out;
}

template <exec::Space Exec>
void to_world(Exec& ex, const octree::Frame& frame, ArrayView<Vec3f> positions) {
  for_each(ex, "download.world", positions.size, ToWorld{frame, positions});
}

template <exec::Space Exec>
void download(Exec& ex, surface::Surface surface, const octree::Frame& frame, const Vec3d& origin, Mesh& mesh) {
  to_world(ex, frame, surface.positions.view());
  mesh.origin = origin;
  mesh.attributes.clear();
  download_array(ex, surface.positions, mesh.vertices);
  download_array(ex, surface.normals, mesh.normals);
  download_array(ex, surface.triangles, mesh.triangles);
}

PSK_INSTANTIATE(upload_some);
PSK_INSTANTIATE(upload);
PSK_INSTANTIATE(upload_attributes);
PSK_INSTANTIATE(leave_out);
PSK_INSTANTIATE(sort_into_cube);
PSK_INSTANTIATE(to_world);
PSK_INSTANTIATE(download);
PSK_INSTANTIATE(copy_points);
PSK_INSTANTIATE(download_points);

}  // namespace pointskin::detail
