#include "scene/text.hpp"

#include <charconv>
#include <cmath>

namespace pointskin::scene {

std::string one_line(const std::string& text) {
  std::string line;
  bool broken = false;
  for (const char c : text) {
    if (c == '\n' || c == '\r') {
      broken = !line.empty();
    } else if (!(broken && c == ' ')) {
      if (broken) line += "; ";
      broken = false;
      const auto code = static_cast<unsigned char>(c);
      line += code < 0x20 || code == 0x7f ? '?' : c;  // A file name must not steer the terminal.
    }
  }
  return line;
}

std::optional<double> take_number(std::string_view& text) {
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
  if (error != std::errc() || !std::isfinite(value)) return std::nullopt;
  text.remove_prefix(static_cast<std::size_t>(end - text.data()));
  return value;
}

std::optional<double> parse_number(const std::string& text) {
  std::string_view rest = text;
  const std::optional<double> number = take_number(rest);
  return rest.empty() ? number : std::nullopt;
}

std::optional<Vec3d> parse_vector(const std::string& text) {
  Vec3d vector{0, 0, 0};
  std::string_view rest = text;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    if (axis > 0 && rest.starts_with(',')) rest.remove_prefix(1);
    const std::optional<double> number = take_number(rest);
    const bool ends_well = axis == 2 ? rest.empty() : rest.starts_with(',');
    if (!number || !ends_well) return std::nullopt;
    vector[axis] = *number;
  }
  return vector;
}

}  // namespace pointskin::scene
