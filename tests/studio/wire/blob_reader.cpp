#include "studio/wire/blob_reader.hpp"

#include <array>
#include <cmath>
#include <stdexcept>

#include <meshoptimizer.h>

namespace pointskin::test {
namespace {

void require(bool holds, const std::string& what) {
  if (!holds) throw std::runtime_error("blob: " + what);
}

std::uint32_t word(const std::vector<std::byte>& blob, std::size_t at) {
  std::uint32_t value = 0;
  std::memcpy(&value, blob.data() + at, sizeof value);
  return value;
}

constexpr std::size_t kHead = 16;

}  // namespace

BlobReader::BlobReader(const std::vector<std::byte>& blob) {
  require(blob.size() >= kHead, "no head");
  require(std::memcmp(blob.data(), "PSKB", 4) == 0, "no magic");
  require(word(blob, 4) == 1, "another version");
  const std::size_t header_bytes = word(blob, 8);
  require(word(blob, 12) == 0 && header_bytes % 8 == 0, "the head is not as it should be");
  require(blob.size() >= kHead + header_bytes, "the header is cut off");
  const auto* text = reinterpret_cast<const char*>(blob.data()) + kHead;
  header_ = nlohmann::json::parse(text, text + header_bytes);
  data_.assign(blob.begin() + static_cast<std::ptrdiff_t>(kHead + header_bytes), blob.end());
  std::size_t end = 0;
  for (const auto& section : header_.at("sections")) {
    const std::size_t offset = section.at("offset");
    require(offset % 8 == 0 && offset >= end && offset - end < 8, "a section is not where it should be");
    end = offset + section.at("bytes").get<std::size_t>();
  }
  require(end == data_.size(), "bytes behind the sections");
}

bool BlobReader::has(const std::string& name) const {
  for (const auto& section : header_.at("sections"))
    if (section.at("name") == name) return true;
  return false;
}

nlohmann::json BlobReader::section(const std::string& name) const {
  for (const auto& section : header_.at("sections"))
    if (section.at("name") == name) return section;
  throw std::runtime_error("blob: no section " + name);
}

std::vector<std::byte> BlobReader::bytes(const std::string& name) const {
  const nlohmann::json section = this->section(name);
  const std::string codec = section.at("codec");
  const std::size_t count = section.at("count");
  const std::size_t stride = section.at("stride");
  const std::size_t packed = section.at("bytes");
  const std::byte* from = data_.data() + section.at("offset").get<std::size_t>();
  if (codec == "raw") {
    require(packed == count * stride, name + " has another length than its elements");
    return {from, from + packed};
  }
  std::vector<std::byte> out(count * stride);
  const auto* source = reinterpret_cast<const unsigned char*>(from);
  if (codec == "vertex")
    require(meshopt_decodeVertexBuffer(out.data(), count, stride, source, packed) == 0, name + " does not unpack");
  else
    require(codec == "index" && meshopt_decodeIndexBuffer(out.data(), 3 * count, 4, source, packed) == 0,
            name + " does not unpack");
  return out;
}

Vec3d BlobReader::corner(const char* name) const {
  const auto c = header_.at("box").at(name).get<std::array<double, 3>>();
  return {c[0], c[1], c[2]};
}

std::vector<Vec3d> BlobReader::positions() const {
  const auto steps = numbers<std::array<std::uint16_t, 4>>("positions");
  const Vec3d low = lower();
  const Vec3d extent = upper() - low;
  std::vector<Vec3d> out;
  for (const auto& s : steps)
    out.push_back({low.x + extent.x * s[0] / 65535, low.y + extent.y * s[1] / 65535, low.z + extent.z * s[2] / 65535});
  return out;
}

std::vector<Vec3d> BlobReader::normals() const {
  std::vector<Vec3d> out;
  for (const auto& code : numbers<std::array<std::uint8_t, 4>>("normals")) {
    Vec3d n{(code[0] - 127) / 127.0, (code[1] - 127) / 127.0, 0};
    n.z = 1 - std::abs(n.x) - std::abs(n.y);
    const double fold = std::max(-n.z, 0.0);
    n.x += n.x < 0 ? fold : -fold;
    n.y += n.y < 0 ? fold : -fold;
    out.push_back(n / std::sqrt(squared_length(n)));
  }
  return out;
}

}  // namespace pointskin::test
