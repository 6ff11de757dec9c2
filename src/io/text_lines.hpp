// Meshes as lines of text.
#pragma once

#include <algorithm>
#include <array>
#include <charconv>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

#include <pointskin/mesh.hpp>

#include "io/writers.hpp"

namespace pointskin::io {

/// A line that is put together without allocating.
class LineBuffer {
 public:
  void add(std::string_view text) { at_ = std::copy(text.begin(), text.end(), at_); }
  template <class Number>
  void add_number(Number value) {
    at_ = std::to_chars(at_, text_.data() + text_.size(), value).ptr;
  }
  /// A value in 0..255 as a share of 255. Three digits tell all 256 apart.
  void add_share(std::uint8_t value) {
    const float share = static_cast<float>(value) / 255;
    add(" ");
    at_ = std::to_chars(at_, text_.data() + text_.size(), share, std::chars_format::fixed, 3).ptr;
  }
  /// Appends the line and an end of line to `out` and starts anew.
  void flush_to(std::string& out) {
    *at_++ = '\n';
    out.append(text_.data(), at_);
    at_ = text_.data();
  }

 private:
  std::array<char, 256>
      text_;  // three numbers of at most 24 characters and a colour, or six ids of at most 11, and little else
  char* at_ = text_.data();
};

/// A keyword and three numbers.
template <class Number>
void add_three(LineBuffer& line, std::string_view keyword, Number x, Number y, Number z) {
  line.add(keyword);
  for (const Number value : {x, y, z}) {
    line.add(" ");
    line.add_number(value);
  }
}

/// The attributes red, green and blue, if all are there and bytes: for others nobody knows what is white.
inline std::optional<std::array<const std::uint8_t*, 3>> colour_of(const Mesh& mesh) {
  std::array<const std::uint8_t*, 3> colour{};
  for (const Attribute& a : mesh.attributes) {
    if (a.type() != AttributeType::uint8 || a.values.size() != mesh.vertices.size()) continue;
    const std::uint8_t* values = a.values.as<std::uint8_t>().data();
    if (a.name == "red") colour[0] = values;
    if (a.name == "green") colour[1] = values;
    if (a.name == "blue") colour[2] = values;
  }
  if (std::find(colour.begin(), colour.end(), nullptr) != colour.end()) return std::nullopt;
  return colour;
}

/// A section of lines: write(i, line) makes line i.
template <class Write>
Section lines(std::size_t rows, const Write& write) {
  return {rows, [write](std::size_t first, std::size_t last, std::string& bytes) {
            LineBuffer line;
            for (std::size_t i = first; i < last; ++i) {
              write(i, line);
              line.flush_to(bytes);
            }
          }};
}

}  // namespace pointskin::io
