#include "io/file_parts.hpp"

#include <pointskin/merge.hpp>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "io/formats.hpp"
#include "io/numpy_table.hpp"
#include "io/ply_body.hpp"
#include "io/ply_header.hpp"
#include "io/readers.hpp"
#include "io/shift.hpp"
#include "io/table_parts.hpp"
#include "io/text_parts.hpp"

namespace pointskin::io {
namespace {

/// @throws Error invalid_input if there is none
bool is_regular(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path == "-" ? "/dev/stdin" : path, error);
  if (path != "-" && status.type() == std::filesystem::file_type::not_found) (void)Input(path);  // tells so
  return std::filesystem::is_regular_file(status);
}

/// How the points of a file are read in parts.
enum class Layout : std::uint8_t { none, ply_text, columns_of_text, in_place };

/// The vertices of a binary PLY file; nothing where rows have lists: only walking over them shows that the file is
/// whole.
std::optional<PointTable> vertices_in_place(const Source& source) {
  const PlyHeader header = parse_ply_header(source);
  std::optional<PointTable> vertices;
  std::size_t at = header.body;
  for (const PlyElement& element : header.elements) {
    const std::size_t row_bytes = element.smallest_row_bytes();
    const bool has_lists = element.has_lists() && element.count > 0;
    if (has_lists || !fits(static_cast<std::uint64_t>(element.count), row_bytes, source.bytes.size() - at))
      return std::nullopt;
    if (element.name == "vertex")
      vertices = view_rows(element, header.encoding, source.bytes.data() + at, element.count);
    at += static_cast<std::size_t>(element.count) * row_bytes;
  }
  return vertices;
}

std::optional<PointTable> points_in_place(const Source& source) {
  return is_ply(source.bytes) ? vertices_in_place(source) : table_of(source, parse_npy(source)).table();
}

/// False for a mesh whose vertices take the normals of its faces, too.
bool has_points_alone(const PlyHeader& header) {
  const PlyElement* const vertex = header.find("vertex");
  const PlyElement* const face = header.find("face");
  if (vertex == nullptr) return false;
  const bool has_normals = std::any_of(vertex->properties.begin(), vertex->properties.end(),
                                       [](const PlyProperty& p) { return p.name == "nx" || p.name == "normal_x"; });
  return has_normals || face == nullptr || face->count == 0;
}

Layout layout_of(const Input& input) {
  const Source source = input.source();
  const auto reader = read_format(source, false).run.read_cloud;
  if (reader == parse_text) {
    const bool is_binary = extension_of(source.name) == ".xyz" && is_binary_xyz(source);
    return is_binary ? Layout::none : Layout::columns_of_text;
  }
  if (reader == parse_ply_cloud) {
    const PlyHeader header = parse_ply_header(source);
    if (header.encoding == PlyEncoding::ascii) return has_points_alone(header) ? Layout::ply_text : Layout::none;
  } else if (reader != parse_npy_cloud) {
    return Layout::none;
  }
  const std::optional<PointTable> table = points_in_place(source);
  return table && TableParts::holds(input, *table) ? Layout::in_place : Layout::none;
}

/// Rows that are read at once; whole runs of OriginSearch.
std::int64_t rows_at_once(const PointRows& points) {
  const std::int64_t row_bytes = std::max<std::int64_t>(1, points.row_bytes());
  return std::max(kRunRows, FileParts::kBufferBytes / row_bytes / kRunRows * kRunRows);
}

PointTable coordinates_of(PointTable table) {
  std::erase_if(table.columns, [](const Column& column) { return !is_coordinate(column.name); });
  return table;
}

}  // namespace

bool FileParts::can_open(const std::string& path) { return is_regular(path) && layout_of(Input(path)) != Layout::none; }

std::unique_ptr<FileParts> FileParts::open(exec::Cpu& ex, const std::string& path) {
  if (!is_regular(path)) return nullptr;
  std::unique_ptr<FileParts> parts(new FileParts(path));
  const Input& input = parts->input_;
  switch (layout_of(input)) {
    case Layout::none:
      return nullptr;
    case Layout::ply_text:
      parts->rows_ = TextParts::of_ply(ex, input, parse_ply_header(input.source()));
      break;
    case Layout::columns_of_text:
      parts->rows_ = TextParts::of_columns(ex, input);
      break;
    case Layout::in_place: {
      const PointTable table = *points_in_place(input.source());
      parts->rows_ = std::make_unique<TableParts>(input, table);
      parts->coordinates_ = std::make_unique<TableParts>(input, coordinates_of(table));
    }
  }
  return parts;
}

template <class Use>
void FileParts::for_coordinates(exec::Cpu& ex, const Use& use) const {
  Bytes buffer;
  const std::int64_t step = rows_at_once(coordinates());
  for (std::int64_t first = 0; first < rows(); first += step)
    use(coordinates().read(ex, first, std::min(step, rows() - first), buffer));
}

void FileParts::choose_origin(exec::Cpu& ex, const std::optional<Vec3d>& shift) {
  Bytes none;
  assemble(ex, input_.source(), rows_->read(ex, 0, 0, none), shift);  // refuses what cannot be
  if (shift) {
    origin_ = *shift;
    return;
  }
  OriginSearch search;
  for_coordinates(ex, [&](const PointTable& part) { search.add(ex, input_.source(), part); });
  origin_ = search.origin([&](const Box& box) {
    std::vector<Vec3d> all;
    for_coordinates(ex, [&](const PointTable& part) {
      const std::vector<Vec3d> some = points_beyond(ex, input_.source(), part, box);
      all.insert(all.end(), some.begin(), some.end());
    });
    return all;
  });
}

std::vector<Attribute> FileParts::attributes(exec::Cpu& ex) const {
  Bytes none;
  return std::move(assemble(ex, input_.source(), rows_->read(ex, 0, 0, none), Vec3d{}).attributes);
}

bool FileParts::has_normals(exec::Cpu& ex) const {
  Bytes none;
  return io::has_normals(rows_->read(ex, 0, 0, none));
}

PointsAround FileParts::extent(exec::Cpu& ex) const {
  PointsAround found{origin_, {}, 0};
  for_coordinates(ex, [&](const PointTable& part) {
    const Cloud cloud = assemble(ex, input_.source(), part, origin_);
    found.add(bounds_of(cloud.positions), cloud.size());
  });
  return found;
}

Cloud FileParts::read(exec::Cpu& ex, std::int64_t first, std::int64_t count, Bytes& buffer) const {
  Cloud cloud = assemble(ex, input_.source(), rows_->read(ex, first, count, buffer), origin_);
  if (!keeps_zero_normals_ && std::find(cloud.normals.begin(), cloud.normals.end(), Vec3f{}) != cloud.normals.end()) {
    std::vector<bool> keep(cloud.normals.size());
    std::transform(cloud.normals.begin(), cloud.normals.end(), keep.begin(),
                   [](const Vec3f& n) { return n != Vec3f{}; });
    const std::int64_t not_finite = cloud.dropped;
    keep_where(cloud, keep);
    cloud.dropped = not_finite;
  }
  return cloud;
}

void FileParts::for_parts(exec::Cpu& ex, std::int64_t begin, std::int64_t end,
                          const std::function<void(Cloud&)>& use) const {
  Bytes buffer;
  const std::int64_t step = rows_at_once(*rows_);
  for (std::int64_t first = begin; first < end; first += step) {
    Cloud cloud = read(ex, first, std::min(step, end - first), buffer);
    use(cloud);
  }
}

}  // namespace pointskin::io
