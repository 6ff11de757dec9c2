// Connected pieces of a mesh, by union-find over its vertices.
#include <pointskin/components.hpp>

#include <pointskin/error.hpp>

#include <algorithm>
#include <cstdint>
#include <vector>

#include "core/format.hpp"
#include "core/vec3.hpp"
#include "exec/algorithms.hpp"
#include "exec/any_space.hpp"
#include "exec/cpu_primitives.hpp"
#include "mesh/glance.hpp"
#include "mesh/joined_vertices.hpp"
#include "mesh/mesh_checks.hpp"

namespace pointskin {
namespace {

using exec::Buffer;
using exec::Cpu;

std::int64_t vertex_count(const Mesh& mesh) { return static_cast<std::int64_t>(mesh.vertices.size()); }
std::int64_t triangle_count(const Mesh& mesh) { return static_cast<std::int64_t>(mesh.triangles.size()); }

/// Runs part(begin, end) over fixed blocks of [0, n). @returns what it gave, in the order of the blocks
template <class T, class Part>
std::vector<T> by_blocks(Cpu& ex, std::int64_t n, const Part& part) {
  std::vector<T> parts(static_cast<std::size_t>(exec::block_count(n, exec::kCpuBlock)));
  ex.run_blocks(static_cast<std::int64_t>(parts.size()), [&](std::int64_t b) {
    parts[static_cast<std::size_t>(b)] = part(b * exec::kCpuBlock, std::min(n, (b + 1) * exec::kCpuBlock));
  });
  return parts;
}

/// Labels for the smallest vertices, then for all.
void label_vertices(Cpu& ex, const mesh_detail::JoinedView& joined, MeshComponents& pieces) {
  const auto vertices = static_cast<std::int64_t>(pieces.of_vertex.size());
  const Buffer<std::int32_t> firsts =
      exec::select(ex, "components", vertices, [&](std::int64_t v) { return joined.begins_piece(v); });
  pieces.count = firsts.size();
  exec::for_each(ex, "components", pieces.count, [&](std::int64_t piece) {
    pieces.of_vertex[static_cast<std::size_t>(firsts.data()[piece])] = static_cast<std::int32_t>(piece);
  });
  exec::for_each(ex, "components", vertices, [&](std::int64_t v) {
    const std::int64_t root = joined.sets.root(static_cast<std::int32_t>(v));
    if (joined.is_used(v) && root != v)
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
  const mesh_detail::Joined joined =
      mesh_detail::join_vertices(ex, vertex_count(mesh), {mesh.triangles.data(), triangle_count(mesh)});
  label_vertices(ex, joined.view(), pieces);

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
  return mesh_detail::glance(ex, vertex_count(mesh), {mesh.triangles.data(), triangle_count(mesh)});
}

MeshGlance glance_at(const Workspace& workspace, const DeviceMesh& mesh) {
  const ArrayView<const Triangle> triangles{mesh.triangles.data, mesh.triangles.size};
  return exec::visit(workspace.data().space, [&](auto& ex) {
    const std::int64_t bad = mesh_detail::find_bad_triangle(ex, mesh.vertices.size, triangles);
    if (bad >= 0)
      throw Error(ErrorCode::invalid_input, fmt::format("triangle {} names a vertex that is not there", bad));
    return mesh_detail::glance(ex, mesh.vertices.size, triangles);
  });
}

}  // namespace pointskin
