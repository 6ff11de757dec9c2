#include "sections.hpp"

#include <array>
#include <cstring>
#include <utility>

#include <meshoptimizer.h>

namespace pointskin::studio::wire {
namespace {

constexpr std::size_t kAlignment = 8;
constexpr std::uint32_t kVersion = 1;

std::span<const std::byte> bytes_of(const std::vector<unsigned char>& data) { return std::as_bytes(std::span(data)); }

const char* name_of(Codec codec) {
  constexpr std::array<const char*, 3> kNames = {"raw", "vertex", "index"};
  return kNames[static_cast<std::size_t>(codec)];
}

}  // namespace

void Sections::add(const std::string& name, const std::string& type, std::size_t stride,
                   std::span<const std::byte> data) {
  const std::size_t count = data.size() / stride;
  if (!compressed_ || stride % 4 != 0 || count == 0) {
    append(name, type, stride, count, Codec::raw, data);
    return;
  }
  std::vector<unsigned char> packed(meshopt_encodeVertexBufferBound(count, stride));
  packed.resize(meshopt_encodeVertexBuffer(packed.data(), packed.size(), data.data(), count, stride));
  append(name, type, stride, count, Codec::vertex, bytes_of(packed));
}

void Sections::add_triangles(std::span<const std::uint32_t> indices, std::size_t vertices) {
  constexpr std::size_t kStride = 3 * sizeof(std::uint32_t);
  if (!compressed_ || indices.empty()) {
    append("triangles", "u32x3", kStride, indices.size() / 3, Codec::raw, std::as_bytes(indices));
    return;
  }
  std::vector<unsigned char> packed(meshopt_encodeIndexBufferBound(indices.size(), vertices));
  packed.resize(meshopt_encodeIndexBuffer(packed.data(), packed.size(), indices.data(), indices.size()));
  append("triangles", "u32x3", kStride, indices.size() / 3, Codec::index, bytes_of(packed));
}

void Sections::append(const std::string& name, const std::string& type, std::size_t stride, std::size_t count,
                      Codec codec, std::span<const std::byte> bytes) {
  data_.resize((data_.size() + kAlignment - 1) / kAlignment * kAlignment);
  list_.push_back({{"name", name},
                   {"offset", data_.size()},
                   {"bytes", bytes.size()},
                   {"count", count},
                   {"stride", stride},
                   {"codec", name_of(codec)},
                   {"type", type}});
  data_.insert(data_.end(), bytes.begin(), bytes.end());
}

std::vector<std::byte> Sections::finish(nlohmann::ordered_json header) && {
  header["sections"] = std::move(list_);
  std::string text = header.dump();
  text.resize((text.size() + kAlignment - 1) / kAlignment * kAlignment, ' ');
  const std::array<std::uint32_t, 3> words = {kVersion, static_cast<std::uint32_t>(text.size()), 0};
  std::vector<std::byte> blob(kHeadBytes + text.size() + data_.size());
  std::memcpy(blob.data(), "PSKB", 4);
  std::memcpy(blob.data() + 4, words.data(), sizeof words);
  std::memcpy(blob.data() + kHeadBytes, text.data(), text.size());
  if (!data_.empty()) std::memcpy(blob.data() + kHeadBytes + text.size(), data_.data(), data_.size());
  return blob;
}

}  // namespace pointskin::studio::wire
