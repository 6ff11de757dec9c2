// Estimates of the memory that a run takes.
#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "exec/cpu_primitives.hpp"
#include "octree/frame.hpp"
#include "octree/keys.hpp"
#include "octree/strays.hpp"
#include "reconstruct/memory_model.hpp"

namespace pointskin {
namespace {

/// Point keys as the octree sorts them, without the bits below its finest cells.
struct CellKeyOfPoint {
  octree::Frame frame;
  ArrayView<const Vec3f> positions;
  int depth;
  ArrayView<std::uint64_t> keys;
  octree::Selection selection;
  void operator()(std::int64_t i) const {
    const Vec3f p = frame.to_unit(positions[selection(i)]);
    const int below = 3 * (octree::kPointBits - depth);
    keys[i] = octree::point_key(p.x, p.y, p.z) >> below << below;
  }
};

detail::AttributeBytes kept_attributes(const Cloud& cloud, const Options& options) {
  return detail::bytes_of(cloud.attributes, options.attributes);
}

ArrayView<const Vec3f> positions_of(const Cloud& cloud) { return {cloud.positions.data(), cloud.size()}; }

/// The points that count and their cube, as the run finds them.
struct Used {
  octree::Frame frame;
  std::int64_t strays = 0;
  exec::Buffer<std::int32_t> points;  // empty: all

  Used(exec::Cpu& ex, const Cloud& cloud, const Options& options) {
    if (options.keep_strays) {
      frame = octree::fit_frame(ex, positions_of(cloud), options.scale);
      return;
    }
    const octree::StrayPoints found = octree::find_strays(ex, positions_of(cloud));
    frame = octree::frame_around(found.core, options.scale);
    strays = found.size();
    points = octree::without_strays(ex, cloud.size(), found);
  }
};

/// Counts from the points themselves. 16 bytes a point and up to 5 a node.
detail::RunSize measure_run(exec::Cpu& ex, const Cloud& cloud, const Options& options) {
  const Used used(ex, cloud, options);
  auto keys = exec::make_buffer<std::uint64_t>(ex, cloud.size() - used.strays);
  for_each(ex, "estimate.keys", keys.size(),
           CellKeyOfPoint{used.frame, positions_of(cloud), options.depth, keys.view(), {used.points.cview()}});
  sort_keys(ex, "estimate.sort", keys, 3 * octree::kPointBits);
  return {keys.size(), octree::count_bricks(ex, keys.cview(), options.depth), used.strays,
          kept_attributes(cloud, options)};
}

constexpr double kBytesPerNode = 72;

/// A level's nodes cover a band around the surface, about 25 per face of its grid for common shapes; where points lie
/// apart, each has its own 27 bricks; and no level has more nodes than the whole grid.
double nodes_of_common_shapes(double points, int depth) {
  constexpr double kNodesPerFace = 25;
  constexpr double kNodesPerPoint = 27 * 8;
  double nodes = 0;
  for (int d = 0; d <= depth; ++d)
    nodes += std::max(std::min(std::pow(8.0, d), 1e4),
                      std::min({kNodesPerPoint * points, kNodesPerFace * std::pow(4.0, d), std::pow(8.0, d)}));
  return nodes;
}

/// A second octree, whose finest cells go all around the surface, is there beside the first one.
/// @param plain  without an offset
std::int64_t with_offset(std::int64_t plain, int depth) {
  constexpr double kBoth = 2.4;  // 2.3 at most for scans with samples in every finest cell
  const double sparse = kBytesPerNode * nodes_of_common_shapes(std::numeric_limits<double>::infinity(), depth);
  const double bytes = static_cast<double>(plain);
  return static_cast<std::int64_t>(std::max(kBoth * bytes, bytes + sparse));
}

}  // namespace

std::int64_t estimate_device_bytes(std::int64_t points, const Options& options) {
  constexpr double kBytesPerPoint = 120;
  constexpr double kBytesPerColour = 40;  // three attributes
  const double nodes = nodes_of_common_shapes(static_cast<double>(points), options.depth);
  const double per_point = kBytesPerPoint + (options.attributes ? kBytesPerColour : 0);
  const auto plain = static_cast<std::int64_t>(kBytesPerNode * nodes + per_point * static_cast<double>(points));
  return options.offset == 0 ? plain : with_offset(plain, options.depth);
}

std::int64_t estimate_device_bytes(const Cloud& cloud, const Options& options, int threads) {
  validate(options);
  if (options.point_normals == PointNormals::repair || options.point_normals == PointNormals::estimate) {
    Options oriented = options;
    oriented.point_normals = PointNormals::given;
    return std::max(estimate_device_bytes(cloud, oriented, threads), estimate_normals_device_bytes(cloud, threads));
  }
  if (options.depth == Options::kAutomaticDepth) {
    Options settled = options;
    settled.depth = suggest_depth(cloud, options, Device::cpu(threads)).depth;
    return estimate_device_bytes(cloud, settled, threads);
  }
  exec::Cpu ex(threads);
  // What counting takes, a run takes as well.
  ex.pool()->set_limit(options.max_memory_bytes);
  detail::RunSize size;
  try {
    size = measure_run(ex, cloud, options);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::over_limit && options.max_memory_bytes > 0)
      throw error.while_doing("the cells of the octree were counted; choose a smaller depth or allow more");
    if (error.code() != ErrorCode::empty_result) throw;
    return detail::uploaded_bytes(cloud.size(), kept_attributes(cloud, options));  // the run ends here, too
  }
  const std::vector<detail::PhaseBytes> phases = detail::model_memory(size, options);
  const std::int64_t plain = std::max_element(phases.begin(), phases.end(), [](const auto& a, const auto& b) {
                               return a.bytes < b.bytes;
                             })->bytes;
  constexpr std::int64_t kScratch = 8192;  // sums and counts on the way
  return kScratch + (options.offset == 0 ? plain : with_offset(plain, options.depth));
}

}  // namespace pointskin
