#include "edit/base.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstdint>
#include <utility>
#include <vector>

#include "edit/point_kind.hpp"
#include "edit/points.hpp"
#include "exec/this_space.hpp"
#include "poisson/mean_length.hpp"
#include "reconstruct/fit_cube.hpp"

namespace pointskin::edit {
namespace {

using detail::PointBuffers;

/// The kinds that the cloud itself tells.
const std::vector<std::uint8_t>& kinds_of(const Cloud& cloud) {
  const auto found = std::find_if(cloud.attributes.begin(), cloud.attributes.end(),
                                  [](const Attribute& attribute) { return attribute.name == kKinds; });
  if (found == cloud.attributes.end() || found->type() != AttributeType::uint8 || found->values.has_mask() ||
      found->values.size() != cloud.positions.size())
    throw Error(ErrorCode::invalid_input,
                "a session is continued from a cloud with a value \"added\" (uint8) at every point");
  const auto& kinds = found->values.as<std::uint8_t>();
  if (std::any_of(kinds.begin(), kinds.end(), [](std::uint8_t kind) { return kind > kInserted; }))
    throw Error(ErrorCode::invalid_input, "the values of \"added\" must be 0, 1 or 2");
  if (std::find(kinds.begin(), kinds.end(), kOriginal) == kinds.end())
    throw Error(ErrorCode::invalid_input, "none of the points is an original one by its value of \"added\"");
  return kinds;
}

template <exec::Space Exec>
PointBuffers upload_base(Exec& ex, const Cloud& base, const EditOptions& options) {
  PointBuffers points = detail::upload(ex, base);
  if (options.reconstruction.attributes || options.keep_attributes)
    points.attributes = detail::upload_attributes(ex, base);
  points.added = exec::make_buffer<std::uint8_t>(ex, points.positions.size());
  if (!options.continued) {
    exec::fill(ex, points.added.view(), kOriginal);
    return points;
  }
  copy_to_device(ex, kinds_of(base).data(), points.added.view());
  std::erase_if(points.attributes, [](const detail::AttributeBuffer& attribute) { return attribute.name == kKinds; });
  return points;
}

struct IsOriginal {
  ArrayView<const std::uint8_t> added;
  PSK_HD bool operator()(std::int64_t i) const { return added[i] == kOriginal; }
};

/// Box and normals of the original points; of all, if every original one was a stray.
template <exec::Space Exec>
void measure_originals(Exec& ex, const Options& options, BaseFit& fit) {
  const PointBuffers& points = fit.points;
  const exec::Buffer<std::int32_t> originals =
      select(ex, "edit.originals", points.added.size(), IsOriginal{points.added.cview()});
  const bool all = originals.empty() || originals.size() == points.added.size();
  const PointBuffers some = all ? PointBuffers() : choose(ex, points, originals.cview());
  const PointBuffers& measured = all ? points : some;
  fit.box = octree::box_around(ex, measured.positions.cview());
  if (options.confidence) fit.normal_length = poisson::mean_length(ex, measured.normals.cview());
}

bool has_extent(const Bounds& box) {
  return box.lower.x < box.upper.x || box.lower.y < box.upper.y || box.lower.z < box.upper.z;
}

}  // namespace

template <exec::Space Exec>
BaseFit fit_base(Exec& ex, const Cloud& base, const EditOptions& options,
                 const std::shared_ptr<const envelope::Envelope>& envelope) {
  const Options& reconstruction = options.reconstruction;
  RunReport unused;
  BaseFit fit{upload_base(ex, base, options), {}, {}, 1};
  octree::Frame cube = fit_cube(ex, fit.points, reconstruction, unused);
  if (!fit.points.used.empty()) fit.points = copy_used(ex, fit.points);  // strays are gone for good
  measure_originals(ex, reconstruction, fit);
  if (options.continued && has_extent(fit.box))
    cube = cube_for(ex, octree::frame_around(fit.box, reconstruction.scale), fit.points, reconstruction.scale);
  fit.field = fit_field(ex, fit.points, {.keep_points = true, .cube = cube, .envelope = envelope, .keep_samples = true},
                        reconstruction, unused);
  return fit;
}

template <exec::Space Exec>
octree::Frame cube_for(Exec& ex, const octree::Frame& before, const PointBuffers& points, double scale) {
  const Bounds box = octree::box_around(ex, points.positions.cview());
  const auto margin = static_cast<float>((1 - 1 / scale) / 4);  // half of what is left around a cube of its own
  const Vec3f lower = before.to_unit(box.lower);
  const Vec3f upper = before.to_unit(box.upper);
  const bool inside = lower.x >= margin && lower.y >= margin && lower.z >= margin && upper.x <= 1 - margin &&
                      upper.y <= 1 - margin && upper.z <= 1 - margin;
  return inside ? before : octree::frame_around(box, scale);
}

PSK_INSTANTIATE(fit_base);
PSK_INSTANTIATE(cube_for);

}  // namespace pointskin::edit
