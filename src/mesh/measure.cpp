// Topology and measures of a mesh.
//
// Triangles are listed around each vertex (a counting sort over the corners). The edges {v, w} at v are then runs of
// equal w in the sorted list of v's spokes; a run is counted at its smaller end. Chaining the triangles of each run
// gives the fans of v. Degenerate triangles have no edges here: they use their vertices and connect them, no more.
#include <pointskin/mesh.hpp>

#include <atomic>
#include <cstdint>

#include "core/vec3.hpp"
#include "exec/algorithms.hpp"
#include "exec/cpu_primitives.hpp"
#include "exec/disjoint_sets.hpp"
#include "mesh/mesh_checks.hpp"
#include "mesh/star.hpp"

namespace pointskin {
namespace {

using exec::Buffer;
using exec::Cpu;
using exec::DisjointSets;
using mesh_detail::add_parts;
using mesh_detail::add_triangle;
using mesh_detail::count_star;
using mesh_detail::degenerate;
using mesh_detail::for_corners;
using mesh_detail::Star;

/// The triangles around each vertex, in no particular order.
struct Stars {
  Buffer<std::int64_t> ends;       ///< shape (v); the star of v is [v > 0 ? ends[v - 1] : 0, ends[v])
  Buffer<std::int32_t> triangles;  ///< shape (corners), ids of triangles
};

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

/// The star of `v`.
void list_spokes(const Mesh& mesh, ArrayView<const std::int32_t> triangles, std::int32_t v, Star& star) {
  star.clear();
  for (const std::int32_t id : triangles) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(id)];
    if (degenerate(t)) continue;
    const std::size_t corner = t[0] == v ? 0 : t[1] == v ? 1 : 2;
    star.add(t[(corner + 2) % 3], t[(corner + 1) % 3]);
  }
}

MeshReport count_stars(const Mesh& mesh, const Stars& stars, const DisjointSets& sets, std::int64_t begin,
                       std::int64_t end) {
  MeshReport part;
  Star star;
  for (std::int64_t v = begin; v < end; ++v) {
    const std::int64_t first = v > 0 ? stars.ends.data()[v - 1] : 0;
    const std::int64_t size = stars.ends.data()[v] - first;
    if (size == 0) continue;
    const auto id = static_cast<std::int32_t>(v);
    ++part.used_vertices;
    if (sets.is_root(id)) ++part.components;
    list_spokes(mesh, stars.triangles.cview().part(first, size), id, star);
    count_star(id, star, part);
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
    add_triangle(t, corner(0), corner(1), corner(2), part);
  }
  return part;
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
