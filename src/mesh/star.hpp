// What the triangles around a vertex tell of a mesh, and the sums over its triangles: for meshes in memory and in files.
#pragma once

#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::mesh_detail {

inline bool degenerate(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// Calls f(id) for the two or three different corners of `t`.
template <class F>
void for_corners(const Triangle& t, const F& f) {
  f(t[0]);
  if (t[1] != t[0]) f(t[1]);
  if (t[2] != t[0] && t[2] != t[1]) f(t[2]);
}

/// One end of an edge at a vertex: the edge of the local triangle `member` to vertex `to`.
struct Spoke {
  std::int32_t to;
  std::int32_t member;
  bool outgoing;
};

/// The spokes of one vertex, reused from vertex to vertex. Degenerate triangles have none.
struct Star {
  std::vector<Spoke> spokes;
  std::vector<std::int32_t> fans;  ///< union-find over its triangles
  std::int32_t members = 0;        ///< its triangles

  void clear() {
    spokes.clear();
    members = 0;
  }

  /// A triangle that runs from `before` to the vertex and on to `after`.
  void add(std::int32_t before, std::int32_t after) {
    spokes.push_back({after, members, true});
    spokes.push_back({before, members, false});
    ++members;
  }
};

/// Adds what the star of `v` shows: the edges to larger ids, and whether its triangles form one fan. The order of its
/// triangles does not matter.
void count_star(std::int32_t v, Star& star, MeshReport& report);

/// Adds area, volume about the place that the corners are relative to, and whether the triangle is degenerate.
inline void add_triangle(const Triangle& t, const Vec3d& a, const Vec3d& b, const Vec3d& c, MeshReport& sum) {
  sum.area += 0.5 * length(cross(b - a, c - a));
  sum.volume += dot(a, cross(b, c)) / 6;
  if (degenerate(t)) ++sum.degenerate_triangles;
}

void add(const MeshReport& part, MeshReport& sum);

/// Runs part(begin, end) over fixed blocks of [0, n) and adds the results in the order of the blocks.
template <class Part>
void add_parts(exec::Cpu& ex, std::int64_t n, const Part& part, MeshReport& sum) {
  std::vector<MeshReport> parts(static_cast<std::size_t>(exec::block_count(n, exec::kCpuBlock)));
  ex.run_blocks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t b) {
    parts[static_cast<std::size_t>(b)] = part(b * exec::kCpuBlock, std::min(n, (b + 1) * exec::kCpuBlock));
  });
  for (const MeshReport& p : parts) add(p, sum);
}

}  // namespace pointskin::mesh_detail
