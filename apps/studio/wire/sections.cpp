#include "sections.hpp"

#include <array>
#include <cstring>
#include <utility>

#include <meshoptimizer.h>

#include "parts.hpp"

namespace pointskin::studio::wire {
namespace {

constexpr std::size_t kAlignment = 8;
constexpr std::uint32_t kVersion = 1;

std::size_t aligned(std::size_t bytes) { return (bytes + kAlignment - 1) / kAlignment * kAlignment; }

}  // namespace

void Sections::add(const std::string& name, const std::string& type, std::size_t stride, std::size_t count, Fill fill) {
  sections_.push_back({name, type, stride, count, std::move(fill)});
}

void Sections::add_triangles(std::span<const std::uint32_t> indices, std::size_t vertices) {
  using Corners = std::array<std::uint32_t, 3>;
  const std::span triangles(reinterpret_cast<const Corners*>(indices.data()), indices.size() / 3);
  add("triangles", "u32x3", sizeof(Corners), triangles.size(), copy_of(triangles));
  sections_.back().vertices = vertices;
}

/// By the codec that suits the section, if one does.
void Sections::pack(Section& section) const {
  if (section.stride % 4 != 0 || section.count == 0) return;
  std::vector<unsigned char> raw(section.stride * section.count);
  write(section, reinterpret_cast<std::byte*>(raw.data()));
  if (section.vertices > 0) {
    const auto* indices = reinterpret_cast<const std::uint32_t*>(raw.data());
    const std::size_t count = 3 * section.count;
    section.packed.resize(meshopt_encodeIndexBufferBound(count, section.vertices));
    section.packed.resize(meshopt_encodeIndexBuffer(section.packed.data(), section.packed.size(), indices, count));
    section.codec = "index";
  } else {
    section.packed.resize(meshopt_encodeVertexBufferBound(section.count, section.stride));
    section.packed.resize(meshopt_encodeVertexBuffer(section.packed.data(), section.packed.size(), raw.data(),
                                                     section.count, section.stride));
    section.codec = "vertex";
  }
}

void Sections::write(const Section& section, std::byte* out) const {
  if (!section.packed.empty()) {
    std::memcpy(out, section.packed.data(), section.packed.size());
    return;
  }
  for_parts(section.count, threads_, [&section, out](std::size_t begin, std::size_t end) {
    section.fill(out + begin * section.stride, begin, end);
  });
}

std::vector<std::byte> Sections::finish(nlohmann::ordered_json header) && {
  nlohmann::ordered_json list = nlohmann::ordered_json::array();
  std::vector<std::size_t> offsets;
  std::size_t bytes = 0;
  for (Section& section : sections_) {
    if (compressed_) pack(section);
    offsets.push_back(aligned(bytes));
    bytes = offsets.back() + section.bytes();
    list.push_back({{"name", section.name},
                    {"offset", offsets.back()},
                    {"bytes", section.bytes()},
                    {"count", section.count},
                    {"stride", section.stride},
                    {"codec", section.codec},
                    {"type", section.type}});
  }
  header["sections"] = std::move(list);
  std::string text = header.dump();
  text.resize(aligned(text.size()), ' ');
  const std::array<std::uint32_t, 3> words = {kVersion, static_cast<std::uint32_t>(text.size()), 0};
  std::vector<std::byte> blob(kHeadBytes + text.size() + bytes);
  std::memcpy(blob.data(), "PSKB", 4);
  std::memcpy(blob.data() + 4, words.data(), sizeof words);
  std::memcpy(blob.data() + kHeadBytes, text.data(), text.size());
  for (std::size_t i = 0; i < sections_.size(); ++i)
    write(sections_[i], blob.data() + kHeadBytes + text.size() + offsets[i]);
  return blob;
}

}  // namespace pointskin::studio::wire
