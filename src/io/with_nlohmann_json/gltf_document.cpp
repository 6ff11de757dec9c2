#include "io/with_nlohmann_json/gltf_document.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <optional>
#include <utility>

#include "core/format.hpp"
#include "io/base64.hpp"
#include "io/gltf.hpp"
#include "io/libraries.hpp"
#include "io/meshopt.hpp"
#include "io/scalar.hpp"

namespace pointskin::io {
namespace {

using Json = nlohmann::ordered_json;

std::uint32_t word(std::string_view bytes, std::size_t at) { return load<std::uint32_t>(bytes.data() + at, false); }

std::optional<AttributeType> type_of_component(std::int64_t component) {
  switch (component) {
    case kGltfInt8:
      return AttributeType::int8;
    case kGltfUint8:
      return AttributeType::uint8;
    case kGltfInt16:
      return AttributeType::int16;
    case kGltfUint16:
      return AttributeType::uint16;
    case kGltfUint32:
      return AttributeType::uint32;
    case kGltfFloat:
      return AttributeType::float32;
    default:
      return std::nullopt;
  }
}

std::size_t components_of(const std::string& type) {
  if (type == "SCALAR") return 1;
  if (type == "VEC2") return 2;
  if (type == "VEC3") return 3;
  return type == "VEC4" ? 4 : 0;
}

constexpr std::array<std::pair<std::string_view, MeshoptMode>, 3> kModes{{{"ATTRIBUTES", MeshoptMode::attributes},
                                                                          {"TRIANGLES", MeshoptMode::triangles},
                                                                          {"INDICES", MeshoptMode::indices}}};
constexpr std::array<std::pair<std::string_view, MeshoptFilter>, 4> kFilters{
    {{"NONE", MeshoptFilter::none},
     {"OCTAHEDRAL", MeshoptFilter::octahedral},
     {"QUATERNION", MeshoptFilter::quaternion},
     {"EXPONENTIAL", MeshoptFilter::exponential}}};

/// What the value of `key` stands for, the first choice where there is none; nothing for an unknown one.
template <class Choice, std::size_t N>
std::optional<Choice> choice_of(const Json& object, const char* key,
                                const std::array<std::pair<std::string_view, Choice>, N>& choices) {
  const auto at = object.find(key);
  if (at == object.end()) return choices[0].second;
  for (const auto& [word, choice] : choices)
    if (*at == word) return choice;
  return std::nullopt;
}

/// What a view or buffer says of meshoptimizer's coding, or null.
const Json* packing_of(const Json& object) {
  const auto extensions = object.find("extensions");
  if (extensions == object.end() || !extensions->is_object()) return nullptr;
  const auto found = extensions->find(kMeshoptExtension);
  return found != extensions->end() && found->is_object() ? &*found : nullptr;
}

/// True for a buffer without bytes, of the length that unpacked views would have.
bool is_stand_in(const Json& buffer) { return buffer.is_object() && !buffer.contains("uri") && packing_of(buffer); }

}  // namespace

double GltfArray::at(std::size_t row, std::size_t component) const {
  return visit_type(type, [&](auto tag) {
    const char* from = bytes.data() + (row * components + component) * sizeof(tag);
    return static_cast<double>(load<decltype(tag)>(from, false));
  });
}

double GltfArray::share(std::size_t row, std::size_t component) const {
  const double value = at(row, component);
  if (!normalised || !is_integer(type)) return value;
  const bool has_sign = type == AttributeType::int8 || type == AttributeType::int16;
  const double most = std::ldexp(1.0, static_cast<int>(8 * size_of(type)) - (has_sign ? 1 : 0)) - 1;
  return std::max(value / most, -1.0);
}

GltfDocument::GltfDocument(const Source& source) : source_(source) {
  const std::string_view bytes = source.bytes;
  if (bytes.size() < 12 || word(bytes, 0) != kGlbMagic) {
    read_json(bytes);
    read_buffers({});
    return;
  }
  if (word(bytes, 4) != 2) fail_here(fmt::format("is glTF of version {}, not 2", word(bytes, 4)));
  std::string_view json, binary;
  bool has_json = false;
  for (std::size_t at = 12; at + 8 <= bytes.size();) {
    const std::uint32_t length = word(bytes, at), kind = word(bytes, at + 4);
    if (!fits(length, 1, bytes.size() - at - 8))
      fail_at_byte(source_, "is truncated, a chunk ends behind the file", bytes.size(),
                   "copy or export the file again");
    const std::string_view chunk = bytes.substr(at + 8, length);
    if (kind == kGlbJson && !has_json) json = chunk, has_json = true;
    if (kind == kGlbBinary && binary.empty()) binary = chunk;
    at += 8 + (std::size_t{length} + 3) / 4 * 4;
  }
  if (!has_json) fail_here("holds no JSON");
  read_json(json);
  read_buffers(binary);
}

void GltfDocument::fail_here(const std::string& what) const { fail(source_, what, "export the file again"); }

void GltfDocument::read_json(std::string_view text) {
  json_ = Json::parse(text.begin(), text.end(), nullptr, false);
  if (!json_.is_object()) fail_here("holds no JSON that can be read");
  const Json& required = json_.value("extensionsRequired", Json::array());
  for (const Json& extension : required)
    if (extension != kQuantizationExtension && !(kHasMeshoptimizer && extension == kMeshoptExtension))
      fail(source_,
           "needs the extension " + in_quotes(extension.is_string() ? extension.get<std::string>() : "?") +
               ", which cannot be read",
           "export it without compression");
}

std::string GltfDocument::load_uri(const std::string& uri) const {
  if (uri.starts_with("data:")) {
    const std::size_t comma = uri.find(";base64,");
    if (comma == std::string::npos) fail_here("holds a data URI that is not base64");
    return from_base64(std::string_view(uri).substr(comma + 8));
  }
  const std::filesystem::path name(uri);
  if (name.is_absolute() || uri.find("..") != std::string::npos || uri.find(':') != std::string::npos)
    fail_here("names the file " + in_quotes(uri) + ", which is not in its own folder");
  const std::filesystem::path path = std::filesystem::path(source_.name).parent_path() / name;
  std::ifstream in(path, std::ios::binary);
  std::string bytes;
  std::array<char, 65536> piece{};
  while (in.read(piece.data(), piece.size()) || in.gcount() > 0)
    bytes.append(piece.data(), static_cast<std::size_t>(in.gcount()));
  if (!in.is_open() || in.bad())
    fail(source_, "needs the file " + in_quotes(uri) + ", which cannot be read", "put it beside this one");
  return bytes;
}

void GltfDocument::read_buffers(std::string_view binary) {
  const Json& list = json_.value("buffers", Json::array());
  if (!list.is_array()) fail_here("its buffers are no list");
  owned_.reserve(list.size());  // views refer to them
  for (const Json& buffer : list) {
    if (is_stand_in(buffer)) {
      buffers_.emplace_back();
      continue;
    }
    std::string_view bytes = binary;
    if (buffer.is_object() && buffer.contains("uri") && buffer["uri"].is_string())
      bytes = owned_.emplace_back(load_uri(buffer["uri"].get<std::string>()));
    const std::int64_t length = whole(buffer, "byteLength", 0);
    if (length < 0 || static_cast<std::uint64_t>(length) > bytes.size())
      fail_here(fmt::format("is truncated, a buffer promises {} bytes and has {}", length, bytes.size()));
    buffers_.push_back(bytes.substr(0, static_cast<std::size_t>(length)));
  }
}

std::int64_t GltfDocument::whole(const Json& object, const char* key, std::int64_t fallback) const {
  if (!object.is_object()) fail_here(fmt::format("something that should have the key '{}' is no object", key));
  const auto at = object.find(key);
  if (at == object.end()) return fallback;
  if (!at->is_number_integer()) fail_here(fmt::format("'{}' is no whole number", key));
  return at->is_number_unsigned() && at->get<std::uint64_t>() > std::uint64_t{1} << 62U ? -1 : at->get<std::int64_t>();
}

const Json& GltfDocument::item(const char* list, std::int64_t index) const {
  const auto at = json_.find(list);
  if (at == json_.end() || !at->is_array() || index < 0 || index >= static_cast<std::int64_t>(at->size()) ||
      !(*at)[static_cast<std::size_t>(index)].is_object())
    fail_here(fmt::format("names number {} of its {}, which there is not", index, list));
  return (*at)[static_cast<std::size_t>(index)];
}

std::string_view GltfDocument::view_bytes(std::int64_t index, std::string& room) const {
  const Json& view = item("bufferViews", index);
  const Json* const packing = kHasMeshoptimizer ? packing_of(view) : nullptr;
  if (packing == nullptr) return buffer_bytes(view);
  return room = unpacked(*packing);
}

std::string GltfDocument::unpacked(const Json& packing) const {
  if constexpr (kHasMeshoptimizer) {
    const std::int64_t count = whole(packing, "count", -1), stride = whole(packing, "byteStride", -1);
    const auto mode = choice_of(packing, "mode", kModes);
    const auto filter = choice_of(packing, "filter", kFilters);
    if (count >= 0 && stride > 0 && mode && filter)
      if (std::optional<std::string> values =
              decode_rows(buffer_bytes(packing),
                          {static_cast<std::size_t>(count), static_cast<std::size_t>(stride), *mode, *filter}))
        return *std::move(values);
  }
  fail_here("has a compressed view that cannot be unpacked");
}

std::string_view GltfDocument::buffer_bytes(const Json& view) const {
  const std::int64_t buffer = whole(view, "buffer", -1);
  if (buffer < 0 || buffer >= static_cast<std::int64_t>(buffers_.size())) fail_here("names a buffer that there is not");
  const std::string_view bytes = buffers_[static_cast<std::size_t>(buffer)];
  const std::int64_t offset = whole(view, "byteOffset", 0), length = whole(view, "byteLength", -1);
  if (offset < 0 || length < 0 || static_cast<std::uint64_t>(offset) > bytes.size() ||
      static_cast<std::uint64_t>(length) > bytes.size() - static_cast<std::uint64_t>(offset))
    fail_here("a view reaches beyond its buffer");
  return bytes.substr(static_cast<std::size_t>(offset), static_cast<std::size_t>(length));
}

void GltfDocument::copy_elements(const Json& accessor, GltfArray& array) const {
  const std::int64_t view = whole(accessor, "bufferView", -1);
  const std::size_t row = array.components * size_of(array.type);
  const std::int64_t offset = whole(accessor, "byteOffset", 0);
  const std::int64_t given = whole(item("bufferViews", view), "byteStride", 0);
  std::string room;
  const std::string_view bytes = view_bytes(view, room);
  if (offset < 0 || static_cast<std::uint64_t>(offset) > bytes.size() || given < 0 || given > 252)
    fail_here("an accessor reaches beyond its view");
  const std::size_t stride = given == 0 ? row : static_cast<std::size_t>(given);
  const std::string_view from = bytes.substr(static_cast<std::size_t>(offset));
  if (stride < row || (array.count > 0 && (from.size() < row || !fits(array.count - 1, stride, from.size() - row))))
    fail_here(fmt::format("an accessor promises {} elements, more than its view holds", array.count));
  array.bytes.resize(array.count * row);
  for (std::size_t i = 0; i < array.count; ++i)
    std::memcpy(array.bytes.data() + i * row, from.data() + i * stride, row);
}

void GltfDocument::apply_sparse(const Json& sparse, GltfArray& array) const {
  if (!sparse.is_object() || !sparse.contains("indices") || !sparse.contains("values"))
    fail_here("a sparse accessor lacks indices or values");
  const auto part = [&](const Json& from, std::size_t components, AttributeType type) {
    GltfArray found{
        static_cast<std::size_t>(std::max<std::int64_t>(whole(sparse, "count", 0), 0)), components, type, false, {}};
    copy_elements(from, found);
    return found;
  };
  const auto index_type = type_of_component(whole(sparse["indices"], "componentType", 0));
  if (!index_type || !is_integer(*index_type)) fail_here("a sparse accessor has indices of an unknown type");
  const GltfArray places = part(sparse["indices"], 1, *index_type);
  const GltfArray values = part(sparse["values"], array.components, array.type);
  const std::size_t row = array.components * size_of(array.type);
  for (std::size_t i = 0; i < places.count; ++i) {
    const double place = places.at(i, 0);
    if (!(place >= 0) || place >= static_cast<double>(array.count))
      fail_here("a sparse accessor names an element that there is not");
    std::memcpy(array.bytes.data() + static_cast<std::size_t>(place) * row, values.bytes.data() + i * row, row);
  }
}

GltfArray GltfDocument::array(std::int64_t index) const {
  const Json& accessor = item("accessors", index);
  GltfArray array;
  const auto type = type_of_component(whole(accessor, "componentType", 0));
  const Json& shape = accessor.value("type", Json());
  array.components = shape.is_string() ? components_of(shape.get<std::string>()) : 0;
  if (!type || array.components == 0) fail_here(fmt::format("accessor {} has an unknown type", index));
  array.type = *type;
  const Json& normalised = accessor.value("normalized", Json(false));
  array.normalised = normalised.is_boolean() && normalised.get<bool>();
  const std::int64_t count = whole(accessor, "count", -1);
  if (count < 0) fail_here(fmt::format("accessor {} has no count", index));
  array.count = static_cast<std::size_t>(count);
  if (accessor.contains("bufferView"))
    copy_elements(accessor, array);
  else if (!fits(array.count, array.components * size_of(array.type), source_.bytes.size()))
    fail_here(fmt::format("accessor {} promises {} zeros, more than a file of this size needs", index, count));
  else
    array.bytes.resize(array.count * array.components * size_of(array.type));
  if (accessor.contains("sparse")) apply_sparse(accessor["sparse"], array);
  return array;
}

}  // namespace pointskin::io
