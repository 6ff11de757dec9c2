#include <pointskin/error.hpp>

#include <algorithm>
#include <cstring>
#include <iterator>
#include <optional>
#include <type_traits>
#include <unordered_set>
#include <utility>

#include "core/format.hpp"
#include "exec/any_space.hpp"
#include "io/mesh_checks.hpp"
#include "io/ply_header.hpp"
#include "io/writers.hpp"

namespace pointskin::io {
namespace {

constexpr std::size_t kFaceBytes = 13;

template <class T>
void store(char* to, T value) {
  std::memcpy(to, &value, sizeof(T));
}

/// A property name is a word: blanks and control characters become '_'.
std::string property_name(const std::string& name) {
  std::string word = name.empty() ? "_" : name;
  for (char& c : word)
    if (static_cast<unsigned char>(c) <= ' ' || c == 0x7f) c = '_';
  return word;
}

/// The type of the property that holds an attribute: its own, but
/// - of labels that are missing somewhere the float type that holds them and NaN: 0 would be a label, too. In colours
///   and the like, which other programs expect as bytes, what is missing is 0;
/// - of integers of 64 bits, which PLY lacks, int or uint if those hold all of them, else double.
AttributeType stored_type(const Attribute& attribute) {
  const AttributeValues& values = attribute.values;
  if (values.has_mask() && attribute.is_label()) return type_with_nan(values.type());
  if (!is_integer(values.type()) || size_of(values.type()) < 8) return values.type();
  const auto fits = [&](auto tag) {
    return values.visit([&](const auto& all) {
      return std::all_of(all.begin(), all.end(), [](auto v) {
        if constexpr (std::is_integral_v<decltype(v)>) return std::in_range<decltype(tag)>(v);
        return false;
      });
    });
  };
  if (fits(std::int32_t{})) return AttributeType::int32;
  return fits(std::uint32_t{}) ? AttributeType::uint32 : AttributeType::float64;
}

/// What the header tells of the vertices.
struct VertexRow {
  std::size_t count = 0;
  bool wide = false;  ///< coordinates are double
  bool normals = false;
  std::vector<std::string> names{};  ///< of the attributes
  std::vector<AttributeType> types{};

  [[nodiscard]] std::size_t bytes() const {
    std::size_t sum = wide ? 3 * sizeof(double) : 3 * sizeof(float);
    if (normals) sum += sizeof(Vec3f);
    for (const AttributeType type : types) sum += size_of(type);
    return sum;
  }
};

VertexRow row_of(const VertexArrays& v) {
  VertexRow row{v.positions.size(), v.is_wide(), !v.normals.empty(), {}, stored_types(v)};
  for (const Attribute& attribute : v.attributes) row.names.push_back(property_name(attribute.name));
  return row;
}

std::string vertex_header(const VertexRow& row, const char* encoding) {
  std::string header = fmt::format("ply\nformat {} 1.0\nelement vertex {}\n", encoding, row.count);
  std::unordered_set<std::string> names;
  const auto add = [&](const char* property_type, const std::string& name) {
    if (!names.insert(name).second)
      throw Error(ErrorCode::usage, fmt::format("two properties are named '{}'; rename an attribute", name));
    fmt::format_to(std::back_inserter(header), "property {} {}\n", property_type, name);
  };
  for (const char* axis : {"x", "y", "z"}) add(row.wide ? "double" : "float", axis);
  if (row.normals)
    for (const char* axis : {"nx", "ny", "nz"}) add("float", axis);
  for (std::size_t a = 0; a < row.types.size(); ++a) add(ply_name_of(row.types[a]), row.names[a]);
  return header;
}

std::string whole_header(const VertexRow& row, std::optional<std::size_t> faces, const char* encoding) {
  std::string header = vertex_header(row, encoding);
  if (faces)
    fmt::format_to(std::back_inserter(header), "element face {}\nproperty list uchar int vertex_indices\n", *faces);
  return header + "end_header\n";
}

void check_shapes(const VertexArrays& v) {
  const std::size_t n = v.positions.size();
  if (!v.normals.empty() && v.normals.size() != n)
    throw Error(ErrorCode::usage, fmt::format("{} normals for {} vertices", v.normals.size(), n));
  for (const Attribute& a : v.attributes)
    if (a.values.size() != n)
      throw Error(ErrorCode::usage,
                  fmt::format("{} values of '{}' for {} vertices", a.values.size(), property_name(a.name), n));
}

/// A range of rows and where it goes to.
struct RowRange {
  std::size_t first, last, row_bytes;

  /// Calls put(place, row) for every row, the first of which begins at `to`.
  template <class F>
  void for_each(char* to, const F& put) const {
    for (std::size_t i = first; i < last; ++i, to += row_bytes) put(to, i);
  }
};

void store_values(const AttributeValues& values, AttributeType type, const RowRange& rows, char* to) {
  if (type == values.type())
    return values.visit(
        [&](const auto& all) { rows.for_each(to, [&](char* at, std::size_t i) { store(at, all[i]); }); });
  visit_type(type, [&](auto tag) {
    rows.for_each(to, [&](char* at, std::size_t i) { store(at, static_cast<decltype(tag)>(values.at(i))); });
  });
}

/// Writes rows, the first one to `out`, column by column.
void store_rows(const VertexArrays& v, const std::vector<AttributeType>& types, const RowRange& rows, char* out) {
  if (!v.is_wide()) {
    rows.for_each(out, [&](char* to, std::size_t i) { store(to, v.positions[i]); });
    out += sizeof(Vec3f);
  } else {
    rows.for_each(out, [&](char* to, std::size_t i) { store(to, world(v.origin, v.positions[i])); });
    out += sizeof(Vec3d);
  }
  if (!v.normals.empty()) {
    rows.for_each(out, [&](char* to, std::size_t i) { store(to, v.normals[i]); });
    out += sizeof(Vec3f);
  }
  for (std::size_t a = 0; a < types.size(); out += size_of(types[a++]))
    store_values(v.attributes[a].values, types[a], rows, out);
}

void store_faces(const std::vector<Triangle>& triangles, std::size_t first, std::size_t last, char* out) {
  for (std::size_t t = first; t < last; ++t, out += kFaceBytes) {
    *out = 3;
    std::memcpy(out + 1, triangles[t].data(), sizeof(Triangle));
  }
}

/// Makes room for `rows` rows at the end. @returns where they begin
char* append_rows(std::string& bytes, std::size_t rows, std::size_t row_bytes) {
  const std::size_t before = bytes.size();
  bytes.resize(before + rows * row_bytes);
  return bytes.data() + before;
}

/// Parts of arrays in the memory of a device, for any thread.
class Parts {
 public:
  /// Waits for what makes the arrays.
  explicit Parts(Workspace workspace) : workspace_(std::move(workspace)) { workspace_.synchronize(); }

  template <class T>
  void read(const DeviceSpan<T>& from, std::size_t first, std::size_t last,
            std::vector<std::remove_const_t<T>>& part) const {
    part.resize(last - first);
    exec::visit(workspace_.data().space,
                [&](const auto& ex) { ex.read(from.data + first, part.data(), part.size() * sizeof(T)); });
  }

 private:
  Workspace workspace_;
};

/// What a thread has fetched, in memory that it uses again: blocks are so large that the system would map it anew.
struct Fetched {
  std::vector<Vec3f> positions, normals;
  std::vector<Triangle> triangles;
};
Fetched& fetched() {
  thread_local Fetched memory;
  return memory;
}

}  // namespace

std::string ply_header(const VertexArrays& vertices, const std::vector<Triangle>* triangles, const char* encoding) {
  check_shapes(vertices);
  return whole_header(row_of(vertices), triangles != nullptr ? std::optional(triangles->size()) : std::nullopt,
                      encoding);
}

std::vector<AttributeType> stored_types(const VertexArrays& vertices) {
  std::vector<AttributeType> types;
  for (const Attribute& attribute : vertices.attributes) types.push_back(stored_type(attribute));
  return types;
}

Blocks format_ply_cloud(const Cloud& cloud, const WriteOptions& options) {
  const auto format = options.ascii ? format_ply_ascii : format_ply;
  return format({cloud.origin, cloud.positions, cloud.normals, cloud.attributes, options.double_coordinates}, nullptr);
}

Blocks format_ply_mesh(const Mesh& mesh, const WriteOptions& options) {
  const auto format = options.ascii ? format_ply_ascii : format_ply;
  return format({mesh.origin, mesh.vertices, mesh.normals, mesh.attributes, options.double_coordinates},
                &mesh.triangles);
}

Blocks format_ply(const VertexArrays& vertices, const std::vector<Triangle>* triangles) {
  std::string header = ply_header(vertices, triangles, "binary_little_endian");
  const std::vector<AttributeType> types = stored_types(vertices);
  const std::size_t row_bytes = row_of(vertices).bytes();
  const auto append_vertices = [vertices, types, row_bytes](std::size_t first, std::size_t last, std::string& bytes) {
    store_rows(vertices, types, {first, last, row_bytes}, append_rows(bytes, last - first, row_bytes));
  };
  const auto append_faces = [triangles](std::size_t first, std::size_t last, std::string& bytes) {
    store_faces(*triangles, first, last, append_rows(bytes, last - first, kFaceBytes));
  };
  const std::size_t faces = triangles != nullptr ? triangles->size() : 0;
  return cut_into_blocks(std::move(header),
                         {{vertices.positions.size(), append_vertices, row_bytes}, {faces, append_faces, kFaceBytes}});
}

Blocks format_ply_parts(const MeshParts& mesh, bool double_coordinates) {
  VertexRow row{static_cast<std::size_t>(mesh.vertices), double_coordinates || !is_zero(mesh.origin),
                mesh.normals != nullptr};
  for (const MeshParts::AttributeParts& attribute : mesh.attributes) {
    row.names.push_back(property_name(attribute.name));
    row.types.push_back(attribute.type);
  }
  const auto append_vertices = [mesh, row](std::size_t first, std::size_t last, std::string& bytes) {
    auto& [positions, normals, triangles] = fetched();
    mesh.positions(first, last, positions);
    check_finite("vertex", first, positions);
    normals.clear();
    if (row.normals) mesh.normals(first, last, normals);
    check_finite("the normal of vertex", first, normals);
    std::vector<Attribute> attributes;
    for (const MeshParts::AttributeParts& attribute : mesh.attributes)
      attributes.push_back({attribute.name, attribute.values(first, last)});
    store_rows({mesh.origin, positions, normals, attributes, row.wide}, row.types, {0, last - first, row.bytes()},
               append_rows(bytes, last - first, row.bytes()));
  };
  const auto append_faces = [mesh](std::size_t first, std::size_t last, std::string& bytes) {
    std::vector<Triangle>& triangles = fetched().triangles;
    mesh.corners(first, last, triangles);
    check_corners(mesh.vertices, triangles);
    store_faces(triangles, 0, triangles.size(), append_rows(bytes, triangles.size(), kFaceBytes));
  };
  const auto faces = static_cast<std::size_t>(mesh.triangles);
  return cut_into_blocks(whole_header(row, faces, "binary_little_endian"),
                         {{row.count, append_vertices, row.bytes()}, {faces, append_faces, kFaceBytes}});
}

Blocks format_device_ply(const Workspace& workspace, const DeviceMesh& mesh, bool double_coordinates) {
  if (!mesh.normals.empty() && mesh.normals.size != mesh.vertices.size)
    throw Error(ErrorCode::usage, fmt::format("{} normals for {} vertices", mesh.normals.size, mesh.vertices.size));
  const Parts parts(workspace);
  const VertexRow row{static_cast<std::size_t>(mesh.vertices.size), double_coordinates || !is_zero(mesh.origin),
                      !mesh.normals.empty()};
  const auto append_vertices = [parts, mesh, row](std::size_t first, std::size_t last, std::string& bytes) {
    auto& [positions, normals, triangles] = fetched();
    parts.read(mesh.vertices, first, last, positions);
    check_finite("vertex", first, positions);
    normals.clear();
    if (row.normals) parts.read(mesh.normals, first, last, normals);
    check_finite("the normal of vertex", first, normals);
    const std::vector<Attribute> none;
    store_rows({mesh.origin, positions, normals, none, row.wide}, {}, {0, last - first, row.bytes()},
               append_rows(bytes, last - first, row.bytes()));
  };
  const auto append_faces = [parts, mesh](std::size_t first, std::size_t last, std::string& bytes) {
    std::vector<Triangle>& triangles = fetched().triangles;
    parts.read(mesh.triangles, first, last, triangles);
    check_corners(mesh.vertices.size, triangles);
    store_faces(triangles, 0, triangles.size(), append_rows(bytes, triangles.size(), kFaceBytes));
  };
  const auto faces = static_cast<std::size_t>(mesh.triangles.size);
  return cut_into_blocks(whole_header(row, faces, "binary_little_endian"),
                         {{row.count, append_vertices, row.bytes()}, {faces, append_faces, kFaceBytes}});
}

}  // namespace pointskin::io
