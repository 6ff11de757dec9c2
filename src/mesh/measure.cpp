// Topology and measures of a mesh.
//
// Triangles are listed around each vertex (a counting sort over the corners). The edges {v, w} at v are then runs of
// equal w in the sorted list of v's spokes; a run is counted at its smaller end. Chaining the triangles of each run
// gives the fans of v. Degenerate triangles have no edges here: they use their vertices and connect them, no more.
#include <pointskin/mesh.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <vector>

#include "core/vec3.hpp"
#include "exec/algorithms.hpp"
#include "exec/cpu_primitives.hpp"
#include "exec/disjoint_sets.hpp"
#include "mesh/mesh_checks.hpp"

namespace pointskin {
namespace {

using exec::Buffer;
using exec::Cpu;
using exec::DisjointSets;

bool degenerate(const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; }

/// The triangles around each vertex, in no particular order.
struct Stars {
  Buffer<std::int64_t> ends;       ///< shape (v); the star of v is [v > 0 ? ends[v - 1] : 0, ends[v])
  Buffer<std::int32_t> triangles;  ///< shape (corners), ids of triangles
};

/// Calls f(id) for the two or three different corners of `t`.
template <class F>
void for_corners(const Triangle& t, const F& f) {
  f(t[0]);
  if (t[1] != t[0]) f(t[1]);
  if (t[2] != t[0] && t[2] != t[1]) f(t[2]);
}

Stars build_stars(Cpu& ex, const Mesh& mesh) {
  const auto vertices = static_cast<std::int64_t>(mesh.vertices.size());
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  Stars stars{Buffer<std::int64_t>(ex.pool(), vertices + 1), {}};
  std::int64_t* const ends = stars.ends.data();
  exec::for_each(ex, "stars", vertices + 1, [&](std::int64_t v) { ends[v] = 0; });
  exec::for_each(ex, "stars", triangles, [&](std::int64_t t) {
    for_corners(mesh.triangles[static_cast<std::size_t>(t)],
                [&](std::int32_t v) { std::atomic_ref(ends[v]).fetch_add(1, std::memory_order_relaxed); });
  });
  exec::exclusive_scan<std::int64_t>(ex, "stars", stars.ends.cview().part(0, vertices), stars.ends.view());
  stars.triangles = Buffer<std::int32_t>(ex.pool(), ends[vertices]);
  // Filling moves the start of each star to its end, which is the start of the next: no second array of cursors.
  // The order within a star depends on the threads; nothing below depends on that order.
  exec::for_each(ex, "stars", triangles, [&](std::int64_t t) {
    for_corners(mesh.triangles[static_cast<std::size_t>(t)], [&](std::int32_t v) {
      const std::int64_t slot = std::atomic_ref(ends[v]).fetch_add(1, std::memory_order_relaxed);
      stars.triangles.data()[slot] = static_cast<std::int32_t>(t);
    });
  });
  return stars;
}

/// One end of an edge at a vertex: the edge of the local triangle `member` to vertex `to`.
struct Spoke {
  std::int32_t to;
  std::int32_t member;
  bool outgoing;
};

/// Reused from vertex to vertex.
struct Scratch {
  std::vector<Spoke> spokes;
  std::vector<std::int32_t> fans;  ///< union-find over the members of a star
};

/// Lists the spokes of `v` sorted by their other end. @returns the number of triangles that are not degenerate
std::int32_t list_spokes(const Mesh& mesh, ArrayView<const std::int32_t> star, std::int32_t v, Scratch& scratch) {
  scratch.spokes.clear();
  std::int32_t members = 0;
  for (const std::int32_t id : star) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(id)];
    if (degenerate(t)) continue;
    const std::size_t corner = t[0] == v ? 0 : t[1] == v ? 1 : 2;
    scratch.spokes.push_back({t[(corner + 1) % 3], members, true});
    scratch.spokes.push_back({t[(corner + 2) % 3], members, false});
    ++members;
  }
  std::sort(scratch.spokes.begin(), scratch.spokes.end(), [](const Spoke& a, const Spoke& b) { return a.to < b.to; });
  return members;
}

std::int32_t fan_of(std::vector<std::int32_t>& fans, std::int32_t member) {
  while (fans[static_cast<std::size_t>(member)] != member) {
    std::int32_t& above = fans[static_cast<std::size_t>(member)];
    above = fans[static_cast<std::size_t>(above)];
    member = above;
  }
  return member;
}

/// Counts one edge from the spokes [begin, end) that lie on it.
void count_edge(const Spoke* begin, const Spoke* end, MeshReport& report) {
  ++report.edges;
  const std::ptrdiff_t sides = end - begin;
  if (sides == 1) ++report.boundary_edges;
  if (sides == 2 && begin[0].outgoing == begin[1].outgoing) ++report.misoriented_edges;
  if (sides > 2) ++report.non_manifold_edges;
}

/// Adds what the star of `v` shows: the edges to larger ids, and whether its triangles form one fan.
void count_star(const Mesh& mesh, ArrayView<const std::int32_t> star, std::int32_t v, Scratch& scratch,
                MeshReport& report) {
  std::int32_t fan_count = list_spokes(mesh, star, v, scratch);
  scratch.fans.resize(static_cast<std::size_t>(fan_count));
  std::iota(scratch.fans.begin(), scratch.fans.end(), 0);
  const Spoke* const last = scratch.spokes.data() + scratch.spokes.size();
  for (const Spoke* begin = scratch.spokes.data(); begin != last;) {
    const Spoke* end = begin + 1;
    for (; end != last && end->to == begin->to; ++end) {
      const std::int32_t a = fan_of(scratch.fans, begin->member);
      const std::int32_t b = fan_of(scratch.fans, end->member);
      if (a == b) continue;
      scratch.fans[static_cast<std::size_t>(b)] = a;
      --fan_count;
    }
    if (begin->to > v) count_edge(begin, end, report);
    begin = end;
  }
  if (fan_count > 1) ++report.non_manifold_vertices;
}

MeshReport count_stars(const Mesh& mesh, const Stars& stars, const DisjointSets& sets, std::int64_t begin,
                       std::int64_t end) {
  MeshReport part;
  Scratch scratch;
  for (std::int64_t v = begin; v < end; ++v) {
    const std::int64_t first = v > 0 ? stars.ends.data()[v - 1] : 0;
    const std::int64_t size = stars.ends.data()[v] - first;
    if (size == 0) continue;
    const auto id = static_cast<std::int32_t>(v);
    ++part.used_vertices;
    if (sets.is_root(id)) ++part.components;
    count_star(mesh, stars.triangles.cview().part(first, size), id, scratch, part);
  }
  return part;
}

/// Area, volume and degenerate triangles of [begin, end).
MeshReport sum_triangles(const Mesh& mesh, const Vec3d& centre, std::int64_t begin, std::int64_t end) {
  MeshReport part;
  for (std::int64_t i = begin; i < end; ++i) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(i)];
    const auto corner = [&](std::size_t k) {
      return to_double(mesh.vertices[static_cast<std::size_t>(t[k])]) - centre;
    };
    const Vec3d a = corner(0), b = corner(1), c = corner(2);
    part.area += 0.5 * length(cross(b - a, c - a));
    part.volume += dot(a, cross(b, c)) / 6;
    if (degenerate(t)) ++part.degenerate_triangles;
  }
  return part;
}

void add(const MeshReport& part, MeshReport& sum) {
  sum.used_vertices += part.used_vertices;
  sum.edges += part.edges;
  sum.boundary_edges += part.boundary_edges;
  sum.non_manifold_edges += part.non_manifold_edges;
  sum.misoriented_edges += part.misoriented_edges;
  sum.non_manifold_vertices += part.non_manifold_vertices;
  sum.degenerate_triangles += part.degenerate_triangles;
  sum.components += part.components;
  sum.volume += part.volume;
  sum.area += part.area;
}

/// Runs part(begin, end) over fixed blocks of [0, n) and adds the results in the order of the blocks.
template <class Part>
void add_parts(Cpu& ex, std::int64_t n, const Part& part, MeshReport& sum) {
  std::vector<MeshReport> parts(static_cast<std::size_t>(exec::block_count(n, exec::kCpuBlock)));
  ex.run_blocks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t b) {
    parts[static_cast<std::size_t>(b)] = part(b * exec::kCpuBlock, std::min(n, (b + 1) * exec::kCpuBlock));
  });
  for (const MeshReport& p : parts) add(p, sum);
}

}  // namespace

MeshReport measure(const Mesh& mesh, int threads) {
  Cpu ex(threads);
  mesh_detail::check_indices(ex, mesh);
  MeshReport report;
  report.vertices = static_cast<std::int64_t>(mesh.vertices.size());
  report.triangles = static_cast<std::int64_t>(mesh.triangles.size());

  const Buffer<std::int32_t> parents = exec::iota(ex, report.vertices);
  const DisjointSets sets{parents.view()};
  exec::for_each(ex, "components", report.triangles, [&](std::int64_t i) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(i)];
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
  });
  const Stars stars = build_stars(ex, mesh);
  add_parts(
      ex, report.vertices,
      [&](std::int64_t begin, std::int64_t end) { return count_stars(mesh, stars, sets, begin, end); }, report);

  // About the centre the terms of the volume are no larger than they must be, wherever the mesh lies.
  const Vec3d centre = mesh_detail::corner_bounds(ex, mesh).centre();
  add_parts(
      ex, report.triangles,
      [&](std::int64_t begin, std::int64_t end) { return sum_triangles(mesh, centre, begin, end); }, report);
  report.euler = report.used_vertices - report.edges + report.triangles;
  return report;
}

}  // namespace pointskin
