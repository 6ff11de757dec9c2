// VTK's XML files of points, polygons and unstructured grids (.vtp, .vtu): all pieces.
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "core/format.hpp"
#include "io/numpy_table.hpp"
#include "io/pieces.hpp"
#include "io/readers.hpp"
#include "io/vtk.hpp"
#include "io/with_pugixml/vtk_xml_document.hpp"

namespace pointskin::io {
namespace {

constexpr std::int64_t kMostComponents = 64;  ///< of an array that becomes attributes

Column column(const VtkArray& array, std::int64_t component, std::string name) {
  return {std::move(name), array.declared, array.type, array.at(component), array.stride(), array.swapped};
}

/// One piece of a file.
class Piece {
 public:
  Piece(VtkXmlDocument& document, pugi::xml_node node)
      : document_(document), node_(node), points_(document.count(node, "NumberOfPoints")) {}

  PointTable table() {
    PointTable table{points_, {}};
    if (points_ == 0) return table;
    const VtkArray places = document_.array(node_.child("Points").child("DataArray"), points_);
    if (places.components != 3) document_.fail_here("its points have no three coordinates");
    for (std::int64_t axis = 0; axis < 3; ++axis)
      table.columns.push_back(column(places, axis, std::string(1, "xyz"[axis])));
    const pugi::xml_node data = node_.child("PointData");
    const std::string normals = data.attribute("Normals").value();
    for (const pugi::xml_node child : data.children("DataArray")) {
      if (child.attribute("type").value() == std::string_view("String")) continue;
      const VtkArray array = document_.array(child, points_);
      add(array, array.name == normals || names_normals(array.name), table);
    }
    return table;
  }

  std::vector<Triangle> polygons() {
    std::vector<Triangle> triangles;
    if (document_.count(node_, "NumberOfPolys") > 0)
      for_cells(node_.child("Polys"), document_.count(node_, "NumberOfPolys"),
                [&](std::int64_t, const std::vector<std::int32_t>& corners) { append_fan(corners, triangles); });
    if (document_.count(node_, "NumberOfStrips") > 0)
      for_cells(node_.child("Strips"), document_.count(node_, "NumberOfStrips"),
                [&](std::int64_t, const std::vector<std::int32_t>& corners) { append_strip(corners, triangles); });
    return triangles;
  }

  std::vector<Triangle> cells() {
    std::vector<Triangle> triangles;
    const std::int64_t count = document_.count(node_, "NumberOfCells");
    if (count == 0) return triangles;
    const pugi::xml_node cells = node_.child("Cells");
    const VtkArray types = document_.array(cells.find_child_by_attribute("DataArray", "Name", "types"), count);
    for_cells(cells, count, [&](std::int64_t cell, std::vector<std::int32_t>& corners) {
      append_cell(VtkCell{types.integer(cell)}, corners, triangles);
    });
    return triangles;
  }

 private:
  void add(const VtkArray& array, bool is_normal, PointTable& table) const {
    constexpr std::array kColours{"red", "green", "blue", "alpha"};
    const bool is_colour = array.declared == AttributeType::uint8 && (array.components == 3 || array.components == 4) &&
                           vtk_names_colours(array.name);
    for (std::int64_t c = 0; c < array.components && array.components <= kMostComponents; ++c) {
      const auto axis = static_cast<std::size_t>(c);
      std::string name = fmt::format("{}_{}", array.name, c);
      if (array.components == 1) name = array.name;
      if (array.components == 3) name = fmt::format("{}_{}", array.name, "xyz"[axis]);
      if (array.components == 3 && is_normal) name = std::string("n") + "xyz"[axis];
      if (is_colour) name = kColours[axis];
      table.columns.push_back(column(array, c, std::move(name)));
    }
  }

  /// Calls f(cell, its corners) for all cells.
  template <class F>
  void for_cells(pugi::xml_node node, std::int64_t count, const F& f) {
    const VtkArray ends = document_.array(node.find_child_by_attribute("DataArray", "Name", "offsets"), count);
    const VtkArray ids = document_.array(node.find_child_by_attribute("DataArray", "Name", "connectivity"), -1);
    if (!is_integer(ends.type) || !is_integer(ids.type)) document_.fail_here("its cells are no whole numbers");
    std::vector<std::int32_t> corners;
    std::int64_t at = 0;
    for (std::int64_t cell = 0; cell < count; ++cell) {
      const std::int64_t end = ends.integer(cell);
      if (end < at || end > ids.tuples) document_.fail_here(fmt::format("cell {} ends where there is nothing", cell));
      corners.clear();
      for (; at < end; ++at) {
        const std::int64_t id = ids.integer(at);
        if (id < 0 || id >= points_)
          document_.fail_here(fmt::format("cell {} names point {} of {}", cell, id, points_));
        corners.push_back(static_cast<std::int32_t>(id));
      }
      f(cell, corners);
    }
  }

  VtkXmlDocument& document_;
  pugi::xml_node node_;
  std::int64_t points_;
};

Pieces read_pieces(exec::Cpu& ex, const Source& source, const ReadOptions& options, bool with_triangles) {
  VtkXmlDocument document(source);
  const std::string type = document.root().attribute("type").value();
  if (type != "PolyData" && type != "UnstructuredGrid")
    document.fail_here("holds " + in_quotes(type) + ", not PolyData or UnstructuredGrid");
  Pieces pieces(ex, source, options);
  for (const pugi::xml_node node : document.pieces(type.c_str())) {
    Piece piece(document, node);
    const PointTable table = piece.table();
    check_vertex_count(source, with_triangles ? table.rows : 0);
    std::vector<Triangle> triangles;
    if (with_triangles) triangles = type == "PolyData" ? piece.polygons() : piece.cells();
    pieces.add(table, triangles);
  }
  return pieces;
}

}  // namespace

bool is_vtk_xml(std::string_view start) { return start.substr(0, 512).find("<VTKFile") != std::string_view::npos; }

Cloud parse_vtk_xml_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  return read_pieces(ex, source, options, false).take_cloud();
}

Mesh parse_vtk_xml_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options) {
  return read_pieces(ex, source, options, true).take_mesh();
}

}  // namespace pointskin::io
