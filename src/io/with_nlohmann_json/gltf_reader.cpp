// Meshes and points of glTF 2.0: all primitives of the scene, where its nodes put them.
#include <pointskin/error.hpp>
#include <pointskin/merge.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "core/format.hpp"
#include "core/vec3.hpp"
#include "io/gltf.hpp"
#include "io/pieces.hpp"
#include "io/readers.hpp"
#include "io/with_nlohmann_json/gltf_document.hpp"

namespace pointskin::io {
namespace {

using Json = nlohmann::ordered_json;

/// Column by column, as glTF has it.
using Matrix = std::array<double, 16>;
constexpr Matrix kIdentity{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1};
constexpr int kDeepest = 64;             ///< of nodes in nodes
constexpr std::size_t kMostUses = 4096;  ///< of meshes by nodes: a small file must not become a large one

Matrix product(const Matrix& a, const Matrix& b) {
  Matrix c{};
  for (std::size_t column = 0; column < 4; ++column)
    for (std::size_t row = 0; row < 4; ++row)
      for (std::size_t k = 0; k < 4; ++k) c[4 * column + row] += a[4 * k + row] * b[4 * column + k];
  return c;
}

Vec3d moved(const Matrix& m, const Vec3d& p) {
  return {m[0] * p.x + m[4] * p.y + m[8] * p.z + m[12], m[1] * p.x + m[5] * p.y + m[9] * p.z + m[13],
          m[2] * p.x + m[6] * p.y + m[10] * p.z + m[14]};
}

double determinant(const Matrix& m) {
  return m[0] * (m[5] * m[10] - m[9] * m[6]) - m[4] * (m[1] * m[10] - m[9] * m[2]) + m[8] * (m[1] * m[6] - m[5] * m[2]);
}

/// A normal by the inverse transpose, as long as it was.
Vec3d turned(const Matrix& m, const Vec3d& n) {
  const Vec3d x{m[0], m[1], m[2]}, y{m[4], m[5], m[6]}, z{m[8], m[9], m[10]};
  const Vec3d t = cross(y, z) * n.x + cross(z, x) * n.y + cross(x, y) * n.z;
  const double size = std::sqrt(squared_length(t));
  const double factor = size > 0 ? std::sqrt(squared_length(n)) / size : 1;
  return t * (determinant(m) < 0 ? -factor : factor);
}

std::vector<double> numbers(const GltfDocument& document, const Json& node, const char* key, std::size_t count) {
  std::vector<double> values;
  const auto at = node.find(key);
  if (at == node.end()) return values;
  if (!at->is_array() || at->size() != count)
    document.fail_here(fmt::format("'{}' of a node is not {} numbers", key, count));
  for (const Json& value : *at) {
    if (!value.is_number() || !std::isfinite(value.get<double>()))
      document.fail_here(fmt::format("'{}' of a node is not {} numbers", key, count));
    values.push_back(value.get<double>());
  }
  return values;
}

Matrix transform_of(const GltfDocument& document, const Json& node) {
  const std::vector<double> given = numbers(document, node, "matrix", 16);
  if (!given.empty()) {
    Matrix m;
    std::copy(given.begin(), given.end(), m.begin());
    return m;
  }
  std::vector<double> t = numbers(document, node, "translation", 3), q = numbers(document, node, "rotation", 4),
                      s = numbers(document, node, "scale", 3);
  if (t.empty()) t = {0, 0, 0};
  if (q.empty()) q = {0, 0, 0, 1};
  if (s.empty()) s = {1, 1, 1};
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  return {(1 - 2 * (y * y + z * z)) * s[0],
          2 * (x * y + z * w) * s[0],
          2 * (x * z - y * w) * s[0],
          0,
          2 * (x * y - z * w) * s[1],
          (1 - 2 * (x * x + z * z)) * s[1],
          2 * (y * z + x * w) * s[1],
          0,
          2 * (x * z + y * w) * s[2],
          2 * (y * z - x * w) * s[2],
          (1 - 2 * (x * x + y * y)) * s[2],
          0,
          t[0],
          t[1],
          t[2],
          1};
}

/// A mesh of the document where a node puts it.
struct Use {
  std::int64_t mesh;
  Matrix transform;
};

void collect(const GltfDocument& document, std::int64_t index, const Matrix& above, int depth, std::vector<Use>& uses) {
  if (depth > kDeepest || uses.size() > kMostUses)
    document.fail_here("its nodes are nested too deeply, or name each other");
  const Json& node = document.item("nodes", index);
  const Matrix here = product(above, transform_of(document, node));
  const std::int64_t mesh = document.whole(node, "mesh", -1);
  if (mesh >= 0) uses.push_back({mesh, here});
  const auto children = node.find("children");
  if (children == node.end()) return;
  if (!children->is_array()) document.fail_here("the children of a node are no list");
  for (const Json& child : *children) {
    if (!child.is_number_integer()) document.fail_here("the children of a node are no numbers");
    collect(document, child.get<std::int64_t>(), here, depth + 1, uses);
  }
}

/// Where the scene's nodes put meshes; a file without scenes shows all its meshes as they are.
std::vector<Use> uses_of(const GltfDocument& document) {
  std::vector<Use> uses;
  const auto meshes = document.json().find("meshes");
  const std::size_t count = meshes != document.json().end() && meshes->is_array() ? meshes->size() : 0;
  if (!document.json().contains("scenes")) {
    for (std::size_t i = 0; i < std::min(count, kMostUses); ++i)
      uses.push_back({static_cast<std::int64_t>(i), kIdentity});
    return uses;
  }
  const Json& scene = document.item("scenes", document.whole(document.json(), "scene", 0));
  const auto nodes = scene.find("nodes");
  if (nodes == scene.end()) return uses;
  if (!nodes->is_array()) document.fail_here("the nodes of a scene are no list");
  for (const Json& node : *nodes) {
    if (!node.is_number_integer()) document.fail_here("the nodes of a scene are no numbers");
    collect(document, node.get<std::int64_t>(), kIdentity, 0, uses);
  }
  return uses;
}

/// Columns of a primitive's vertices, and what they point into.
struct Columns {
  PointTable table;
  std::vector<GltfArray> arrays;
  std::vector<std::vector<double>> doubles;

  void add(const std::string& name, const GltfArray& array, std::size_t component) {
    const auto size = static_cast<std::int64_t>(size_of(array.type));
    table.columns.push_back({name, array.type, array.type, behind(array.bytes.data(), component * size_of(array.type)),
                             size * static_cast<std::int64_t>(array.components), false});
  }
  void add(const std::string& name, AttributeType type, std::vector<double> values) {
    doubles.push_back(std::move(values));
    table.columns.push_back(
        {name, type, AttributeType::float64, reinterpret_cast<const char*>(doubles.back().data()), 8, false});
  }
};

void add_vectors(const std::array<const char*, 3>& names, const GltfArray& array, const Matrix& m, bool normals,
                 Columns& columns) {
  if (m == kIdentity && array.type == AttributeType::float32) {
    for (std::size_t axis = 0; axis < 3; ++axis) columns.add(names[axis], array, axis);
    return;
  }
  std::array<std::vector<double>, 3> moved_values;
  for (std::size_t i = 0; i < array.count; ++i) {
    const Vec3d from{array.share(i, 0), array.share(i, 1), array.share(i, 2)};
    const Vec3d to = normals ? turned(m, from) : moved(m, from);
    for (std::size_t axis = 0; axis < 3; ++axis) moved_values[axis].push_back(to[axis]);
  }
  for (std::size_t axis = 0; axis < 3; ++axis)
    columns.add(names[axis], normals ? AttributeType::float32 : AttributeType::float64, std::move(moved_values[axis]));
}

/// An alpha that is opaque everywhere says nothing.
bool is_opaque(const GltfArray& colours) {
  for (std::size_t i = 0; i < colours.count; ++i)
    if (colours.share(i, 3) < 1) return false;
  return true;
}

void add_attribute(const std::string& semantic, Columns& columns) {
  const GltfArray& array = columns.arrays.back();
  if (semantic == "COLOR_0" && array.components >= 3) {
    constexpr std::array kNames{"red", "green", "blue", "alpha"};
    for (std::size_t c = 0; c < (array.components == 4 && !is_opaque(array) ? 4U : 3U); ++c)
      columns.add(kNames[c], array, c);
  } else if (semantic.starts_with('_') && semantic.size() > 1) {
    for (std::size_t c = 0; c < array.components; ++c)
      columns.add(array.components == 1 ? semantic.substr(1) : fmt::format("{}_{}", semantic.substr(1), c), array, c);
  }
}

/// What is needed of a primitive's attributes.
Columns columns_of(const GltfDocument& document, const Json& primitive, const Matrix& m) {
  const auto attributes = primitive.find("attributes");
  if (attributes == primitive.end() || !attributes->is_object()) document.fail_here("a primitive has no attributes");
  Columns columns;
  columns.arrays.reserve(attributes->size());
  columns.doubles.reserve(6);
  const std::int64_t position = document.whole(*attributes, "POSITION", -1);
  if (position < 0) return columns;
  columns.arrays.push_back(document.array(position));
  if (columns.arrays[0].components != 3) document.fail_here("positions are not three numbers each");
  const std::size_t rows = columns.arrays[0].count;
  columns.table.rows = static_cast<std::int64_t>(rows);
  add_vectors({"x", "y", "z"}, columns.arrays[0], m, false, columns);
  for (const auto& [semantic, value] : attributes->items()) {
    if (semantic != "NORMAL" && semantic != "COLOR_0" && !semantic.starts_with('_')) continue;
    columns.arrays.push_back(document.array(document.whole(*attributes, semantic.c_str(), -1)));
    const GltfArray& array = columns.arrays.back();
    if (array.count != rows)
      document.fail_here(fmt::format("{} has {} values for {} vertices", in_quotes(semantic), array.count, rows));
    if (semantic != "NORMAL")
      add_attribute(semantic, columns);
    else if (array.components == 3)
      add_vectors({"nx", "ny", "nz"}, array, m, true, columns);
  }
  return columns;
}

std::vector<std::int64_t> corners_of(const GltfDocument& document, const Json& primitive, std::int64_t rows) {
  const std::int64_t accessor = document.whole(primitive, "indices", -1);
  std::vector<std::int64_t> corners;
  if (accessor < 0) {
    for (std::int64_t i = 0; i < rows; ++i) corners.push_back(i);
    return corners;
  }
  const GltfArray array = document.array(accessor);
  if (!is_integer(array.type) || array.components != 1) document.fail_here("indices are not whole numbers");
  corners.reserve(array.count);
  for (std::size_t i = 0; i < array.count; ++i) {
    const auto corner = static_cast<std::int64_t>(array.at(i, 0));
    if (corner < 0 || corner >= rows)
      document.fail_here(fmt::format("a face names vertex {}, but there are {}", corner, rows));
    corners.push_back(corner);
  }
  return corners;
}

/// The triangles of a list, a strip or a fan; none of lines and points.
void add_triangles(const std::vector<std::int64_t>& corners, std::int64_t mode, bool mirrored,
                   std::vector<Triangle>& triangles) {
  const std::size_t step = mode == 4 ? 3 : 1;
  for (std::size_t i = 0; (mode == 4 || mode == 5 || mode == 6) && i + 2 < corners.size(); i += step) {
    std::array<std::int64_t, 3> ids{mode == 6 ? corners[0] : corners[i], corners[i + 1], corners[i + 2]};
    if ((mode == 5 && i % 2 == 1) != mirrored) std::swap(ids[1], ids[2]);
    triangles.push_back(
        {static_cast<std::int32_t>(ids[0]), static_cast<std::int32_t>(ids[1]), static_cast<std::int32_t>(ids[2])});
  }
}

Pieces read_pieces(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  const GltfDocument document(source);
  Pieces pieces(ex, source, options);
  for (const Use& use : uses_of(document)) {
    const Json& mesh = document.item("meshes", use.mesh);
    const auto primitives = mesh.find("primitives");
    if (primitives == mesh.end() || !primitives->is_array()) document.fail_here("a mesh has no primitives");
    for (const Json& primitive : *primitives) {
      if (!primitive.is_object()) document.fail_here("a primitive is no object");
      const Columns columns = columns_of(document, primitive, use.transform);
      if (columns.table.rows == 0) continue;
      check_vertex_count(source, columns.table.rows);
      std::vector<Triangle> triangles;
      add_triangles(corners_of(document, primitive, columns.table.rows), document.whole(primitive, "mode", 4),
                    determinant(use.transform) < 0, triangles);
      pieces.add(columns.table, triangles);
    }
  }
  return pieces;
}

}  // namespace

bool is_glb(std::string_view start) { return start.starts_with("glTF"); }

bool gltf_announces_faces(std::string_view start) {
  constexpr std::string_view kKey = "\"mode\"";
  bool any = false;
  for (std::size_t at = start.find(kKey); at != std::string_view::npos; at = start.find(kKey, at + 1)) {
    const std::size_t digit = start.find_first_of("0123456789", at + kKey.size());
    if (digit != std::string_view::npos && start[digit] >= '4') return true;
    any = true;
  }
  return !any;
}

Mesh parse_gltf_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  return read_pieces(ex, source, options).take_mesh();
}

Cloud parse_gltf_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  return read_pieces(ex, source, options).take_cloud();
}

}  // namespace pointskin::io
