// A blob that is being put together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pointskin::studio::wire {

/// Bytes before the header, and where among them its length is.
inline constexpr std::size_t kHeadBytes = 16, kHeaderBytesAt = 8;

/// How a section is packed.
enum class Codec { raw, vertex, index };

class Sections {
 public:
  explicit Sections(bool compressed) : compressed_(compressed) {}

  /// @param stride  bytes of an element; a multiple of 4 where it is to be compressed
  /// @param type    of its numbers, for the page: "u16x4"
  void add(const std::string& name, const std::string& type, std::size_t stride, std::span<const std::byte> data);
  /// Triangles: three indices of 32 bits each. @param vertices  that there are
  void add_triangles(std::span<const std::uint32_t> indices, std::size_t vertices);

  /// @param header  what it says beside the sections
  [[nodiscard]] std::vector<std::byte> finish(nlohmann::ordered_json header) &&;

 private:
  void append(const std::string& name, const std::string& type, std::size_t stride, std::size_t count, Codec codec,
              std::span<const std::byte> bytes);

  bool compressed_;
  nlohmann::ordered_json list_ = nlohmann::ordered_json::array();
  std::vector<std::byte> data_;
};

}  // namespace pointskin::studio::wire
