// Binary glTF 2.0. Source: Khronos, "glTF 2.0 Specification", 3.6 (accessors), 3.7 (meshes), 4.4 (GLB).
#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "io/gltf.hpp"
#include "io/writers.hpp"

namespace pointskin::io {
namespace {

using Json = nlohmann::ordered_json;

/// A part of the binary chunk: rows of some multiple of 4 bytes, and what the JSON says of them.
struct Part {
  std::string semantic;  ///< of an attribute; empty: the indices
  int component = kGltfFloat;
  const char* type = "SCALAR";
  std::size_t rows = 0, row_bytes = 0;
  bool normalised = false;
  std::function<void(std::size_t row, char* to)> store;
};

const Attribute* find(const std::vector<Attribute>& attributes, const std::string& name) {
  const auto at =
      std::find_if(attributes.begin(), attributes.end(), [&](const Attribute& a) { return a.name == name; });
  return at == attributes.end() ? nullptr : &*at;
}

/// Red, green and blue of one type that glTF has for colours, and alpha if it is of that type, too; else none.
std::vector<const Attribute*> colour_channels(const std::vector<Attribute>& attributes) {
  std::vector<const Attribute*> channels;
  for (const char* name : {"red", "green", "blue", "alpha"}) {
    const Attribute* const channel = find(attributes, name);
    if (channel == nullptr && channels.size() == 3) break;
    if (channel == nullptr) return {};
    const bool fits = channel->type() == AttributeType::uint8 || channel->type() == AttributeType::uint16;
    if (!fits || (!channels.empty() && channel->type() != channels[0]->type())) {
      if (channels.size() == 3) break;
      return {};
    }
    channels.push_back(channel);
  }
  return channels;
}

template <class T>
void put(char* to, std::size_t place, T value) {
  std::memcpy(to + place * sizeof(T), &value, sizeof(T));
}

Part vectors(const char* semantic, const std::vector<Vec3f>& values) {
  return {semantic, kGltfFloat, "VEC3", values.size(), sizeof(Vec3f), false, [&values](std::size_t row, char* to) {
            std::memcpy(to, &values[row], sizeof(Vec3f));
          }};
}

/// Four channels, so that rows are aligned; alpha is opaque where there is none.
template <class T>
Part colours(std::vector<const Attribute*> channels) {
  const std::size_t rows = channels[0]->values.size();
  return {"COLOR_0",
          sizeof(T) == 1 ? kGltfUint8 : kGltfUint16,
          "VEC4",
          rows,
          4 * sizeof(T),
          true,
          [channels = std::move(channels)](std::size_t row, char* to) {
            for (std::size_t c = 0; c < 4; ++c)
              put(to, c, c < channels.size() ? channels[c]->values.as<T>()[row] : std::numeric_limits<T>::max());
          }};
}

int component_of(AttributeType type) {
  switch (type) {
    case AttributeType::int8:
      return kGltfInt8;
    case AttributeType::uint8:
      return kGltfUint8;
    case AttributeType::int16:
      return kGltfInt16;
    case AttributeType::uint16:
      return kGltfUint16;
    default:
      return kGltfFloat;  // attributes of applications must not be of 32-bit integers
  }
}

Part scalars(const Attribute& attribute) {
  const int component = component_of(attribute.type());
  return {"_" + attribute.name,
          component,
          "SCALAR",
          attribute.values.size(),
          4,
          false,
          [&attribute, component](std::size_t row, char* to) {
            std::memset(to, 0, 4);
            attribute.values.visit([&](const auto& values) {
              if (component == kGltfFloat)
                put(to, 0, static_cast<float>(attribute.values.at(row)));
              else
                std::memcpy(to, &values[row], sizeof(values[row]));
            });
          }};
}

/// What a file holds besides faces.
struct Points {
  const Vec3d& origin;
  const std::vector<Vec3f>& positions;
  const std::vector<Vec3f>& normals;
  const std::vector<Attribute>& attributes;
};

std::vector<Part> parts_of(const Points& points, const std::vector<Triangle>* triangles) {
  std::vector<Part> parts{vectors("POSITION", points.positions)};
  if (!points.normals.empty()) parts.push_back(vectors("NORMAL", points.normals));
  const std::vector<const Attribute*> channels = colour_channels(points.attributes);
  if (!channels.empty())
    parts.push_back(channels[0]->type() == AttributeType::uint8 ? colours<std::uint8_t>(channels)
                                                                : colours<std::uint16_t>(channels));
  for (const Attribute& attribute : points.attributes)
    if (std::find(channels.begin(), channels.end(), &attribute) == channels.end()) parts.push_back(scalars(attribute));
  if (triangles != nullptr)
    parts.push_back(
        {"", kGltfUint32, "SCALAR", triangles->size(), sizeof(Triangle), false,
         [triangles](std::size_t row, char* to) { std::memcpy(to, &(*triangles)[row], sizeof(Triangle)); }});
  return parts;
}

void check_lengths(const Points& points, const std::vector<Part>& parts) {
  for (const Part& part : parts)
    if (!part.semantic.empty() && part.rows != points.positions.size())
      throw Error(ErrorCode::usage,
                  fmt::format("{} has {} values for {} vertices", part.semantic, part.rows, points.positions.size()));
}

Json describe(const Points& points, const std::vector<Part>& parts, bool has_faces) {
  Json json{{"asset", {{"version", "2.0"}, {"generator", "pointskin"}}}, {"scene", 0}};
  json["scenes"] = {{{"nodes", {0}}}};
  Json node{{"mesh", 0}};
  if (!is_zero(points.origin)) node["translation"] = {points.origin.x, points.origin.y, points.origin.z};
  json["nodes"] = Json::array({node});
  Json primitive{{"attributes", Json::object()}, {"mode", has_faces ? 4 : 0}, {"material", 0}};
  std::size_t offset = 0;
  for (const Part& part : parts) {
    const std::size_t bytes = part.rows * part.row_bytes;
    const std::size_t index = json["accessors"].size();
    Json view{{"buffer", 0}, {"byteOffset", offset}, {"byteLength", bytes}};
    Json accessor{{"bufferView", index}, {"componentType", part.component}, {"type", part.type}};
    accessor["count"] = part.semantic.empty() ? 3 * part.rows : part.rows;
    if (part.normalised) accessor["normalized"] = true;
    if (part.semantic.empty()) {
      view["target"] = 34963;
      primitive["indices"] = index;
    } else {
      view["byteStride"] = part.row_bytes;
      view["target"] = 34962;
      primitive["attributes"][part.semantic] = index;
    }
    if (part.semantic == "POSITION") {
      const Bounds box = bounds_of(points.positions);
      accessor["min"] = {box.lower.x, box.lower.y, box.lower.z};
      accessor["max"] = {box.upper.x, box.upper.y, box.upper.z};
    }
    json["accessors"].push_back(accessor);
    json["bufferViews"].push_back(view);
    offset += bytes;
  }
  json["buffers"] = {{{"byteLength", offset}}};
  json["materials"] = {
      {{"pbrMetallicRoughness", {{"metallicFactor", 0}, {"roughnessFactor", 0.7}}}, {"doubleSided", true}}};
  json["meshes"] = {{{"primitives", Json::array({primitive})}}};
  return json;
}

/// The lengths of a GLB are 32 bits.
std::string header_of(std::string json, std::size_t binary_bytes) {
  json.resize((json.size() + 3) / 4 * 4, ' ');
  const std::size_t total = 12 + 8 + json.size() + 8 + binary_bytes;
  if (total > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::over_limit, "GLB holds at most 4 GiB; write PLY instead");
  std::string header(20, '\0');
  const std::array<std::uint32_t, 5> words{kGlbMagic, 2, static_cast<std::uint32_t>(total),
                                           static_cast<std::uint32_t>(json.size()), kGlbJson};
  std::memcpy(header.data(), words.data(), sizeof(words));
  header += json;
  const std::array<std::uint32_t, 2> binary{static_cast<std::uint32_t>(binary_bytes), kGlbBinary};
  header.append(reinterpret_cast<const char*>(binary.data()), sizeof(binary));
  return header;
}

Blocks format_glb(const Points& points, const std::vector<Triangle>* triangles) {
  if (triangles != nullptr && triangles->empty()) triangles = nullptr;
  std::vector<Part> parts = parts_of(points, triangles);
  check_lengths(points, parts);
  if (points.positions.empty()) throw Error(ErrorCode::empty_result, "a GLB file holds at least one point");
  std::size_t bytes = 0;
  for (const Part& part : parts) bytes += part.rows * part.row_bytes;
  std::string header = header_of(describe(points, parts, triangles != nullptr).dump(), bytes);
  std::vector<Section> sections;
  for (Part& part : parts)
    sections.push_back({part.rows, [part = std::move(part)](std::size_t first, std::size_t last, std::string& out) {
                          const std::size_t before = out.size();
                          out.resize(before + (last - first) * part.row_bytes);
                          for (std::size_t row = first; row < last; ++row)
                            part.store(row, out.data() + before + (row - first) * part.row_bytes);
                        }});
  return cut_into_blocks(std::move(header), std::move(sections));
}

}  // namespace

Blocks format_glb_mesh(const Mesh& mesh, const WriteOptions& /*options*/) {
  return format_glb({mesh.origin, mesh.vertices, mesh.normals, mesh.attributes}, &mesh.triangles);
}

Blocks format_glb_cloud(const Cloud& cloud, const WriteOptions& /*options*/) {
  return format_glb({cloud.origin, cloud.positions, cloud.normals, cloud.attributes}, nullptr);
}

}  // namespace pointskin::io
