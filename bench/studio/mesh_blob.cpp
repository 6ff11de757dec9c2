#include "mesh_blob.hpp"

#include <cstring>
#include <span>
#include <stdexcept>
#include <string>

#include <meshoptimizer.h>
#include <nlohmann/json.hpp>

namespace pointskin::bench {
namespace {

using Json = nlohmann::json;

std::uint32_t word_at(const std::vector<std::byte>& blob, std::size_t offset) {
  std::uint32_t word = 0;
  std::memcpy(&word, blob.data() + offset, sizeof word);
  return word;
}

template <class T>
std::vector<T> decode(const Json& section, std::span<const std::byte> all) {
  const auto count = section["count"].get<std::size_t>();
  const auto stride = section["stride"].get<std::size_t>();
  const auto bytes = all.subspan(section["offset"].get<std::size_t>(), section["bytes"].get<std::size_t>());
  const auto* data = reinterpret_cast<const unsigned char*>(bytes.data());
  const std::string codec = section["codec"];
  std::vector<T> out(count * stride / sizeof(T));
  int failed = 0;
  if (codec == "raw") {
    if (bytes.size() != count * stride) throw std::runtime_error("a raw section has another size than it says");
    std::memcpy(out.data(), data, bytes.size());
  } else if (codec == "vertex") {
    failed = meshopt_decodeVertexBuffer(out.data(), count, stride, data, bytes.size());
  } else {
    failed = meshopt_decodeIndexBuffer(out.data(), count * stride / sizeof(std::uint32_t), sizeof(std::uint32_t), data,
                                       bytes.size());
  }
  if (failed != 0) throw std::runtime_error("a section cannot be decoded");
  return out;
}

}  // namespace

DrawnMesh decode_mesh(const std::vector<std::byte>& blob) {
  constexpr std::size_t kHead = 16;
  if (blob.size() < kHead || std::memcmp(blob.data(), "PSKB", 4) != 0) throw std::runtime_error("not a blob");
  const std::size_t header_bytes = word_at(blob, 8);
  const auto* text = reinterpret_cast<const char*>(blob.data()) + kHead;
  const Json header = Json::parse(text, text + header_bytes);
  const auto sections = std::span(blob).subspan(kHead + header_bytes);
  DrawnMesh mesh;
  for (const Json& section : header["sections"]) {
    if (section["name"] == "positions") mesh.positions = decode<std::uint16_t>(section, sections);
    if (section["name"] == "normals") mesh.normals = decode<std::uint8_t>(section, sections);
    if (section["name"] == "triangles") mesh.triangles = decode<std::uint32_t>(section, sections);
  }
  return mesh;
}

}  // namespace pointskin::bench
