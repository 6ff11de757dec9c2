// A blob that is being put together.
#pragma once

#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

namespace pointskin::studio::wire {

/// Bytes before the header, and where among them its length is.
inline constexpr std::size_t kHeadBytes = 16, kHeaderBytesAt = 8;

/// Writes elements [begin, end) of a section; `out` is where the first of these goes. Called by several threads for
/// different elements.
using Fill = std::function<void(std::byte* out, std::size_t begin, std::size_t end)>;

/// What sections hold is asked for when the blob is finished, and goes to its place without another copy.
class Sections {
 public:
  /// @param threads  that fill; 0: as many as copying can use
  explicit Sections(bool compressed, int threads = 1) : compressed_(compressed), threads_(threads) {}

  /// @param stride  bytes of an element; it is compressed if that is a multiple of 4
  /// @param type    of its numbers, for the page: "u16x4"
  void add(const std::string& name, const std::string& type, std::size_t stride, std::size_t count, Fill fill);
  /// Triangles: three indices of 32 bits each, kept as they are until finish(). @param vertices  that there are
  void add_triangles(std::span<const std::uint32_t> indices, std::size_t vertices);

  /// @param header  what it says beside the sections
  [[nodiscard]] std::vector<std::byte> finish(nlohmann::ordered_json header) &&;

 private:
  struct Section {
    std::string name, type;
    std::size_t stride, count;
    Fill fill;
    std::size_t vertices = 0;             ///< of triangles
    std::vector<unsigned char> packed{};  ///< empty: raw
    const char* codec = "raw";

    [[nodiscard]] std::size_t bytes() const { return packed.empty() ? stride * count : packed.size(); }
  };

  void pack(Section& section) const;
  void write(const Section& section, std::byte* out) const;

  bool compressed_;
  int threads_;
  std::vector<Section> sections_;
};

/// The bytes of an array as a section's.
template <class T>
Fill copy_of(std::span<const T> values) {
  const std::span<const std::byte> bytes = std::as_bytes(values);
  return [bytes](std::byte* out, std::size_t begin, std::size_t end) {
    if (end > begin) std::memcpy(out, bytes.data() + begin * sizeof(T), (end - begin) * sizeof(T));
  };
}

}  // namespace pointskin::studio::wire
