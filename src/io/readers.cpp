#include "io/readers.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "core/format.hpp"
#include "io/blocks.hpp"
#include "io/ply_body.hpp"

namespace pointskin::io {
namespace {

/// The same direction with length one. Lengths that are one already, up to rounding, keep their bits.
Vec3f unit(const Vec3f& n) {
  constexpr double kRounding = 1e-6;
  const double x = n.x;
  const double y = n.y;
  const double z = n.z;
  const double length = std::sqrt(x * x + y * y + z * z);
  if (length == 0 || std::abs(length - 1) <= kRounding) return n;
  return {to_float(x / length), to_float(y / length), to_float(z / length)};
}

bool is_finite(const Column& column, std::int64_t row) {
  return visit_type(column.stored, [&](auto tag) {
    const auto value = load<decltype(tag)>(column.data + row * column.stride_bytes, column.swapped);
    return std::abs(static_cast<double>(value)) <= kLargestCoordinate;
  });
}

void read_body(exec::Cpu& ex, const PlyInput& input, PlyBody& body) {
  (input.header.encoding == PlyEncoding::ascii ? read_ascii_body : read_binary_body)(ex, input, body);
}

}  // namespace

Cloud parse_ply_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const PlyHeader header = parse_ply_header(source);
  PlyBody body;
  read_body(ex, {source, header, false}, body);
  return assemble(ex, source, body.vertices, options.shift);
}

Mesh parse_ply_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const PlyHeader header = parse_ply_header(source);
  check_vertex_count(source, vertex_count(header));
  PlyBody body;
  read_body(ex, {source, header, true}, body);
  return assemble_mesh(ex, source, body.vertices, std::move(body.triangles), options);
}

Mesh assemble_mesh(exec::Cpu& ex, const Source& source, const PointTable& table, std::vector<Triangle>&& triangles,
                   const ReadOptions& options) {
  check_vertex_count(source, table.rows);
  Cloud points = assemble(ex, source, table, options.shift);
  if (points.dropped > 0) fail_on_bad_vertex(source, table, 0);
  constexpr std::size_t kBlockRows = 1 << 14;
  const std::size_t normals = points.normals.size();
  run_in_order(ex, static_cast<std::int64_t>((normals + kBlockRows - 1) / kBlockRows), [&](std::int64_t b) {
    const std::size_t first = static_cast<std::size_t>(b) * kBlockRows;
    for (std::size_t i = first; i < std::min(normals, first + kBlockRows); ++i)
      points.normals[i] = unit(points.normals[i]);
  });
  return {points.origin, std::move(points.positions), std::move(points.normals), std::move(points.attributes),
          std::move(triangles)};
}

void fail_on_bad_vertex(const Source& source, const PointTable& table, std::int64_t first_row) {
  std::int64_t bad = 0;
  const auto is_good = [&](std::int64_t row) {
    for (const Column& column : table.columns)
      if (is_coordinate(column.name) && !is_finite(column, row)) return false;
    return true;
  };
  while (is_good(bad)) ++bad;
  fail(source, fmt::format("vertex {} has a coordinate that is not finite, or beyond 1e38", first_row + bad),
       "remove the vertex or export the mesh again");
}

void check_vertex_count(const Source& source, std::int64_t vertices) {
  if (vertices > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, fmt::format("{}: {} vertices, but triangles can name 2147483647; split the mesh",
                                                   printable(source.name), vertices));
}

}  // namespace pointskin::io
