#include "edit/points.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <limits>

#include "edit/choice.hpp"
#include "exec/this_space.hpp"

namespace pointskin::edit {
namespace {

using detail::AttributeBuffer;
using detail::PointBuffers;

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

/// Both as values of their common type.
template <exec::Space Exec>
exec::TypedBuffer promoted_and_joined(Exec& ex, const exec::TypedBuffer& first, const exec::TypedBuffer& second) {
  if (first.type == second.type) return exec::join_typed(ex, first, second);
  AttributeValues values = exec::download_typed(ex, exec::copy_typed(ex, first));
  values.append(exec::download_typed(ex, exec::copy_typed(ex, second)));
  return exec::upload_typed(ex, values);
}

/// New points behind those that are there. Attributes that they lack have no value there.
/// @param added  may have attributes of other names
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

struct Turn {
  ArrayView<const std::int32_t> chosen;
  ArrayView<Vec3f> normals;
  PSK_HD void operator()(std::int64_t i) const {
    Vec3f& n = normals[chosen[i]];
    n = {-n.x, -n.y, -n.z};
  }
};

template <exec::Space Exec>
PointBuffers without(Exec& ex, const PointBuffers& points, ArrayView<const std::int32_t> removed) {
  const exec::Buffer<std::int32_t> kept = all_but(ex, points.positions.size(), removed);
  if (kept.empty()) throw Error(ErrorCode::empty_result, "the operation would remove all points");
  return choose(ex, points, kept.cview());
}

}  // namespace

template <exec::Space Exec>
PointBuffers choose(Exec& ex, const PointBuffers& points, ArrayView<const std::int32_t> indices) {
  PointBuffers out{chosen(ex, points.positions, indices), chosen(ex, points.normals, indices)};
  for (const AttributeBuffer& attribute : points.attributes)
    out.attributes.push_back({attribute.name, exec::gather_typed(ex, attribute.values.view(), indices)});
  out.added = chosen(ex, points.added, indices);
  return out;
}

template <exec::Space Exec>
PointBuffers copy_used(Exec& ex, const PointBuffers& points) {
  const exec::Buffer<std::int32_t> all =
      points.used.empty() ? exec::iota(ex, points.positions.size()) : exec::Buffer<std::int32_t>();
  return choose(ex, points, points.used.empty() ? all.cview() : points.used.cview());
}

template <exec::Space Exec>
void turn_normals(Exec& ex, ArrayView<const std::int32_t> chosen, ArrayView<Vec3f> normals) {
  for_each(ex, "flip.turn", chosen.size, Turn{chosen, normals});
}

template <exec::Space Exec>
PointBuffers changed_points(Exec& ex, const PointBuffers& points, const Change& change) {
  if (!change.removed.empty()) return without(ex, points, change.removed.cview());
  if (change.flipped.empty()) return append(ex, points, change.added, change.kind);
  PointBuffers turned = copy_used(ex, points);
  turn_normals(ex, change.flipped.cview(), turned.normals.view());
  return turned;
}

PSK_INSTANTIATE(choose);
PSK_INSTANTIATE(copy_used);
PSK_INSTANTIATE(turn_normals);
PSK_INSTANTIATE(changed_points);

}  // namespace pointskin::edit
