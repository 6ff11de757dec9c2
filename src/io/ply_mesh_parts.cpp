#include "io/ply_mesh_parts.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <filesystem>
#include <optional>
#include <system_error>

#include "core/format.hpp"
#include "io/ply_body.hpp"
#include "io/readers.hpp"
#include "io/shift.hpp"

namespace pointskin::io {
namespace {

bool is_regular(const std::string& path) {
  std::error_code error;
  return path != "-" && std::filesystem::is_regular_file(path, error);
}

/// Bytes of all rows of an element, which fit into the file, if their lists need none; nothing if some do.
std::optional<std::size_t> bytes_of(const PlyElement& element, std::size_t row_bytes, std::size_t left) {
  if (!fits(static_cast<std::uint64_t>(element.count), row_bytes, left)) return std::nullopt;
  return static_cast<std::size_t>(element.count) * row_bytes;
}

}  // namespace

std::unique_ptr<PlyMeshParts> PlyMeshParts::open(const std::string& path) {
  if (!is_regular(path)) return nullptr;
  std::unique_ptr<PlyMeshParts> parts(new PlyMeshParts(path));
  const Source source = parts->input_.source();
  if (!is_ply(source.bytes)) return nullptr;
  const PlyHeader header = parse_ply_header(source);
  check_vertex_count(source, vertex_count(header));
  if (header.encoding == PlyEncoding::ascii) return nullptr;
  parts->encoding_ = header.encoding;
  std::size_t at = header.body;
  for (const PlyElement& element : header.elements) {
    std::size_t row_bytes = element.smallest_row_bytes();
    if (element.name == "face" && element.count > 0) {
      const auto rows = triangle_rows_of(element, find_corner_list(source, element), header.encoding);
      if (!rows) return nullptr;
      row_bytes = rows->row_bytes;
      parts->rows_ = *rows;
      parts->face_count_ = element.count;
      parts->faces_at_ = at;
    } else if (element.has_lists()) {
      return nullptr;
    } else if (element.name == "vertex") {
      parts->vertex_ = element;
      parts->vertices_at_ = at;
    }
    const std::optional<std::size_t> bytes = bytes_of(element, row_bytes, source.bytes.size() - at);
    if (!bytes) return nullptr;
    at += *bytes;
  }
  if (parts->vertex_.count == 0) return nullptr;
  return parts;
}

PointTable PlyMeshParts::vertex_rows(std::int64_t first, std::int64_t count, Bytes& buffer) const {
  const std::size_t row_bytes = vertex_.smallest_row_bytes();
  buffer.resize(static_cast<std::size_t>(count) * row_bytes);
  input_.read_at(vertices_at_ + static_cast<std::size_t>(first) * row_bytes, buffer.size(), buffer.data());
  PointTable table = view_rows(vertex_, encoding_, buffer.data(), count);
  std::erase_if(table.columns, [](const Column& column) { return !is_coordinate(column.name); });
  return table;
}

void PlyMeshParts::find_origin(exec::Cpu& ex) {
  Bytes buffer;
  const std::int64_t step =
      std::max(kRunRows, kBufferBytes / std::max<std::int64_t>(1, vertex_bytes()) / kRunRows * kRunRows);
  const auto for_parts = [&](const auto& use) {
    for (std::int64_t first = 0; first < vertices(); first += step)
      use(first, vertex_rows(first, std::min(step, vertices() - first), buffer));
  };
  OriginSearch search;
  for_parts([&](std::int64_t first, const PointTable& part) {
    if (search.add(ex, input_.source(), part) < part.rows) fail_on_bad_vertex(input_.source(), part, first);
  });
  origin_ = search.origin([&](const Box& box) {
    std::vector<Vec3d> all;
    for_parts([&](std::int64_t, const PointTable& part) {
      const std::vector<Vec3d> some = points_beyond(ex, input_.source(), part, box);
      all.insert(all.end(), some.begin(), some.end());
    });
    return all;
  });
}

void PlyMeshParts::read_vertices(std::int64_t first, std::int64_t count, Bytes& buffer, Vec3f* out) const {
  read_positions(vertex_rows(first, count, buffer), input_.source(), origin_, out);
}

void PlyMeshParts::read_triangles(std::int64_t first, std::int64_t count, Bytes& buffer, Triangle* out) const {
  const std::size_t at = faces_at_ + static_cast<std::size_t>(first) * rows_.row_bytes;
  buffer.resize(static_cast<std::size_t>(count) * rows_.row_bytes);
  input_.read_at(at, buffer.size(), buffer.data());
  const Source source = input_.source();
  if (!rows_.are_triangles(buffer.data(), count))
    throw Error(ErrorCode::over_limit,
                fmt::format("{}: not all faces are triangles, and so they cannot be read in parts; allow more memory",
                            printable(source.name)));
  if (const char* bad = rows_.read(buffer.data(), count, vertices(), out))
    fail_on_corner(source, load_integer(rows_.type, bad, rows_.swapped), vertices(),
                   at + static_cast<std::size_t>(bad - buffer.data()));
}

}  // namespace pointskin::io
