#include "io/readers.hpp"

#include <pointskin/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cctype>
#include <cmath>
#include <limits>

#include "io/blocks.hpp"
#include "io/lines.hpp"
#include "io/ply_body.hpp"
#include "io/recognise.hpp"

namespace pointskin::io {
namespace {

/// For stdin and names without an extension.
Format format_of_content(const Source& source, bool want_mesh) {
  std::string_view text = without_byte_order_mark(source.bytes);
  if (looks_like_off(text)) return Format::off;
  if (looks_like_stl(source.bytes)) return Format::stl;
  const std::size_t first = text.find_first_not_of(" \t\r\n");
  if (!want_mesh && first != std::string_view::npos && text[first] == '[') return Format::json;
  return want_mesh ? Format::obj : Format::text;
}

Mesh read_mesh_format(exec::Cpu& ex, const Source& source, Format format, const ReadOptions& options) {
  switch (format) {
    case Format::ply:
      return parse_ply_mesh(ex, source, options);
    case Format::obj:
      return parse_obj(ex, source, options);
    case Format::stl:
      return parse_stl(ex, source, options);
    case Format::off:
      return parse_off(ex, source, options);
    case Format::text:
    case Format::vtk:
    case Format::json:
      break;
  }
  fail(source, "is a file of points, not a mesh", "name a .ply, .obj, .stl or .off file");
}

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

[[noreturn]] void fail_on_bad_vertex(const Source& source, const PointTable& table) {
  std::int64_t bad = 0;
  const auto is_good = [&](std::int64_t row) {
    for (const Column& column : table.columns)
      if (is_coordinate(column.name) && !is_finite(column, row)) return false;
    return true;
  };
  while (is_good(bad)) ++bad;
  fail(source, fmt::format("vertex {} has a coordinate that is not finite", bad),
       "remove the vertex or export the mesh again");
}

}  // namespace

std::string extension_of(const std::string& path) {
  const std::size_t slash = path.rfind('/');
  const std::size_t dot = path.rfind('.');
  const std::size_t name = slash == std::string::npos ? 0 : slash + 1;
  if (dot == std::string::npos || dot <= name) return {};
  std::string extension = path.substr(dot);
  for (char& c : extension) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return extension;
}

Format detect_format(const Source& source, bool want_mesh) {
  if (is_ply(source.bytes)) return Format::ply;
  if (source.bytes.starts_with("# vtk DataFile")) return Format::vtk;
  const std::string extension = extension_of(source.name);
  if (extension.empty()) return format_of_content(source, want_mesh);
  if (extension == ".ply") return Format::ply;  // its reader says what is wrong with it
  if (extension == ".obj") return Format::obj;
  if (extension == ".stl") return Format::stl;
  if (extension == ".off") return Format::off;
  if (extension == ".vtk") return Format::vtk;
  if (extension == ".json") return Format::json;
  for (const char* text : {".xyz", ".pts", ".asc", ".txt", ".csv"})
    if (extension == text) return Format::text;
  fail(source, "has the unknown extension " + in_quotes(extension),
       want_mesh ? "use .ply, .obj, .stl or .off"
                 : "use .ply, .xyz, .pts, .asc, .txt, .csv, .vtk, .json, .obj, .stl or .off");
}

Cloud parse_cloud(const Source& source, Format format, const ReadOptions& options) {
  exec::Cpu ex(options.threads);
  if (format == Format::ply) return parse_ply_cloud(ex, source, options);
  if (format == Format::text) return parse_text(ex, source, options);
  if (format == Format::vtk) return parse_vtk(ex, source, options);
  if (format == Format::json) return parse_json_points(ex, source, options);
  Mesh mesh = read_mesh_format(ex, source, format, options);
  return {mesh.origin, std::move(mesh.vertices), std::move(mesh.normals), std::move(mesh.attributes), 0};
}

Mesh parse_mesh(const Source& source, Format format, const ReadOptions& options) {
  exec::Cpu ex(options.threads);
  return read_mesh_format(ex, source, format, options);
}

Cloud parse_ply_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const PlyHeader header = parse_ply_header(source);
  PlyBody body;
  const PlyInput input{source, header, false};
  if (header.encoding == PlyEncoding::ascii)
    read_ascii_body(ex, input, body);
  else
    read_binary_body(ex, input, body);
  return assemble(ex, source, body.vertices, options.shift);
}

Mesh parse_ply_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const PlyHeader header = parse_ply_header(source);
  check_vertex_count(source, vertex_count(header));
  PlyBody body;
  const PlyInput input{source, header, true};
  if (header.encoding == PlyEncoding::ascii)
    read_ascii_body(ex, input, body);
  else
    read_binary_body(ex, input, body);
  return assemble_mesh(ex, source, body.vertices, std::move(body.triangles), options);
}

Mesh assemble_mesh(exec::Cpu& ex, const Source& source, const PointTable& table, std::vector<Triangle>&& triangles,
                   const ReadOptions& options) {
  check_vertex_count(source, table.rows);
  Cloud points = assemble(ex, source, table, options.shift);
  if (points.dropped > 0) fail_on_bad_vertex(source, table);
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

void check_vertex_count(const Source& source, std::int64_t vertices) {
  if (vertices > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, fmt::format("{}: {} vertices, but triangles can name 2147483647; split the mesh",
                                                   printable(source.name), vertices));
}

}  // namespace pointskin::io
