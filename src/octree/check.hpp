// Host copies of an octree's arrays, and a checker of everything that build_octree promises. For tests and debugging.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/octree_data.hpp"
#include "octree/view.hpp"

namespace pointskin::octree {

/// The arrays of a LevelData on the host.
struct HostLevel {
  std::int32_t cell_bricks = 0;
  std::int32_t bricks = 0;
  std::vector<std::uint64_t> brick_key;
  std::vector<std::int32_t> parent;
  std::vector<std::int32_t> neighbours;
  std::vector<std::int32_t> child_brick;
  std::vector<std::uint8_t> unknowns;
  std::vector<std::int32_t> point_begin;
  friend bool operator==(const HostLevel&, const HostLevel&) = default;
};

/// An octree on the host, built in any space.
struct HostOctree {
  int depth = 0;
  std::vector<HostLevel> levels;  ///< depth + 1 of them

  /// A view of these arrays, for use on the host.
  [[nodiscard]] OctreeView view() const;
  friend bool operator==(const HostOctree&, const HostOctree&) = default;
};

/// Copies an array of the space `ex` to the host. Waits.
template <class T, exec::Space Exec>
std::vector<T> host_copy(Exec& ex, const exec::Buffer<T>& from) {
  std::vector<T> to(static_cast<std::size_t>(from.size()));
  copy_to_host(ex, from.cview(), to.data());
  return to;
}

/// Copies the octree to the host. Include after the primitives of the space. Waits.
template <exec::Space Exec>
HostOctree download(Exec& ex, const OctreeData& tree) {
  HostOctree host{tree.depth, {}};
  for (const LevelData& level : tree.levels)
    host.levels.push_back({level.cell_bricks, level.bricks, host_copy(ex, level.brick_key), host_copy(ex, level.parent),
                           host_copy(ex, level.neighbours), host_copy(ex, level.child_brick),
                           host_copy(ex, level.unknowns), host_copy(ex, level.point_begin)});
  return host;
}

/// Every rule of the octree that does not hold, a sentence each: shapes and ranges; keys sorted, unique and in the
/// cube; links inverse to each other; neighbours right and symmetric; padding, 2:1 grading and complete coarse levels;
/// corner owners and no ghosts beyond them; unknowns; point ranges; leaves that tile the cube. Empty for a sound
/// octree. Rules that need sound shapes and ids are left out where those are not.
/// @param point_keys  shape (n), ascending: what the octree was built of
/// O(27 nodes + depth n) look-ups; no assumption on the arrays' content.
std::vector<std::string> find_violations(const HostOctree& tree, ArrayView<const std::uint64_t> point_keys);

}  // namespace pointskin::octree
