#include "io/cloud_parts.hpp"

#include <pointskin/merge.hpp>

#include <algorithm>
#include <filesystem>
#include <system_error>
#include <utility>
#include <vector>

#include "io/numpy_table.hpp"
#include "io/ply_body.hpp"
#include "io/ply_header.hpp"
#include "io/shift.hpp"

namespace pointskin::io {
namespace {

/// @throws Error invalid_input if there is none
bool is_regular(const std::string& path) {
  std::error_code error;
  const std::filesystem::file_status status = std::filesystem::status(path, error);
  if (path != "-" && status.type() == std::filesystem::file_type::not_found) (void)Input(path);  // tells so
  return path != "-" && std::filesystem::is_regular_file(status);
}

/// The vertices of a binary PLY file; nothing where rows have lists: only walking over them shows that the file is
/// whole.
std::optional<PointTable> vertices_in_place(const Source& source) {
  const PlyHeader header = parse_ply_header(source);
  if (header.encoding == PlyEncoding::ascii) return std::nullopt;
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
  if (is_ply(source.bytes)) return vertices_in_place(source);
  if (is_npy(source.bytes)) return table_of(source, parse_npy(source)).table();
  return std::nullopt;
}

/// Rows that are read at once; whole runs of OriginSearch.
std::int64_t rows_at_once(const TableParts& table) {
  const std::int64_t row_bytes = std::max<std::int64_t>(1, table.row_bytes());
  return std::max(kRunRows, CloudParts::kBufferBytes / row_bytes / kRunRows * kRunRows);
}

PointTable coordinates_of(PointTable table) {
  std::erase_if(table.columns, [](const Column& column) { return !is_coordinate(column.name); });
  return table;
}

}  // namespace

std::unique_ptr<CloudParts> CloudParts::open(const std::string& path) {
  if (!is_regular(path)) return nullptr;
  std::unique_ptr<CloudParts> parts(new CloudParts(path));
  const std::optional<PointTable> table = points_in_place(parts->input_.source());
  if (!table || !TableParts::holds(parts->input_, *table)) return nullptr;
  parts->rows_.emplace(parts->input_, *table);
  parts->coordinates_.emplace(parts->input_, coordinates_of(*table));
  return parts;
}

void CloudParts::choose_origin(exec::Cpu& ex, const std::optional<Vec3d>& shift) {
  if (shift) {
    Bytes none;
    assemble(ex, input_.source(), rows_->read(0, 0, none), shift);  // refuses what cannot be
    origin_ = *shift;
    return;
  }
  Bytes buffer;
  const std::int64_t step = rows_at_once(*coordinates_);
  const auto for_parts = [&](const auto& use) {
    for (std::int64_t first = 0; first < rows(); first += step)
      use(coordinates_->read(first, std::min(step, rows() - first), buffer));
  };
  OriginSearch search;
  for_parts([&](const PointTable& part) { search.add(ex, input_.source(), part); });
  origin_ = search.origin([&](const Box& box) {
    std::vector<Vec3d> all;
    for_parts([&](const PointTable& part) {
      const std::vector<Vec3d> some = points_beyond(ex, input_.source(), part, box);
      all.insert(all.end(), some.begin(), some.end());
    });
    return all;
  });
}

std::vector<Attribute> CloudParts::attributes(exec::Cpu& ex) const {
  Bytes none;
  return std::move(assemble(ex, input_.source(), rows_->read(0, 0, none), Vec3d{}).attributes);
}

Cloud CloudParts::read(exec::Cpu& ex, std::int64_t first, std::int64_t count, Bytes& buffer) const {
  Cloud cloud = assemble(ex, input_.source(), rows_->read(first, count, buffer), origin_);
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

void CloudParts::for_parts(exec::Cpu& ex, std::int64_t begin, std::int64_t end,
                           const std::function<void(Cloud&)>& use) const {
  Bytes buffer;
  const std::int64_t step = rows_at_once(*rows_);
  for (std::int64_t first = begin; first < end; first += step) {
    Cloud cloud = read(ex, first, std::min(step, end - first), buffer);
    use(cloud);
  }
}

}  // namespace pointskin::io
