// The octree as a component of its own: build from points, neighbours, owners, ranges, and searches.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include <pointskin/export.hpp>
#include <pointskin/vector.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

struct OctreeOptions {
  int depth = 8;       ///< D, in [1, 20]; the finest cells are cube / 2^D wide
  double scale = 1.1;  ///< cube / bounding cube of the points, in [1, 100]
};

/// Owner of an edge or a face: the node whose lower corner it starts at, and its axis. A face's axis is its normal's.
struct OctreeOwner {
  std::int32_t node = -1;
  int axis = 0;
};

/// Host copy of one level. Nodes come in bricks of 8 siblings: node n is in brick n / 8, at slot n % 8 = 4 x + 2 y + z.
/// Nodes [0, cells) are cells, in Morton order; the others are ghosts one step above a cell, which only own the
/// corners, edges and faces there. Ids are local to the level, -1 stands for "does not exist".
struct OctreeLevel {
  int depth = 0;
  std::int64_t cells = 0;                 ///< nodes that are cells
  std::int64_t nodes = 0;                 ///< 8 times the number of bricks
  std::vector<std::uint64_t> brick_keys;  ///< (bricks) Morton key of the parent node's integer coordinates, x highest
  std::vector<std::int32_t> parents;      ///< (bricks) parent node on the level above
  std::vector<std::int32_t>
      neighbours;  ///< (bricks, 27) bricks around; offset (x, y, z) is at 9 (x+1) + 3 (y+1) + z + 1
  std::vector<std::int32_t>
      child_bricks;  ///< (nodes) brick on the level below: children if below its cells / 8, else ghosts
  std::vector<std::int32_t> point_begin;  ///< (cells + 1) first point of each cell in Octree::point_order()

  /// Integer coordinates of a node in cells of this level.
  [[nodiscard]] std::array<std::int32_t, 3> coordinates(std::int32_t node) const;

  /// Node at an offset of at most two nodes along each axis, or -1. O(1).
  [[nodiscard]] std::int32_t neighbour(std::int32_t node, int dx, int dy, int dz) const;

  /// Owner of corner 0..7 (4 x + 2 y + z) of a cell. Cells around a corner name the same owner. O(1).
  [[nodiscard]] std::int32_t corner_owner(std::int32_t cell, int corner) const;

  /// Owner of edge 0..11 of a cell: 4 axis + 2 b + c, where b and c are its sides (0 or 1) along the next two axes.
  [[nodiscard]] OctreeOwner edge_owner(std::int32_t cell, int edge) const;

  /// Owner of face 0..5 of a cell: 2 axis + side.
  [[nodiscard]] OctreeOwner face_owner(std::int32_t cell, int face) const;
};

/// Deepest cell around a point.
struct OctreeLeaf {
  int depth = 0;
  std::int32_t cell = 0;
};

/// Neighbours of many queries in one list: those of query q are [begin[q], begin[q + 1]).
struct OctreeNeighbours {
  std::vector<std::int64_t> begin;   ///< (queries + 1)
  std::vector<std::int32_t> points;  ///< ids in the caller's order
  std::vector<float> distances;      ///< world units
};

/// Padded, 2:1-graded octree over a point set (docs/algorithm.md). A cheap handle; copies share the same data.
/// Searches run on the device of the tree. Not safe for two threads at once.
class Octree {
 public:
  /// Builds the tree on `device`.
  /// @param positions  shape (n), finite, n >= 1; not kept
  /// @throws Error usage (an option out of range), empty_result (no points, or all at one place), over_limit,
  ///         device_unavailable
  /// O(n + nodes log nodes). Integers only after the points are scaled: the same tree on every device.
  static Octree build(std::span<const Vec3f> positions, const OctreeOptions& options = {},
                      const Workspace& workspace = {});

  [[nodiscard]] int depth() const;
  [[nodiscard]] std::int64_t points() const;
  /// Lower corner and side of the cube, in the coordinates of the points.
  [[nodiscard]] Vec3d cube_lower() const;
  [[nodiscard]] double cube_size() const;

  /// Copies one level to the host. @throws Error usage if `depth` is not in [0, depth()]
  [[nodiscard]] OctreeLevel level(int depth) const;

  /// Ids of the points in Morton order; OctreeLevel::point_begin counts in this order. Shape (n).
  [[nodiscard]] std::vector<std::int32_t> point_order() const;

  /// Leaf around each query; queries outside of the cube are moved to its nearest point. O(depth) each.
  [[nodiscard]] std::vector<OctreeLeaf> locate(std::span<const Vec3f> queries) const;

  /// The k nearest points of each query (all if there are fewer), by ascending (distance, id). Distances are
  /// those of the points in the unit cube, rounded to float: neighbours closer together than cube / 2^23 may swap.
  /// About O(log n + k^2) each. @throws Error usage if k < 1
  [[nodiscard]] OctreeNeighbours nearest(std::span<const Vec3f> queries, int k) const;

  /// All points at most `radius` (world units) away from each query, in Morton order.
  /// @throws Error usage if radius is negative or not finite, over_limit if there are more than 2^31 in all
  [[nodiscard]] OctreeNeighbours within(std::span<const Vec3f> queries, double radius) const;

  class Impl;

 private:
  explicit Octree(std::shared_ptr<const Impl> impl);
  std::shared_ptr<const Impl> impl_;
};

}  // namespace pointskin
