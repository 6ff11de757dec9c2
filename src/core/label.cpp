// Which attributes are labels, by type and name.
#include <pointskin/attribute.hpp>

#include <algorithm>
#include <array>
#include <cctype>
#include <string_view>

namespace pointskin {
namespace {

bool is_letter(char c) { return std::isalpha(static_cast<unsigned char>(c)) != 0; }
bool is_lower(char c) { return std::islower(static_cast<unsigned char>(c)) != 0; }
bool is_upper(char c) { return std::isupper(static_cast<unsigned char>(c)) != 0; }

std::string lower(std::string_view name) {
  std::string text(name);
  for (char& c : text) c = static_cast<char>(std::tolower(static_cast<unsigned char>(c)));
  return text;
}

template <std::size_t kCount>
bool contains_any(const std::string& text, const std::array<std::string_view, kCount>& parts) {
  return std::any_of(parts.begin(), parts.end(),
                     [&](std::string_view part) { return text.find(part) != std::string::npos; });
}

template <std::size_t kCount>
bool is_any(std::string_view text, const std::array<std::string_view, kCount>& names) {
  return std::find(names.begin(), names.end(), text) != names.end();
}

/// True if a word of `name` is "part" or "id", which are too short to be looked for inside of words.
bool has_short_word(const std::string& name) {
  constexpr std::array<std::string_view, 4> kWords{"part", "parts", "id", "ids"};
  for (std::size_t begin = 0; begin < name.size();) {
    std::size_t end = begin;
    while (end < name.size() && is_letter(name[end]) &&
           (end == begin || !(is_lower(name[end - 1]) && is_upper(name[end]))))
      ++end;
    if (is_any(lower(std::string_view(name).substr(begin, end - begin)), kWords)) return true;
    begin = std::max(end, begin + 1);
  }
  return false;
}

bool sounds_like_colour(const std::string& name) {
  constexpr std::array<std::string_view, 10> kColours{"red", "green", "blue", "alpha", "r",
                                                      "g",   "b",     "a",    "gray",  "grey"};
  constexpr std::array<std::string_view, 4> kPrefixes{"diffuse_", "ambient_", "specular_", "emissive_"};
  constexpr std::array<std::string_view, 5> kIntensities{"intensity", "reflect", "amplitude", "luminance",
                                                         "brightness"};
  const std::string text = lower(name);
  std::string_view colour = text;
  while (colour.starts_with("input_")) colour.remove_prefix(6);
  for (const std::string_view prefix : kPrefixes)
    if (colour.starts_with(prefix)) colour.remove_prefix(prefix.size());
  return is_any(colour, kColours) || contains_any(text, kIntensities);
}

}  // namespace

bool sounds_like_label(const std::string& name) {
  constexpr std::array<std::string_view, 8> kLabels{"label",  "class",    "segment", "instance",
                                                    "object", "material", "cluster", "index"};
  return contains_any(lower(name), kLabels) || has_short_word(name);
}

bool is_label(const std::string& name, AttributeType type) {
  if (!is_integer(type)) return false;
  if (type == AttributeType::uint8) return sounds_like_label(name);
  if (type == AttributeType::uint16) return sounds_like_label(name) || !sounds_like_colour(name);
  return true;
}

}  // namespace pointskin
