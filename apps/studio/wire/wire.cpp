#include "wire.hpp"

#include <pointskin/cloud.hpp>
#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <span>
#include <utility>

#include <nlohmann/json.hpp>

#include "colours.hpp"
#include "quantise.hpp"
#include "sections.hpp"

namespace pointskin::studio::wire {
namespace {

using Json = nlohmann::ordered_json;

Json box_json(const Bounds& box, const Vec3d& origin) {
  const auto world = [&origin](const Vec3f& v) {
    return Json{origin.x + double{v.x}, origin.y + double{v.y}, origin.z + double{v.z}};
  };
  return {{"lower", world(box.lower)}, {"upper", world(box.upper)}};
}

/// A section whose elements are made one by one: element(i) of `values`.
template <class Element, class Make, class T>
Fill each(const std::vector<T>& values, Make make) {
  return [&values, make](std::byte* out, std::size_t begin, std::size_t end) {
    for (std::size_t i = begin; i < end; ++i, out += sizeof(Element)) {
      const Element element = make(values[i]);
      std::memcpy(out, &element, sizeof element);
    }
  };
}

void add_positions(const std::vector<Vec3f>& positions, const Bounds& box, Sections& sections) {
  using Steps = std::array<std::uint16_t, 4>;
  sections.add("positions", "u16x4", sizeof(Steps), positions.size(), each<Steps>(positions, Grid(box)));
}

/// Four bytes a normal, of which two are used: graphics libraries want attributes that begin at multiples of 4.
void add_normals(const std::vector<Vec3f>& normals, Sections& sections) {
  if (normals.empty()) return;
  using Code = std::array<std::uint8_t, 4>;
  const auto code = [](const Vec3f& n) {
    const auto [u, v] = octahedral(n);
    return Code{u, v, 0, 0};
  };
  sections.add("normals", "u8x4", sizeof(Code), normals.size(), each<Code>(normals, code));
}

void add_bytes(const char* name, const std::vector<std::uint8_t>& values, Sections& sections) {
  if (!values.empty()) sections.add(name, "u8", 1, values.size(), copy_of(std::span(values)));
}

/// @param colours  shape (4 n), kept as they are until the blob is finished
void add_colours(const std::vector<std::uint8_t>& colours, Sections& sections) {
  using Colour = std::array<std::uint8_t, 4>;
  const std::span all(reinterpret_cast<const Colour*>(colours.data()), colours.size() / 4);
  if (!all.empty()) sections.add("colors", "u8x4", sizeof(Colour), all.size(), copy_of(all));
}

void check_shape(std::size_t size, std::size_t expected) {
  if (size != expected) throw Error(ErrorCode::usage, "values of another shape than the mesh's vertices");
}

/// Finite numbers lie in a box; those of an empty cloud in one without extent.
Bounds box_of(const std::vector<Vec3f>& positions) { return positions.empty() ? Bounds{{}, {}} : bounds_of(positions); }

}  // namespace

std::vector<std::byte> encode_mesh(const Mesh& mesh, const MeshCoding& coding) {
  const Bounds box = box_of(mesh.vertices);
  const std::vector<std::uint8_t> colours = colours_of(mesh.attributes, mesh.vertices.size());
  Sections sections(coding.compressed, coding.threads);
  add_positions(mesh.vertices, box, sections);
  add_normals(mesh.normals, sections);
  static_assert(sizeof(Triangle) == 3 * sizeof(std::uint32_t));
  sections.add_triangles({reinterpret_cast<const std::uint32_t*>(mesh.triangles.data()), 3 * mesh.triangles.size()},
                         mesh.vertices.size());
  add_colours(colours, sections);
  for (const Values& values : coding.values) {
    check_shape(values.values.size(), mesh.vertices.size());
    sections.add("values:" + values.name, "f32", sizeof(float), values.values.size(),
                 copy_of(std::span(values.values)));
  }
  if (!coding.tint.empty()) check_shape(coding.tint.size(), mesh.vertices.size());
  add_bytes("tint", coding.tint, sections);
  return std::move(sections).finish({{"kind", "mesh"},
                                     {"vertices", mesh.vertices.size()},
                                     {"triangles", mesh.triangles.size()},
                                     {"box", box_json(box, mesh.origin)}});
}

std::vector<std::byte> encode_points(const PointSet& points, const Bounds& box, bool compressed) {
  Sections sections(compressed);
  add_positions(points.positions, box, sections);
  add_normals(points.normals, sections);
  add_colours(points.colours, sections);
  add_bytes("tint", points.tint, sections);
  return std::move(sections).finish(
      {{"kind", "points"}, {"vertices", points.positions.size()}, {"box", box_json(box, points.origin)}});
}

std::vector<std::byte> compressed(const std::vector<std::byte>& raw) {
  std::uint32_t header_bytes = 0;
  if (raw.size() < kHeadBytes) throw Error(ErrorCode::internal, "not a blob");
  std::memcpy(&header_bytes, raw.data() + kHeaderBytesAt, sizeof header_bytes);
  const auto* text = reinterpret_cast<const char*>(raw.data()) + kHeadBytes;
  Json header = Json::parse(text, text + header_bytes);
  const auto data = std::span(raw).subspan(kHeadBytes + header_bytes);
  Sections sections(true);
  for (const Json& section : header["sections"]) {
    const auto bytes = data.subspan(section["offset"], section["bytes"]);
    const std::size_t stride = section["stride"];
    if (section["name"] == "triangles")
      sections.add_triangles({reinterpret_cast<const std::uint32_t*>(bytes.data()), bytes.size() / 4},
                             header["vertices"]);
    else
      sections.add(section["name"], section["type"], section["stride"], section["count"],
                   [bytes, stride](std::byte* out, std::size_t begin, std::size_t end) {
                     if (end > begin) std::memcpy(out, bytes.data() + begin * stride, (end - begin) * stride);
                   });
  }
  header.erase("sections");
  return std::move(sections).finish(std::move(header));
}

}  // namespace pointskin::studio::wire
