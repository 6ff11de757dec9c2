// Arrays of other programs take the way of all files: columns that become a cloud.
#include <pointskin/arrays.hpp>
#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <string>
#include <utility>

#include "core/format.hpp"
#include "io/blocks.hpp"
#include "io/point_table.hpp"
#include "io/readers.hpp"
#include "io/scalar.hpp"

namespace pointskin {
namespace {

[[noreturn]] void fail_usage(const std::string& story) { throw Error(ErrorCode::usage, story); }

void check_shape(const char* what, const StridedArray& array, std::int64_t rows, int components) {
  if (array.rows < 0 || array.rows != rows || array.components != components)
    fail_usage(fmt::format("{} must have the shape ({}, {}), not ({}, {})", what, rows, components, array.rows,
                           array.components));
  if (array.data == nullptr && rows > 0) fail_usage(fmt::format("{} must not be null", what));
}

io::Column column_of(std::string name, const StridedArray& array, int component) {
  const char* data = static_cast<const char*>(array.data);
  if (data != nullptr) data += component * array.component_stride_bytes;
  return {std::move(name), array.type, array.type, data, array.row_stride_bytes, false};
}

void add_three(io::PointTable& table, const StridedArray& array, const char* const (&names)[3]) {
  for (int axis = 0; axis < 3; ++axis) table.columns.push_back(column_of(names[axis], array, axis));
}

bool is_finite_row(const StridedArray& array, std::int64_t row) {
  return visit_type(array.type, [&](auto tag) {
    const char* at = static_cast<const char*>(array.data) + row * array.row_stride_bytes;
    for (int axis = 0; axis < 3; ++axis)
      if (!(std::abs(static_cast<double>(io::load<decltype(tag)>(at + axis * array.component_stride_bytes, false))) <=
            io::kLargestCoordinate))
        return false;
    return true;
  });
}

/// Takes values away that are said to be missing, of the points that were kept.
void apply_masks(const StridedPoints& points, Cloud& cloud) {
  for (std::size_t a = 0; a < points.attributes.size(); ++a) {
    const std::uint8_t* missing = points.attributes[a].missing;
    if (missing == nullptr) continue;
    AttributeValues& values = cloud.attributes[a].values;
    std::size_t to = 0;
    for (std::int64_t row = 0; row < points.positions.rows; ++row) {
      if (cloud.dropped > 0 && !is_finite_row(points.positions, row)) continue;
      if (missing[row] != 0) values.set_missing(to);
      ++to;
    }
  }
}

io::PointTable table_of(const StridedPoints& points) {
  const std::int64_t rows = points.positions.rows;
  check_shape("positions", points.positions, rows, 3);
  io::PointTable table{rows, {}};
  add_three(table, points.positions, {"x", "y", "z"});
  if (points.normals.exists()) {
    check_shape("normals", points.normals, rows, 3);
    add_three(table, points.normals, {"nx", "ny", "nz"});
  }
  for (const StridedAttribute& attribute : points.attributes) {
    check_shape(("the attribute " + attribute.name).c_str(), attribute.values, rows, 1);
    table.columns.push_back(column_of(attribute.name, attribute.values, 0));
  }
  return table;
}

/// Columns go by their names, and those of positions and normals are taken.
void check_names(const StridedPoints& points) {
  for (const StridedAttribute& attribute : points.attributes)
    for (const char* taken : {"x", "y", "z", "nx", "ny", "nz", "normal_x", "normal_y", "normal_z"})
      if (attribute.name == taken)
        fail_usage("an attribute must not be called " + attribute.name + ": that is a position's or a normal's name");
}

const io::Source kArrays{"the arrays", {}};

std::vector<Triangle> triangles_of(exec::Cpu& ex, const StridedArray& array, std::int64_t vertices) {
  check_shape("triangles", array, array.rows, 3);
  if (!is_integer(array.type)) fail_usage("triangles must be integers");
  std::vector<Triangle> triangles(static_cast<std::size_t>(array.rows));
  constexpr std::int64_t kBlockRows = 1 << 14;
  io::run_in_order(ex, (array.rows + kBlockRows - 1) / kBlockRows, [&](std::int64_t block) {
    const std::int64_t end = std::min(array.rows, (block + 1) * kBlockRows);
    for (std::int64_t row = block * kBlockRows; row < end; ++row)
      for (std::size_t corner = 0; corner < 3; ++corner) {
        const char* at = static_cast<const char*>(array.data) + row * array.row_stride_bytes +
                         static_cast<std::int64_t>(corner) * array.component_stride_bytes;
        const std::int64_t id = io::load_integer(array.type, at, false);
        if (id < 0 || id >= vertices)
          throw Error(ErrorCode::invalid_input,
                      fmt::format("triangle {} names vertex {}, but there are {}", row, id, vertices));
        triangles[static_cast<std::size_t>(row)][corner] = static_cast<std::int32_t>(id);
      }
  });
  return triangles;
}

}  // namespace

Cloud cloud_of(const StridedPoints& points, const ReadOptions& options) {
  check_names(points);
  exec::Cpu ex(options.threads);
  Cloud cloud = io::assemble(ex, kArrays, table_of(points), options.shift);
  apply_masks(points, cloud);
  cloud.origin = cloud.origin + points.origin;
  return cloud;
}

Mesh mesh_of(const StridedPoints& vertices, const StridedArray& triangles, const ReadOptions& options) {
  check_names(vertices);
  exec::Cpu ex(options.threads);
  const io::PointTable table = table_of(vertices);
  io::check_vertex_count(kArrays, table.rows);
  Mesh mesh = io::assemble_mesh(ex, kArrays, table, triangles_of(ex, triangles, table.rows), options);
  Cloud masked;
  masked.attributes = std::move(mesh.attributes);
  apply_masks(vertices, masked);
  mesh.attributes = std::move(masked.attributes);
  mesh.origin = mesh.origin + vertices.origin;
  return mesh;
}

std::vector<Vec3d> vectors_of(const StridedArray& array) {
  check_shape("points", array, array.rows, 3);
  std::vector<Vec3d> vectors(static_cast<std::size_t>(array.rows));
  visit_type(array.type, [&](auto tag) {
    const char* at = static_cast<const char*>(array.data);
    for (Vec3d& vector : vectors) {
      for (int axis = 0; axis < 3; ++axis)
        vector[static_cast<std::size_t>(axis)] =
            static_cast<double>(io::load<decltype(tag)>(at + axis * array.component_stride_bytes, false));
      at += array.row_stride_bytes;
    }
  });
  return vectors;
}

bool are_finite(const StridedPoints& points, int threads) {
  table_of(points);
  exec::Cpu ex(threads);
  constexpr std::int64_t kBlockRows = 1 << 14;
  const std::int64_t rows = points.positions.rows;
  const std::int64_t blocks = (rows + kBlockRows - 1) / kBlockRows;
  std::vector<char> finite(static_cast<std::size_t>(blocks), 1);
  ex.run_blocks(blocks, [&](std::int64_t block) {
    const std::int64_t end = std::min(rows, (block + 1) * kBlockRows);
    for (std::int64_t row = block * kBlockRows; row < end; ++row)
      if (!is_finite_row(points.positions, row) || (points.normals.exists() && !is_finite_row(points.normals, row)))
        finite[static_cast<std::size_t>(block)] = 0;
  });
  return std::find(finite.begin(), finite.end(), 0) == finite.end();
}

bool is_used_in_place(const StridedPoints& points) {
  const auto fits = [](const StridedArray& a) { return a.type == AttributeType::float32 && a.is_packed(); };
  return fits(points.positions) && (!points.normals.exists() || fits(points.normals));
}

}  // namespace pointskin
