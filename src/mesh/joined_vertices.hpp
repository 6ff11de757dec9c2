// Vertices of a mesh that are joined by its triangles. Include after the primitives of the spaces used.
#pragma once

#include <pointskin/mesh.hpp>

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/algorithms.hpp"
#include "exec/atomic.hpp"
#include "exec/disjoint_sets.hpp"
#include "exec/memory.hpp"

namespace pointskin::mesh_detail {

/// Sets of vertices, and which of them some triangle uses.
struct JoinedView {
  exec::DisjointSets sets;
  std::uint32_t* used;  // a bit a vertex

  PSK_HD void use(std::int32_t v) const { exec::set_bits(used + v / 32, std::uint32_t{1} << (v % 32)); }
  [[nodiscard]] PSK_HD bool is_used(std::int64_t v) const { return (used[v / 32] >> (v % 32) & 1) != 0; }
  /// True for the smallest vertex of each piece, once all are joined.
  [[nodiscard]] PSK_HD bool begins_piece(std::int64_t v) const {
    return is_used(v) && sets.is_root(static_cast<std::int32_t>(v));
  }
};

struct JoinCorners {
  JoinedView joined;
  ArrayView<const Triangle> triangles;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t* const corners = triangles[i].data();
    for (int k = 0; k < 3; ++k) joined.use(corners[k]);
    joined.sets.unite(corners[0], corners[1]);
    joined.sets.unite(corners[1], corners[2]);
  }
};

struct Joined {
  exec::Buffer<std::int32_t> parents;
  exec::Buffer<std::uint32_t> used;

  [[nodiscard]] JoinedView view() const { return {{parents.view()}, used.data()}; }
};

/// Ids must be in range. O(v + t) time, 4 bytes and a bit a vertex.
template <exec::Space Exec>
Joined join_vertices(Exec& ex, std::int64_t vertices, ArrayView<const Triangle> triangles) {
  Joined joined{exec::iota(ex, vertices), exec::make_buffer<std::uint32_t>(ex, (vertices + 31) / 32)};
  exec::fill(ex, joined.used.view(), std::uint32_t{0});
  for_each(ex, "mesh.join", triangles.size, JoinCorners{joined.view(), triangles});
  return joined;
}

}  // namespace pointskin::mesh_detail
