#include "io/ply_body.hpp"

namespace pointskin::io {

std::size_t find_corner_list(const Source& source, const PlyElement& face) {
  for (std::size_t p = 0; p < face.properties.size(); ++p) {
    const PlyProperty& property = face.properties[p];
    if (!property.is_list || (property.name != "vertex_indices" && property.name != "vertex_index")) continue;
    if (!is_integer(property.type)) fail(source, "the vertex indices are not integers", "export the file again");
    return p;
  }
  fail(source, "the faces have no list vertex_indices", "export the file again");
}

std::int64_t vertex_count(const PlyHeader& header) {
  const PlyElement* vertex = header.find("vertex");
  return vertex != nullptr ? vertex->count : 0;
}

void add_scalars(const PlyElement& element, ParsedColumns& parsed) {
  for (const PlyProperty& property : element.properties)
    if (!property.is_list) parsed.add(property.name, property.type);
  parsed.allocate(element.count);
}

}  // namespace pointskin::io
