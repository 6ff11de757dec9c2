// VTK's XML files, .vtp and .vtu: one piece, whose arrays follow the XML as they are.
// Source: Kitware, "VTK XML formats", docs.vtk.org.
#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <utility>
#include <vector>

#include "core/format.hpp"
#include "io/text_lines.hpp"
#include "io/writers.hpp"

namespace pointskin::io {
namespace {

enum class Kind { polygons, grid };

const char* vtk_name(AttributeType type) {
  switch (type) {
    case AttributeType::int8:
      return "Int8";
    case AttributeType::uint8:
      return "UInt8";
    case AttributeType::int16:
      return "Int16";
    case AttributeType::uint16:
      return "UInt16";
    case AttributeType::int32:
      return "Int32";
    case AttributeType::uint32:
      return "UInt32";
    case AttributeType::int64:
      return "Int64";
    case AttributeType::uint64:
      return "UInt64";
    case AttributeType::float32:
      return "Float32";
    case AttributeType::float64:
      break;
  }
  return "Float64";
}

std::string escaped(const std::string& text) {
  std::string out;
  for (const char c : text) {
    if (c == '&')
      out += "&amp;";
    else if (c == '<')
      out += "&lt;";
    else if (c == '"')
      out += "&quot;";
    else
      out += c;
  }
  return out;
}

/// Collects arrays: what the XML says of them, and their bytes, each behind its length.
class Arrays {
 public:
  /// @param store  writes row i at a place
  template <class Store>
  void add(const std::string& name, AttributeType type, std::size_t components, std::size_t rows, const Store& store) {
    const std::size_t row_bytes = components * size_of(type);
    const std::uint64_t bytes = rows * row_bytes;
    xml_ += fmt::format(
        "<DataArray type=\"{}\" Name=\"{}\" NumberOfComponents=\"{}\" format=\"appended\" offset=\"{}\"/>\n",
        vtk_name(type), escaped(name), components, offset_);
    offset_ += sizeof(bytes) + bytes;
    sections_.push_back({1, [bytes](std::size_t, std::size_t, std::string& out) {
                           out.append(reinterpret_cast<const char*>(&bytes), sizeof(bytes));
                         }});
    sections_.push_back({rows, [store, row_bytes](std::size_t first, std::size_t last, std::string& out) {
                           const std::size_t before = out.size();
                           out.resize(before + (last - first) * row_bytes);
                           for (std::size_t i = first; i < last; ++i)
                             store(i, out.data() + before + (i - first) * row_bytes);
                         }});
  }

  void open(const std::string& element) { xml_ += "<" + element + ">\n"; }
  void close(const std::string& element) { xml_ += "</" + element + ">\n"; }

  Blocks finish() {
    sections_.push_back(
        {1, [](std::size_t, std::size_t, std::string& out) { out += "\n</AppendedData>\n</VTKFile>\n"; }});
    return cut_into_blocks(xml_ + "<AppendedData encoding=\"raw\">\n_", std::move(sections_));
  }

 private:
  std::string xml_ = "<?xml version=\"1.0\"?>\n";
  std::uint64_t offset_ = 0;
  std::vector<Section> sections_;
};

template <class T>
void put(char* to, std::size_t place, T value) {
  std::memcpy(to + place * sizeof(T), &value, sizeof(T));
}

void add_points(const VertexArrays& vertices, Arrays& to) {
  to.open("Points");
  const std::size_t rows = vertices.positions.size();
  if (is_zero(vertices.origin))
    to.add("Points", AttributeType::float32, 3, rows,
           [vertices](std::size_t i, char* out) { put(out, 0, vertices.positions[i]); });
  else
    to.add("Points", AttributeType::float64, 3, rows,
           [vertices](std::size_t i, char* out) { put(out, 0, world(vertices.origin, vertices.positions[i])); });
  to.close("Points");
}

void add_point_data(const VertexArrays& vertices, Arrays& to) {
  const std::size_t rows = vertices.positions.size();
  to.open(vertices.normals.empty() ? "PointData" : "PointData Normals=\"Normals\"");
  if (!vertices.normals.empty())
    to.add("Normals", AttributeType::float32, 3, rows,
           [vertices](std::size_t i, char* out) { put(out, 0, vertices.normals[i]); });
  const std::vector<const Attribute*> colour = byte_colours(vertices.attributes, false);
  if (!colour.empty())
    to.add("RGB", AttributeType::uint8, 3, rows, [colour](std::size_t i, char* out) {
      for (std::size_t c = 0; c < 3; ++c) put(out, c, colour[c]->values.as<std::uint8_t>()[i]);
    });
  for (const Attribute& attribute : vertices.attributes) {
    if (std::find(colour.begin(), colour.end(), &attribute) != colour.end()) continue;
    const AttributeValues& values = attribute.values;
    const AttributeType type = values.has_mask() ? type_with_nan(values.type()) : values.type();
    to.add(attribute.name, type, 1, rows, [&values, type](std::size_t i, char* out) {
      if (type != values.type())
        return type == AttributeType::float32 ? put(out, 0, static_cast<float>(values.at(i)))
                                              : put(out, 0, values.at(i));
      values.visit([&](const auto& all) { put(out, 0, all[i]); });
    });
  }
  to.close("PointData");
}

/// Cells of `corners` corners each; of points, cell i is point i.
void add_cells(const char* element, std::size_t cells, std::size_t corners, const std::vector<Triangle>* triangles,
               Arrays& to) {
  to.open(element);
  to.add("connectivity", AttributeType::int64, 1, cells * corners, [triangles](std::size_t i, char* out) {
    put(out, 0, triangles == nullptr ? static_cast<std::int64_t>(i) : std::int64_t{(*triangles)[i / 3][i % 3]});
  });
  to.add("offsets", AttributeType::int64, 1, cells,
         [corners](std::size_t i, char* out) { put(out, 0, static_cast<std::int64_t>((i + 1) * corners)); });
  if (std::string(element) == "Cells") {
    constexpr std::uint8_t kVertex = 1, kTriangle = 5;
    to.add("types", AttributeType::uint8, 1, cells,
           [type = triangles == nullptr ? kVertex : kTriangle](std::size_t, char* out) { put(out, 0, type); });
  }
  to.close(element);
}

Blocks format_vtk_xml(Kind kind, const VertexArrays& vertices, const std::vector<Triangle>* triangles) {
  const std::size_t points = vertices.positions.size();
  check_attributes(vertices);
  if (triangles != nullptr && triangles->empty()) triangles = nullptr;
  const std::size_t cells = triangles != nullptr ? triangles->size() : points;
  const std::string type = kind == Kind::polygons ? "PolyData" : "UnstructuredGrid";
  Arrays arrays;
  arrays.open(
      fmt::format("VTKFile type=\"{}\" version=\"1.0\" byte_order=\"LittleEndian\" header_type=\"UInt64\"", type));
  arrays.open(type);
  if (kind == Kind::grid)
    arrays.open(fmt::format("Piece NumberOfPoints=\"{}\" NumberOfCells=\"{}\"", points, cells));
  else
    arrays.open(
        fmt::format("Piece NumberOfPoints=\"{}\" NumberOfVerts=\"{}\" NumberOfLines=\"0\" NumberOfStrips=\"0\" "
                    "NumberOfPolys=\"{}\"",
                    points, triangles == nullptr ? points : 0, triangles == nullptr ? 0 : cells));
  add_points(vertices, arrays);
  add_cells(kind == Kind::grid     ? "Cells"
            : triangles != nullptr ? "Polys"
                                   : "Verts",
            cells, triangles != nullptr ? 3 : 1, triangles, arrays);
  add_point_data(vertices, arrays);
  arrays.close("Piece");
  arrays.close(type);
  return arrays.finish();
}

VertexArrays vertices_of(const Mesh& mesh) { return {mesh.origin, mesh.vertices, mesh.normals, mesh.attributes}; }
VertexArrays vertices_of(const Cloud& cloud) {
  return {cloud.origin, cloud.positions, cloud.normals, cloud.attributes};
}

}  // namespace

Blocks format_vtp_mesh(const Mesh& mesh, const WriteOptions& /*options*/) {
  return format_vtk_xml(Kind::polygons, vertices_of(mesh), &mesh.triangles);
}
Blocks format_vtp_cloud(const Cloud& cloud, const WriteOptions& /*options*/) {
  return format_vtk_xml(Kind::polygons, vertices_of(cloud), nullptr);
}
Blocks format_vtu_mesh(const Mesh& mesh, const WriteOptions& /*options*/) {
  return format_vtk_xml(Kind::grid, vertices_of(mesh), &mesh.triangles);
}
Blocks format_vtu_cloud(const Cloud& cloud, const WriteOptions& /*options*/) {
  return format_vtk_xml(Kind::grid, vertices_of(cloud), nullptr);
}

}  // namespace pointskin::io
