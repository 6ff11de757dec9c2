#include "colours.hpp"

#include <algorithm>

namespace pointskin::studio::wire {
namespace {

const AttributeValues* find(const std::vector<Attribute>& attributes, const char* name) {
  for (const Attribute& attribute : attributes)
    if (attribute.name == name) return &attribute.values;
  return nullptr;
}

double to_bytes(AttributeType type) {
  if (type == AttributeType::float32 || type == AttributeType::float64) return 255;
  return type == AttributeType::uint16 ? 1.0 / 257 : 1;
}

}  // namespace

std::vector<std::uint8_t> colours_of(const std::vector<Attribute>& attributes, std::size_t size) {
  const AttributeValues* red = find(attributes, "red");
  const AttributeValues* green = find(attributes, "green");
  const AttributeValues* blue = find(attributes, "blue");
  if (red == nullptr || green == nullptr || blue == nullptr) return {};
  const double scale = to_bytes(red->type());
  const auto byte = [scale](double value) {
    return static_cast<std::uint8_t>(value > 0 ? std::min(255.0, scale * value + 0.5) : 0);
  };
  std::vector<std::uint8_t> colours;
  colours.reserve(4 * size);
  for (std::size_t i = 0; i < size; ++i)
    colours.insert(colours.end(), {byte(red->at(i)), byte(green->at(i)), byte(blue->at(i)), 255});
  return colours;
}

}  // namespace pointskin::studio::wire
