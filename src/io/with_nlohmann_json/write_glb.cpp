// Binary glTF 2.0. Source: Khronos, "glTF 2.0 Specification", 3.6 (accessors), 3.7 (meshes), 4.4 (GLB); with
// "KHR_mesh_quantization" and "EXT_meshopt_compression".
#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include "core/format.hpp"
#include "core/vec3.hpp"
#include "io/gltf.hpp"
#include "io/libraries.hpp"
#include "io/meshopt.hpp"
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
  Json least = nullptr, most = nullptr;  ///< of the values, where the format asks for them
  MeshoptFilter filter = MeshoptFilter::none;

  /// Appends rows [first, last).
  void append(std::size_t first, std::size_t last, std::string& out) const {
    const std::size_t before = out.size();
    out.resize(before + (last - first) * row_bytes);
    for (std::size_t row = first; row < last; ++row) store(row, out.data() + before + (row - first) * row_bytes);
  }
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
  const auto store = [&values](std::size_t row, char* to) { std::memcpy(to, &values[row], sizeof(Vec3f)); };
  return {semantic, kGltfFloat, "VEC3", values.size(), sizeof(Vec3f), false, store, {}, {}};
}

Part positions(const std::vector<Vec3f>& values) {
  Part part = vectors("POSITION", values);
  const Bounds box = bounds_of(values);
  part.least = {box.lower.x, box.lower.y, box.lower.z};
  part.most = {box.upper.x, box.upper.y, box.upper.z};
  return part;
}

/// Where whole numbers of 16 bits put positions: lower + number * step, the same step along all axes, so that the node that
/// says so does not turn normals.
struct Grid {
  static constexpr double kMost = std::numeric_limits<std::uint16_t>::max();
  Vec3d lower{0, 0, 0};
  double step = 1;

  explicit Grid(const std::vector<Vec3f>& positions) {
    const Bounds box = bounds_of(positions);
    const Vec3d sides = to_double(box.upper) - to_double(box.lower);
    const double longest = std::max({sides.x, sides.y, sides.z});
    lower = to_double(box.lower);
    if (longest > 0) step = longest / kMost;
  }
  [[nodiscard]] std::array<std::uint16_t, 3> cell(const Vec3f& p) const {
    const Vec3d place = (to_double(p) - lower) / step;
    const auto whole = [](double v) { return static_cast<std::uint16_t>(std::clamp(std::round(v), 0.0, kMost)); };
    return {whole(place.x), whole(place.y), whole(place.z)};
  }
};

/// Rows of 8 bytes, so that they are aligned.
Part cells(const std::vector<Vec3f>& values, const Grid& grid) {
  const Bounds box = bounds_of(values);
  const auto store = [&values, &grid](std::size_t row, char* to) {
    std::memset(to, 0, 8);
    put(to, 0, grid.cell(values[row]));
  };
  return {"POSITION", kGltfUint16, "VEC3", values.size(), 8, false, store, grid.cell(box.lower), grid.cell(box.upper)};
}

/// Normals of 16 bits a component. Those of a cloud may have no length, which two angles do not tell.
Part small_normals(const std::vector<Vec3f>& values) {
  const auto has_length = [](const Vec3f& n) { return squared_length(to_double(n)) > 0; };
  const bool by_angles = std::all_of(values.begin(), values.end(), has_length);
  const auto store = [&values, by_angles](std::size_t row, char* to) {
    if (by_angles) return store_octahedral(values[row], to);
    constexpr double kOne = std::numeric_limits<std::int16_t>::max();
    const Vec3d n = to_double(values[row]);
    const double size = std::max({std::abs(n.x), std::abs(n.y), std::abs(n.z), 1.0});
    for (std::size_t axis = 0; axis < 3; ++axis)
      put(to, axis, static_cast<std::int16_t>(std::lround(n[axis] / size * kOne)));
    put(to, 3, std::int16_t{0});
  };
  return {"NORMAL", kGltfInt16,
          "VEC3",   values.size(),
          8,        true,
          store,    {},
          {},       by_angles ? MeshoptFilter::octahedral : MeshoptFilter::none};
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

/// @param parts  positions, and normals where there are some; the others are added
std::vector<Part> with_the_rest(std::vector<Part> parts, const Points& points, const std::vector<Triangle>* triangles) {
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

/// The node that puts the mesh where it belongs.
Json node_of(const Vec3d& origin, const Grid* grid) {
  Json node{{"mesh", 0}};
  const Vec3d place = grid == nullptr ? origin : origin + grid->lower;
  if (!is_zero(place)) node["translation"] = {place.x, place.y, place.z};
  if (grid != nullptr) node["scale"] = {grid->step, grid->step, grid->step};
  return node;
}

/// What a view says of its coding, whose bytes begin at `offset` of the binary chunk.
Json packing_of(const Part& part, std::size_t offset, std::size_t bytes) {
  const bool faces = part.semantic.empty();
  Json packing{{"buffer", 0},
               {"byteOffset", offset},
               {"byteLength", bytes},
               {"byteStride", faces ? part.row_bytes / 3 : part.row_bytes},
               {"count", faces ? 3 * part.rows : part.rows},
               {"mode", faces ? "TRIANGLES" : "ATTRIBUTES"}};
  if (part.filter == MeshoptFilter::octahedral) packing["filter"] = "OCTAHEDRAL";
  return {{kMeshoptExtension, packing}};
}

std::size_t aligned(std::size_t bytes) { return (bytes + 3) / 4 * 4; }

Json describe(const Points& points, const std::vector<Part>& parts, bool has_faces) {
  Json json{{"asset", {{"version", "2.0"}, {"generator", "pointskin"}}}, {"scene", 0}};
  json["scenes"] = {{{"nodes", {0}}}};
  json["nodes"] = Json::array({node_of(points.origin, nullptr)});
  // Not made by the first push_back(): where memory runs out in that, nlohmann-json 3.11.2 destroys what is not there.
  json["accessors"] = Json::array();
  json["bufferViews"] = Json::array();
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
    if (!part.least.is_null()) {
      accessor["min"] = part.least;
      accessor["max"] = part.most;
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

/// Makes of the description of plain parts that of packed ones, which lie one after the other in the binary chunk. The
/// plain buffer stays in it as one that has a length and no bytes, as the extension wants it.
void describe_packing(Json& json, const std::vector<Part>& parts, const std::vector<std::string>& packed) {
  std::size_t offset = 0;
  for (std::size_t i = 0; i < parts.size(); ++i) {
    json["bufferViews"][i]["buffer"] = 1;
    json["bufferViews"][i]["extensions"] = packing_of(parts[i], offset, packed[i].size());
    offset += aligned(packed[i].size());
  }
  Json stand_in = json["buffers"][0];
  stand_in["extensions"] = {{kMeshoptExtension, {{"fallback", true}}}};
  json["buffers"] = Json::array({{{"byteLength", offset}}, stand_in});
  json["extensionsUsed"] = json["extensionsRequired"] = {kQuantizationExtension, kMeshoptExtension};
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

Blocks format_plain(const Points& points, const std::vector<Triangle>* triangles) {
  std::vector<Part> parts{positions(points.positions)};
  if (!points.normals.empty()) parts.push_back(vectors("NORMAL", points.normals));
  parts = with_the_rest(std::move(parts), points, triangles);
  check_lengths(points, parts);
  std::size_t bytes = 0;
  for (const Part& part : parts) bytes += part.rows * part.row_bytes;
  std::string header = header_of(describe(points, parts, triangles != nullptr).dump(), bytes);
  std::vector<Section> sections;
  for (Part& part : parts)
    sections.push_back({part.rows, [part = std::move(part)](std::size_t first, std::size_t last, std::string& out) {
                          part.append(first, last, out);
                        }});
  return cut_into_blocks(std::move(header), std::move(sections));
}

/// The packed parts are made as a whole, in memory. What it calls is there if kHasMeshoptimizer.
[[maybe_unused]] Blocks format_compressed(const Points& points, const std::vector<Triangle>* triangles) {
  const Grid grid(points.positions);
  std::vector<Part> parts{cells(points.positions, grid)};
  if (!points.normals.empty()) parts.push_back(small_normals(points.normals));
  parts = with_the_rest(std::move(parts), points, triangles);
  check_lengths(points, parts);
  std::vector<std::string> packed;
  for (const Part& part : parts) {
    std::string rows;
    if (!part.semantic.empty()) part.append(0, part.rows, rows);
    packed.push_back(part.semantic.empty() ? encode_triangles(*triangles, points.positions.size())
                                           : encode_rows(rows, part.row_bytes));
  }
  Json json = describe(points, parts, triangles != nullptr);
  json["nodes"] = Json::array({node_of(points.origin, &grid)});
  describe_packing(json, parts, packed);
  std::string binary;
  for (const std::string& part : packed) {
    binary += part;
    binary.resize(aligned(binary.size()));
  }
  std::string header = header_of(json.dump(), binary.size());
  const std::size_t length = binary.size();
  return cut_into_blocks(std::move(header),
                         {{length, [binary = std::move(binary)](std::size_t first, std::size_t last, std::string& out) {
                             out.append(binary, first, last - first);
                           }}});
}

Blocks format_glb(const Points& points, const std::vector<Triangle>* triangles, const WriteOptions& options) {
  if (triangles != nullptr && triangles->empty()) triangles = nullptr;
  if (points.positions.empty()) throw Error(ErrorCode::empty_result, "a GLB file holds at least one point");
  if (!options.compress) return format_plain(points, triangles);
  if constexpr (kHasMeshoptimizer)
    return format_compressed(points, triangles);
  else
    throw Error(ErrorCode::usage, "this build was made without meshoptimizer, by which GLB is compressed");
}

}  // namespace

Blocks format_glb_mesh(const Mesh& mesh, const WriteOptions& options) {
  return format_glb({mesh.origin, mesh.vertices, mesh.normals, mesh.attributes}, &mesh.triangles, options);
}

Blocks format_glb_cloud(const Cloud& cloud, const WriteOptions& options) {
  return format_glb({cloud.origin, cloud.positions, cloud.normals, cloud.attributes}, nullptr, options);
}

}  // namespace pointskin::io
