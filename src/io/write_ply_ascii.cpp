// ASCII PLY: what format_ply writes, as text.
#include <array>
#include <charconv>

#include "io/writers.hpp"

namespace pointskin::io {
namespace {

/// Appends a blank and `value` in the fewest digits that read back equal.
template <class Number>
void append_number(std::string& bytes, Number value) {
  std::array<char, 32> text;
  text[0] = ' ';
  bytes.append(text.data(), std::to_chars(text.data() + 1, text.data() + text.size(), value).ptr);
}

void append_position(std::string& bytes, const VertexArrays& v, std::size_t i) {
  const Vec3f& p = v.positions[i];
  if (!v.is_wide()) {
    for (const float x : {p.x, p.y, p.z}) append_number(bytes, x);
    return;
  }
  const Vec3d at = world(v.origin, p);
  for (const double x : {at.x, at.y, at.z}) append_number(bytes, x);
}

/// As a property of type `type` holds it. Bytes are numbers, not characters.
void append_value(std::string& bytes, const AttributeValues& values, AttributeType type, std::size_t i) {
  const auto append = [&bytes](auto value) {
    if constexpr (sizeof(value) == 1)
      append_number(bytes, int{value});
    else
      append_number(bytes, value);
  };
  if (type == values.type()) return values.visit([&](const auto& all) { append(all[i]); });
  visit_type(type, [&](auto tag) { append(static_cast<decltype(tag)>(values.at(i))); });
}

/// A line a row: add(i, bytes) appends its numbers, each behind a blank. Lines begin without one.
template <class Add>
void append_lines(std::size_t first, std::size_t last, std::string& bytes, const Add& add) {
  std::string line;
  for (std::size_t i = first; i < last; ++i) {
    line.clear();
    add(i, line);
    bytes.append(line, 1);
    bytes += '\n';
  }
}

}  // namespace

Blocks format_ply_ascii(const VertexArrays& vertices, const std::vector<Triangle>* triangles) {
  const auto append_vertices = [vertices, types = stored_types(vertices)](std::size_t first, std::size_t last,
                                                                          std::string& bytes) {
    append_lines(first, last, bytes, [&](std::size_t i, std::string& line) {
      append_position(line, vertices, i);
      if (!vertices.normals.empty()) {
        const Vec3f& n = vertices.normals[i];
        for (const float x : {n.x, n.y, n.z}) append_number(line, x);
      }
      for (std::size_t a = 0; a < types.size(); ++a) append_value(line, vertices.attributes[a].values, types[a], i);
    });
  };
  const auto append_faces = [triangles](std::size_t first, std::size_t last, std::string& bytes) {
    append_lines(first, last, bytes, [triangles](std::size_t t, std::string& line) {
      line += " 3";
      for (const std::int32_t v : (*triangles)[t]) append_number(line, v);
    });
  };
  const std::size_t faces = triangles != nullptr ? triangles->size() : 0;
  return cut_into_blocks(ply_header(vertices, triangles, "ascii"),
                         {{vertices.positions.size(), append_vertices}, {faces, append_faces}});
}

}  // namespace pointskin::io
