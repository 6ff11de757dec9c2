#include "octree/public_octree.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>
#include <utility>

#include "exec/this_space.hpp"
#include "octree/access.hpp"

namespace pointskin::octree {
namespace {

/// The tie break of a public tree: points with equal keys keep the caller's order.
struct ById {
  ArrayView<std::uint64_t> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = static_cast<std::uint64_t>(i); }
};

struct Locate {
  OctreeView tree;
  ArrayView<const Vec3f> queries;
  ArrayView<OctreeLeaf> out;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f q = queries[i];
    const Leaf leaf = locate(tree, point_key(q.x, q.y, q.z), tree.depth);
    out[i] = {leaf.depth, leaf.cell};
  }
};

template <exec::Space Exec>
exec::Buffer<Vec3f> upload(Exec& ex, std::span<const Vec3f> points) {
  auto buffer = exec::make_buffer<Vec3f>(ex, static_cast<std::int64_t>(points.size()));
  copy_to_device(ex, points.data(), buffer.view());
  return buffer;
}

template <exec::Space Exec>
exec::Buffer<Vec3f> to_unit(Exec& ex, const Frame& frame, const exec::Buffer<Vec3f>& world) {
  auto unit = exec::make_buffer<Vec3f>(ex, world.size());
  for_each(ex, "octree.unit", world.size(), ToUnit{frame, world.cview(), unit.view()});
  return unit;
}

template <exec::Space Exec>
std::vector<float> distances_world(Exec& ex, const BuiltOctree& tree, const exec::Buffer<float>& squared) {
  std::vector<float> distances = exec::to_vector(ex, squared);
  for (float& d : distances) d = static_cast<float>(std::sqrt(static_cast<double>(d)) * tree.frame.size);
  return distances;
}

}  // namespace

template <exec::Space Exec>
BuiltOctree build_of_points(Exec& ex, std::span<const Vec3f> positions, const OctreeOptions& options) {
  if (positions.size() > std::size_t{std::numeric_limits<std::int32_t>::max()})
    throw Error(ErrorCode::over_limit, "the cloud has more than 2^31 - 1 points; thin it or split it");
  BuiltOctree tree;
  const exec::Buffer<Vec3f> world = upload(ex, positions);
  tree.frame = fit_frame(ex, world.cview(), options.scale);
  const exec::Buffer<Vec3f> unit = to_unit(ex, tree.frame, world);
  auto ties = exec::make_buffer<std::uint64_t>(ex, unit.size());
  for_each(ex, "octree.ties", ties.size(), ById{ties.view()});
  SortedPoints sorted = sort_points(ex, unit.cview(), ties.cview());
  tree.data = build_octree(ex, sorted.keys.cview(), options.depth);
  tree.order = std::move(sorted.order);
  tree.positions = exec::make_buffer<Vec3f>(ex, unit.size());
  exec::gather(ex, unit.cview(), tree.order.cview(), tree.positions.view());
  return tree;
}

template <exec::Space Exec>
std::vector<std::int32_t> point_order(Exec& ex, const BuiltOctree& tree) {
  return exec::to_vector(ex, tree.order);
}

template <exec::Space Exec>
OctreeLevel level_of(Exec& ex, const BuiltOctree& tree, int depth) {
  const LevelData& data = tree.data.levels[static_cast<std::size_t>(depth)];
  OctreeLevel level;
  level.depth = depth;
  level.cells = tree.data.view().levels[depth].cells();
  level.nodes = std::int64_t{8} * data.bricks;
  level.brick_keys = exec::to_vector(ex, data.brick_key);
  level.parents = exec::to_vector(ex, data.parent);
  level.neighbours = exec::to_vector(ex, data.neighbours);
  level.child_bricks = exec::to_vector(ex, data.child_brick);
  level.child_bricks.resize(static_cast<std::size_t>(level.nodes), -1);  // the finest level has none
  level.point_begin = exec::to_vector(ex, data.point_begin);
  level.point_begin.resize(static_cast<std::size_t>(level.cells) + 1);
  return level;
}

template <exec::Space Exec>
std::vector<OctreeLeaf> locate_all(Exec& ex, const BuiltOctree& tree, std::span<const Vec3f> queries) {
  const exec::Buffer<Vec3f> unit = to_unit(ex, tree.frame, upload(ex, queries));
  auto leaves = exec::make_buffer<OctreeLeaf>(ex, unit.size());
  for_each(ex, "octree.locate", unit.size(), Locate{tree.data.view(), unit.cview(), leaves.view()});
  return exec::to_vector(ex, leaves);
}

template <exec::Space Exec>
OctreeNeighbours nearest(Exec& ex, const BuiltOctree& tree, std::span<const Vec3f> queries, int k) {
  const exec::Buffer<Vec3f> unit = to_unit(ex, tree.frame, upload(ex, queries));
  const auto found = static_cast<int>(std::min<std::int64_t>(k, tree.positions.size()));
  auto ids = exec::make_buffer<std::int32_t>(ex, unit.size() * found);
  auto squared = exec::make_buffer<float>(ex, unit.size() * found);
  find_nearest(ex, tree.search_view(), unit.cview(), found, ids.view(), squared.view());
  OctreeNeighbours result;
  for (std::size_t q = 0; q <= queries.size(); ++q) result.begin.push_back(static_cast<std::int64_t>(q) * found);
  result.points = exec::to_vector(ex, ids);
  result.distances = distances_world(ex, tree, squared);
  return result;
}

template <exec::Space Exec>
OctreeNeighbours within(Exec& ex, const BuiltOctree& tree, std::span<const Vec3f> queries, double radius) {
  const exec::Buffer<Vec3f> unit = to_unit(ex, tree.frame, upload(ex, queries));
  const WithinRadius found =
      find_within(ex, tree.search_view(), unit.cview(), static_cast<float>(radius / tree.frame.size));
  const std::vector<std::int32_t> begin = exec::to_vector(ex, found.begin);
  return {{begin.begin(), begin.end()}, exec::to_vector(ex, found.ids), distances_world(ex, tree, found.squared)};
}

PSK_INSTANTIATE(build_of_points);
PSK_INSTANTIATE(point_order);
PSK_INSTANTIATE(level_of);
PSK_INSTANTIATE(locate_all);
PSK_INSTANTIATE(nearest);
PSK_INSTANTIATE(within);

}  // namespace pointskin::octree
