// OFF (Geomview), text: NOFF with normals, COFF with colours, which are bytes.
#include <cstdint>
#include <string>

#include "core/format.hpp"
#include "io/text_lines.hpp"
#include "io/writers.hpp"

namespace pointskin::io {
namespace {

template <class Number>
void add_numbers(LineBuffer& line, Number x, Number y, Number z) {
  line.add_number(x);
  for (const Number value : {y, z}) {
    line.add(" ");
    line.add_number(value);
  }
}

}  // namespace

Blocks format_off(const Mesh& mesh, const WriteOptions& /*options*/) {
  const auto colour = colour_of(mesh);
  const auto write_vertex = [&mesh, colour, is_world = is_zero(mesh.origin)](std::size_t i, LineBuffer& line) {
    const Vec3f& p = mesh.vertices[i];
    const Vec3d w = world(mesh.origin, p);
    if (is_world)
      add_numbers(line, p.x, p.y, p.z);
    else
      add_numbers(line, w.x, w.y, w.z);
    if (!mesh.normals.empty()) {
      line.add(" ");
      add_numbers(line, mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z);
    }
    if (!colour) return;
    for (const std::uint8_t* channel : *colour) {
      line.add(" ");
      line.add_number(static_cast<int>(channel[i]));
    }
    line.add(" 255");
  };
  const auto write_face = [&mesh](std::size_t t, LineBuffer& line) {
    line.add("3 ");
    const Triangle& triangle = mesh.triangles[t];
    add_numbers(line, triangle[0], triangle[1], triangle[2]);
  };
  const std::string header = fmt::format("{}{}OFF\n{} {} 0\n", colour ? "C" : "", mesh.normals.empty() ? "" : "N",
                                         mesh.vertices.size(), mesh.triangles.size());
  return cut_into_blocks(header, {lines(mesh.vertices.size(), write_vertex), lines(mesh.triangles.size(), write_face)});
}

}  // namespace pointskin::io
