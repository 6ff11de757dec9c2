// Connected pieces of a mesh by union-find over its vertices, and whether its edges cancel.
//
// A mesh is closed where the boundary of its triangles is nothing: each edge appears an even number of times, and in a
// mesh that is oriented as often one way as the other. Both are sums over the triangles' edges, in Z/2 and in Z. Rather
// than one counter an edge, the sums run over a 64-bit hash of each edge, so that no edge need be found again.
// Source of the hash: Steele, Lea & Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014 (the finaliser
// of SplitMix64).
#include <pointskin/components.hpp>

#include <algorithm>
#include <atomic>
#include <cstdint>
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

std::int64_t vertex_count(const Mesh& mesh) { return static_cast<std::int64_t>(mesh.vertices.size()); }
std::int64_t triangle_count(const Mesh& mesh) { return static_cast<std::int64_t>(mesh.triangles.size()); }

/// Vertices joined by triangles, and which of them some triangle uses.
struct Joined {
  Buffer<std::int32_t> parents;
  Buffer<std::uint8_t> used;

  [[nodiscard]] DisjointSets sets() const { return {parents.view()}; }
  /// True for the smallest vertex of each piece.
  [[nodiscard]] bool begins_piece(std::int64_t v) const {
    return used.data()[v] != 0 && sets().is_root(static_cast<std::int32_t>(v));
  }
};

Joined join_vertices(Cpu& ex, const Mesh& mesh) {
  const std::int64_t vertices = vertex_count(mesh);
  Joined joined{exec::iota(ex, vertices), Buffer<std::uint8_t>(ex.pool(), vertices)};
  std::uint8_t* const used = joined.used.data();
  exec::for_each(ex, "components", vertices, [used](std::int64_t v) { used[v] = 0; });
  const DisjointSets sets = joined.sets();
  exec::for_each(ex, "components", triangle_count(mesh), [&](std::int64_t i) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(i)];
    for (const std::int32_t v : t) std::atomic_ref(used[v]).store(1, std::memory_order_relaxed);
    sets.unite(t[0], t[1]);
    sets.unite(t[1], t[2]);
  });
  return joined;
}

/// Runs part(begin, end) over fixed blocks of [0, n). @returns what it gave, in the order of the blocks
template <class T, class Part>
std::vector<T> by_blocks(Cpu& ex, std::int64_t n, const Part& part) {
  std::vector<T> parts(static_cast<std::size_t>(exec::block_count(n, exec::kCpuBlock)));
  ex.run_blocks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t b) {
    parts[static_cast<std::size_t>(b)] = part(b * exec::kCpuBlock, std::min(n, (b + 1) * exec::kCpuBlock));
  });
  return parts;
}

std::uint64_t mix(std::uint64_t x) {
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9U;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebU;
  return x ^ (x >> 31);
}

/// What is left of the edges when equal ones have cancelled: 0 and 0 for a mesh that is closed and oriented.
struct EdgeSums {
  std::uint64_t even = 0;      ///< exclusive or: 0 where every edge appears an even number of times
  std::uint64_t balanced = 0;  ///< signed by direction: 0 where every edge appears as often either way

  void add(std::int32_t from, std::int32_t to) {
    const auto low = static_cast<std::uint64_t>(std::min(from, to));
    const auto high = static_cast<std::uint64_t>(std::max(from, to));
    const std::uint64_t hash = mix((high << 32U | low) + 1);  // 0 would be hashed to 0
    even ^= hash;
    balanced += from < to ? hash : 0 - hash;
  }
};

EdgeSums sum_edges(const Mesh& mesh, std::int64_t begin, std::int64_t end) {
  EdgeSums sums;
  for (std::int64_t i = begin; i < end; ++i) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(i)];
    if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
    for (std::size_t k = 0; k < 3; ++k) sums.add(t[k], t[(k + 1) % 3]);
  }
  return sums;
}

/// Labels for the smallest vertices, then for all.
void label_vertices(Cpu& ex, const Joined& joined, MeshComponents& pieces) {
  const auto vertices = static_cast<std::int64_t>(pieces.of_vertex.size());
  const Buffer<std::int32_t> firsts =
      exec::select(ex, "components", vertices, [&](std::int64_t v) { return joined.begins_piece(v); });
  pieces.count = firsts.size();
  exec::for_each(ex, "components", pieces.count, [&](std::int64_t piece) {
    pieces.of_vertex[static_cast<std::size_t>(firsts.data()[piece])] = static_cast<std::int32_t>(piece);
  });
  const DisjointSets sets = joined.sets();
  exec::for_each(ex, "components", vertices, [&](std::int64_t v) {
    const std::int64_t root = sets.root(static_cast<std::int32_t>(v));
    if (joined.used.data()[v] != 0 && root != v)
      pieces.of_vertex[static_cast<std::size_t>(v)] = pieces.of_vertex[static_cast<std::size_t>(root)];
  });
}

/// Consecutive triangles of one piece.
struct Run {
  std::int32_t piece = 0;
  std::int64_t triangles = 0;
  double area = 0, volume = 0;
};

/// The runs of [begin, end). Neighbours in the list mostly belong together, so they are few.
std::vector<Run> measure_runs(const Mesh& mesh, const MeshComponents& pieces, const Vec3d& centre, std::int64_t begin,
                              std::int64_t end) {
  std::vector<Run> runs;
  for (std::int64_t i = begin; i < end; ++i) {
    const Triangle& t = mesh.triangles[static_cast<std::size_t>(i)];
    const std::int32_t piece = pieces.of(t);
    if (runs.empty() || runs.back().piece != piece) runs.push_back({piece});
    const auto corner = [&](std::size_t k) {
      return to_double(mesh.vertices[static_cast<std::size_t>(t[k])]) - centre;
    };
    const Vec3d a = corner(0), b = corner(1), c = corner(2);
    ++runs.back().triangles;
    runs.back().area += 0.5 * length(cross(b - a, c - a));
    runs.back().volume += dot(a, cross(b, c)) / 6;
  }
  return runs;
}

}  // namespace

MeshComponents label_components(const Mesh& mesh, int threads) {
  Cpu ex(threads);
  mesh_detail::check_indices(ex, mesh);
  MeshComponents pieces;
  pieces.of_vertex.assign(mesh.vertices.size(), -1);
  label_vertices(ex, join_vertices(ex, mesh), pieces);

  const auto count = static_cast<std::size_t>(pieces.count);
  pieces.triangles.assign(count, 0);
  pieces.areas.assign(count, 0);
  pieces.volumes.assign(count, 0);
  // About the centre the terms of the volume are no larger than they must be, wherever the mesh lies.
  const Vec3d centre = mesh_detail::corner_bounds(ex, mesh).centre();
  const auto runs = by_blocks<std::vector<Run>>(ex, triangle_count(mesh), [&](std::int64_t begin, std::int64_t end) {
    return measure_runs(mesh, pieces, centre, begin, end);
  });
  for (const std::vector<Run>& block : runs) {
    for (const Run& run : block) {
      const auto piece = static_cast<std::size_t>(run.piece);
      pieces.triangles[piece] += run.triangles;
      pieces.areas[piece] += run.area;
      pieces.volumes[piece] += run.volume;
    }
  }
  return pieces;
}

MeshGlance glance_at(const Mesh& mesh, int threads) {
  Cpu ex(threads);
  mesh_detail::check_indices(ex, mesh);
  const Joined joined = join_vertices(ex, mesh);
  const auto count_pieces = [&](std::int64_t begin, std::int64_t end) {
    std::int64_t count = 0;
    for (std::int64_t v = begin; v < end; ++v) count += joined.begins_piece(v) ? 1 : 0;
    return count;
  };
  MeshGlance glance;
  for (const std::int64_t count : by_blocks<std::int64_t>(ex, vertex_count(mesh), count_pieces))
    glance.components += count;
  const auto sums = by_blocks<EdgeSums>(
      ex, triangle_count(mesh), [&](std::int64_t begin, std::int64_t end) { return sum_edges(mesh, begin, end); });
  EdgeSums all;
  for (const EdgeSums& part : sums) {
    all.even ^= part.even;
    all.balanced += part.balanced;
  }
  glance.closed = glance.components > 0 && all.even == 0;
  glance.oriented = glance.closed && all.balanced == 0;
  return glance;
}

}  // namespace pointskin
