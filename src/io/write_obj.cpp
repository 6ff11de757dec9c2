#include <cstdint>

#include "io/text_lines.hpp"
#include "io/writers.hpp"

namespace pointskin::io {
Blocks format_obj(const Mesh& mesh, const WriteOptions& /*options*/) {
  const auto write_vertex = [&mesh, is_world = is_zero(mesh.origin), colour = colour_of(mesh)](std::size_t i,
                                                                                               LineBuffer& line) {
    const Vec3f& p = mesh.vertices[i];
    const Vec3d w = world(mesh.origin, p);
    if (is_world)
      add_three(line, "v", p.x, p.y, p.z);
    else
      add_three(line, "v", w[0], w[1], w[2]);
    if (colour)
      for (const std::uint8_t* channel : *colour) line.add_share(channel[i]);
  };
  const auto write_normal = [&mesh](std::size_t i, LineBuffer& line) {
    add_three(line, "vn", mesh.normals[i].x, mesh.normals[i].y, mesh.normals[i].z);
  };
  const auto write_face = [&mesh](std::size_t t, LineBuffer& line) {
    line.add("f");
    for (const std::int32_t corner : mesh.triangles[t]) {
      const std::int64_t id = std::int64_t{corner} + 1;
      line.add(" ");
      line.add_number(id);
      if (mesh.normals.empty()) continue;
      line.add("//");
      line.add_number(id);
    }
  };
  return cut_into_blocks({}, {lines(mesh.vertices.size(), write_vertex), lines(mesh.normals.size(), write_normal),
                              lines(mesh.triangles.size(), write_face)});
}

}  // namespace pointskin::io
