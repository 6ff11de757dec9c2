#include <pointskin/error.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <iterator>
#include <unordered_set>
#include <utility>

#include "io/scalar.hpp"
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

std::string vertex_header(const VertexArrays& v, const char* encoding) {
  const char* type = is_zero(v.origin) ? "float" : "double";
  std::string header = fmt::format("ply\nformat {} 1.0\nelement vertex {}\n", encoding, v.positions.size());
  std::unordered_set<std::string> names;
  const auto add = [&](const char* property_type, const std::string& name) {
    if (!names.insert(name).second)
      throw Error(ErrorCode::usage, fmt::format("two properties are named '{}'; rename an attribute", name));
    fmt::format_to(std::back_inserter(header), "property {} {}\n", property_type, name);
  };
  for (const char* axis : {"x", "y", "z"}) add(type, axis);
  if (!v.normals.empty())
    for (const char* axis : {"nx", "ny", "nz"}) add("float", axis);
  for (const Attribute& a : v.attributes)
    add(a.type == AttributeType::uint8 ? "uchar" : "float", property_name(a.name));
  return header;
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

std::size_t row_bytes_of(const VertexArrays& v) {
  std::size_t bytes = is_zero(v.origin) ? 3 * sizeof(float) : 3 * sizeof(double);
  if (!v.normals.empty()) bytes += sizeof(Vec3f);
  for (const Attribute& a : v.attributes) bytes += a.type == AttributeType::uint8 ? 1 : sizeof(float);
  return bytes;
}

/// Writes the rows [first, last), the first one to `out`, column by column.
void store_rows(const VertexArrays& v, std::size_t first, std::size_t last, std::size_t row_bytes, char* out) {
  const auto for_rows = [&](std::size_t bytes, const auto& put) {
    char* to = out;
    for (std::size_t i = first; i < last; ++i, to += row_bytes) put(to, i);
    out += bytes;
  };
  if (is_zero(v.origin))
    for_rows(sizeof(Vec3f), [&](char* to, std::size_t i) { store(to, v.positions[i]); });
  else
    for_rows(sizeof(Vec3d), [&](char* to, std::size_t i) { store(to, world(v.origin, v.positions[i])); });
  if (!v.normals.empty()) for_rows(sizeof(Vec3f), [&](char* to, std::size_t i) { store(to, v.normals[i]); });
  for (const Attribute& a : v.attributes) {
    if (a.type == AttributeType::uint8)
      for_rows(1, [&](char* to, std::size_t i) { store(to, to_byte(a.values[i])); });
    else
      for_rows(sizeof(float), [&](char* to, std::size_t i) { store(to, a.values[i]); });
  }
}

void store_faces(const std::vector<Triangle>& triangles, std::size_t first, std::size_t last, char* out) {
  for (std::size_t t = first; t < last; ++t, out += kFaceBytes) {
    *out = 3;
    std::memcpy(out + 1, triangles[t].data(), sizeof(Triangle));
  }
}

}  // namespace

std::string ply_header(const VertexArrays& vertices, const std::vector<Triangle>* triangles, const char* encoding) {
  check_shapes(vertices);
  std::string header = vertex_header(vertices, encoding);
  if (triangles != nullptr)
    fmt::format_to(std::back_inserter(header), "element face {}\nproperty list uchar int vertex_indices\n",
                   triangles->size());
  return header + "end_header\n";
}

std::uint8_t to_byte(float value) {
  return static_cast<std::uint8_t>(std::isnan(value) ? 0.0f : std::round(std::clamp(value, 0.0f, 255.0f)));
}

Blocks format_ply(const VertexArrays& vertices, const std::vector<Triangle>* triangles) {
  std::string header = ply_header(vertices, triangles, "binary_little_endian");
  const auto append_vertices = [vertices, row_bytes = row_bytes_of(vertices)](std::size_t first, std::size_t last,
                                                                              std::string& bytes) {
    const std::size_t before = bytes.size();
    bytes.resize(before + (last - first) * row_bytes);
    store_rows(vertices, first, last, row_bytes, bytes.data() + before);
  };
  const auto append_faces = [triangles](std::size_t first, std::size_t last, std::string& bytes) {
    const std::size_t before = bytes.size();
    bytes.resize(before + (last - first) * kFaceBytes);
    store_faces(*triangles, first, last, bytes.data() + before);
  };
  const std::size_t faces = triangles != nullptr ? triangles->size() : 0;
  return cut_into_blocks(std::move(header), {{vertices.positions.size(), append_vertices}, {faces, append_faces}});
}

}  // namespace pointskin::io
