#include "mesh/mesh_checks.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::mesh_detail {
namespace {

constexpr std::int64_t kNone = std::numeric_limits<std::int64_t>::max();

std::int64_t triangle_count(const Mesh& mesh) { return static_cast<std::int64_t>(mesh.triangles.size()); }

std::int64_t first_bad_triangle(const Mesh& mesh, std::int64_t begin, std::int64_t end) {
  const auto vertices = static_cast<std::int64_t>(mesh.vertices.size());
  for (std::int64_t t = begin; t < end; ++t)
    for (const std::int32_t id : mesh.triangles[static_cast<std::size_t>(t)])
      if (id < 0 || id >= vertices) return t;
  return kNone;
}

}  // namespace

void check_indices(exec::Cpu& ex, const Mesh& mesh) {
  const std::int64_t n = triangle_count(mesh);
  if (n > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit,
                "the mesh has " + std::to_string(n) + " triangles, more than 32-bit ids can name");
  std::vector<std::int64_t> bad(static_cast<std::size_t>(exec::block_count(n, exec::kCpuBlock)), kNone);
  ex.run_blocks(static_cast<std::int64_t>(bad.size()), [&](std::int64_t b) {
    bad[static_cast<std::size_t>(b)] =
        first_bad_triangle(mesh, b * exec::kCpuBlock, std::min(n, (b + 1) * exec::kCpuBlock));
  });
  const auto hit = std::find_if(bad.begin(), bad.end(), [](std::int64_t t) { return t != kNone; });
  if (hit == bad.end()) return;
  const Triangle& ids = mesh.triangles[static_cast<std::size_t>(*hit)];
  throw Error(ErrorCode::invalid_input, "triangle " + std::to_string(*hit) + " names the vertices " +
                                            std::to_string(ids[0]) + ", " + std::to_string(ids[1]) + ", " +
                                            std::to_string(ids[2]) + ", but the mesh has " +
                                            std::to_string(mesh.vertices.size()) + " vertices");
}

CornerBounds corner_bounds(exec::Cpu& ex, const Mesh& mesh) {
  const std::int64_t n = triangle_count(mesh);
  std::vector<CornerBounds> part(static_cast<std::size_t>(exec::block_count(n, exec::kCpuBlock)), CornerBounds::none());
  ex.run_blocks(static_cast<std::int64_t>(part.size()), [&](std::int64_t b) {
    CornerBounds box = CornerBounds::none();
    for (std::int64_t t = b * exec::kCpuBlock; t < std::min(n, (b + 1) * exec::kCpuBlock); ++t)
      for (const std::int32_t id : mesh.triangles[static_cast<std::size_t>(t)])
        box.add(mesh.vertices[static_cast<std::size_t>(id)]);
    part[static_cast<std::size_t>(b)] = box;
  });
  CornerBounds all = CornerBounds::none();
  for (const CornerBounds& box : part) all.add(box);
  all.close();
  return all;
}

CornerBounds CornerBounds::none() {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  return {{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}, true};
}

void CornerBounds::add(const Vec3f& vertex) {
  const Vec3d p = to_double(vertex);
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (!std::isfinite(p[axis])) {
      finite = false;
      continue;
    }
    lower[axis] = std::min(lower[axis], p[axis]);
    upper[axis] = std::max(upper[axis], p[axis]);
  }
}

void CornerBounds::add(const CornerBounds& other) {
  for (std::size_t axis = 0; axis < 3; ++axis) {
    lower[axis] = std::min(lower[axis], other.lower[axis]);
    upper[axis] = std::max(upper[axis], other.upper[axis]);
  }
  finite = finite && other.finite;
}

void CornerBounds::close() {
  for (std::size_t axis = 0; axis < 3; ++axis)
    if (lower[axis] > upper[axis]) lower[axis] = upper[axis] = 0;
}

Vec3d CornerBounds::centre() const { return 0.5 * (lower + upper); }

double CornerBounds::diagonal() const { return length(upper - lower); }

}  // namespace pointskin::mesh_detail
