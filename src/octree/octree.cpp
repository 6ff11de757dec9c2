#include <pointskin/error.hpp>
#include <pointskin/octree.hpp>

#include <cmath>
#include <utility>

#include "octree/keys.hpp"
#include "octree/public_octree.hpp"

namespace pointskin {
namespace {

/// Offset of 1 along the given sides of two axes after `axis`, and none along `axis` itself.
std::array<int, 3> sides(int axis, int side_b, int side_c) {
  std::array<int, 3> d{};
  d[static_cast<std::size_t>((axis + 1) % 3)] = side_b;
  d[static_cast<std::size_t>((axis + 2) % 3)] = side_c;
  return d;
}

}  // namespace

std::array<std::int32_t, 3> OctreeLevel::coordinates(std::int32_t node) const {
  const std::uint64_t key = brick_keys[static_cast<std::size_t>(node / 8)] << 3 | static_cast<std::uint64_t>(node % 8);
  const octree::Coordinates c = octree::decode(key);
  return {c.x, c.y, c.z};
}

std::int32_t OctreeLevel::neighbour(std::int32_t node, int dx, int dy, int dz) const {
  const int slot = node % 8;
  const int x = octree::slot_x(slot) + dx;
  const int y = octree::slot_y(slot) + dy;
  const int z = octree::slot_z(slot) + dz;
  const std::int64_t entry =
      std::int64_t{node / 8} * octree::kNeighbours + octree::neighbour_index(x >> 1, y >> 1, z >> 1);
  const std::int32_t brick = neighbours[static_cast<std::size_t>(entry)];
  return brick < 0 ? -1 : brick * 8 + octree::slot_of(x & 1, y & 1, z & 1);
}

std::int32_t OctreeLevel::corner_owner(std::int32_t cell, int corner) const {
  return neighbour(cell, octree::slot_x(corner), octree::slot_y(corner), octree::slot_z(corner));
}

OctreeOwner OctreeLevel::edge_owner(std::int32_t cell, int edge) const {
  const int axis = edge / 4;
  const auto d = sides(axis, edge / 2 % 2, edge % 2);
  return {neighbour(cell, d[0], d[1], d[2]), axis};
}

OctreeOwner OctreeLevel::face_owner(std::int32_t cell, int face) const {
  const int axis = face / 2;
  std::array<int, 3> d{};
  d[static_cast<std::size_t>(axis)] = face % 2;
  return {neighbour(cell, d[0], d[1], d[2]), axis};
}

Octree::Octree(std::shared_ptr<const Impl> impl) : impl_(std::move(impl)) {}

Octree Octree::build(std::span<const Vec3f> positions, const OctreeOptions& options, const Workspace& workspace) {
  if (options.depth < 1 || options.depth > octree::kMaxDepth)
    throw Error(ErrorCode::usage, "option depth must be in 1..20");
  if (!(options.scale >= 1 && options.scale <= 100)) throw Error(ErrorCode::usage, "option scale must be in 1..100");
  octree::BuiltOctree tree =
      exec::visit(workspace.data().space, [&](auto& ex) { return octree::build_of_points(ex, positions, options); });
  return Octree(std::make_shared<Impl>(Impl{workspace, std::move(tree)}));
}

int Octree::depth() const { return impl_->tree.data.depth; }
std::int64_t Octree::points() const { return impl_->tree.positions.size(); }
Vec3d Octree::cube_lower() const { return impl_->tree.frame.lower; }
double Octree::cube_size() const { return impl_->tree.frame.size; }

std::vector<std::int32_t> Octree::point_order() const {
  return exec::visit(impl_->workspace.data().space, [&](auto& ex) { return octree::point_order(ex, impl_->tree); });
}

std::vector<OctreeLeaf> Octree::locate(std::span<const Vec3f> queries) const {
  return exec::visit(impl_->workspace.data().space,
                     [&](auto& ex) { return octree::locate_all(ex, impl_->tree, queries); });
}

OctreeLevel Octree::level(int depth) const {
  if (depth < 0 || depth > this->depth()) throw Error(ErrorCode::usage, "the octree has no level of this depth");
  return exec::visit(impl_->workspace.data().space, [&](auto& ex) { return octree::level_of(ex, impl_->tree, depth); });
}

OctreeNeighbours Octree::nearest(std::span<const Vec3f> queries, int k) const {
  if (k < 1) throw Error(ErrorCode::usage, "the number of neighbours must be at least 1");
  return exec::visit(impl_->workspace.data().space,
                     [&](auto& ex) { return octree::nearest(ex, impl_->tree, queries, k); });
}

OctreeNeighbours Octree::within(std::span<const Vec3f> queries, double radius) const {
  if (!(radius >= 0) || !std::isfinite(radius))
    throw Error(ErrorCode::usage, "the radius must be finite and not negative");
  return exec::visit(impl_->workspace.data().space,
                     [&](auto& ex) { return octree::within(ex, impl_->tree, queries, radius); });
}

}  // namespace pointskin
