#include "io/pieces.hpp"

#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>

#include <cmath>
#include <utility>

#include "core/vec3.hpp"
#include "io/readers.hpp"

namespace pointskin::io {

void Pieces::add(const PointTable& table, const std::vector<Triangle>& triangles) {
  if (table.rows == 0) return;
  const std::int64_t first = vertices_.size();
  check_vertex_count(source_, first + table.rows);
  const auto moved = [first](std::int32_t id) { return static_cast<std::int32_t>(first + id); };
  for (const Triangle& t : triangles) triangles_.push_back({moved(t[0]), moved(t[1]), moved(t[2])});
  Cloud part = assemble(ex_, source_, table, options_.shift);
  if (part.dropped > 0 && !triangles_.empty())
    fail(source_, "has a vertex that is not finite, or beyond 1e38", "export the mesh again");
  merge_into(vertices_, std::move(part));
}

Mesh Pieces::take_mesh() {
  for (Vec3f& n : vertices_.normals) {
    const double size = std::sqrt(squared_length(to_double(n)));
    if (size > 0 && std::abs(size - 1) > 1e-6) n = to_float(to_double(n) / size);
  }
  Cloud& v = vertices_;
  return {v.origin, std::move(v.positions), std::move(v.normals), std::move(v.attributes), std::move(triangles_)};
}

}  // namespace pointskin::io
