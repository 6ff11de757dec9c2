#include "render/shading.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <string>

namespace pointskin::render_detail {
namespace {

using mesh_detail::dot;
using mesh_detail::normalized;
using mesh_detail::plus;
using mesh_detail::times;

Colour from_srgb(double r, double g, double b) { return {decode_srgb(r), decode_srgb(g), decode_srgb(b)}; }

Colour multiply(const Colour& a, const Colour& b) { return {a[0] * b[0], a[1] * b[1], a[2] * b[2]}; }

Colour mix(const Colour& a, const Colour& b, double t) { return plus(times(1 - t, a), times(t, b)); }

/// Light that wraps a little around the edge of what it lights, as that of a large lamp does; 1 when facing it.
double wrapped(double cosine, double wrap) {
  const double x = std::max(0.0, (cosine + wrap) / (1 + wrap));
  return x * x;
}

const Attribute* find_attribute(const Mesh& mesh, const std::string& name) {
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.name == name && attribute.values.size() == mesh.vertices.size()) return &attribute;
  return nullptr;
}

/// What is white: as much as their type holds in bytes and in numbers of 16 bits, else 1 or, if one is larger, 255.
double white_of(const std::array<const Attribute*, 3>& channels) {
  double white = 1;
  for (const Attribute* channel : channels) {
    if (channel->type() == AttributeType::uint16) return 65535;
    const bool exceeds = channel->values.visit(
        [](const auto& values) { return std::any_of(values.begin(), values.end(), [](auto v) { return v > 1; }); });
    if (channel->type() == AttributeType::uint8 || exceeds) white = 255;
  }
  return white;
}

}  // namespace

double decode_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

SrgbEncoder::SrgbEncoder() {
  for (std::size_t i = 0; i <= kTableSize; ++i) {
    const double linear = static_cast<double>(i) / static_cast<double>(kTableSize);
    const double encoded = linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
    table_[i] = static_cast<std::uint8_t>(std::lround(255 * encoded));
  }
}

std::uint8_t SrgbEncoder::operator()(double linear) const {
  // A comparison that fails for NaN comes first.
  const double clamped = linear > 0 ? std::min(linear, 1.0) : 0;
  return table_[static_cast<std::size_t>(clamped * static_cast<double>(kTableSize) + 0.5)];
}

Colour background(double height) {
  static const Colour kTop = from_srgb(0.985, 0.988, 0.992);
  static const Colour kBottom = from_srgb(0.845, 0.855, 0.870);
  return mix(kBottom, kTop, std::clamp(height, 0.0, 1.0));
}

Colour clay() { return from_srgb(0.80, 0.775, 0.745); }

Colour behind() { return from_srgb(0.80, 0.36, 0.25); }

Colour shade(const Colour& albedo, const Vec3d& normal, const Vec3d& up) {
  static const Vec3d kKey = normalized({-0.55, 0.70, 0.65});
  static const Vec3d kFill = normalized({0.85, 0.10, 0.45});
  static const Vec3d kKeyHalf = normalized(plus(kKey, {0, 0, 1}));
  constexpr Colour kKeyLight{1.00, 0.96, 0.90}, kFillLight{0.14, 0.17, 0.22};
  constexpr Colour kSky{0.27, 0.30, 0.35}, kGround{0.11, 0.10, 0.09};

  const double skyward = 0.5 + 0.5 * dot(normal, up);
  Colour light = mix(kGround, kSky, skyward);
  light = plus(light, times(wrapped(dot(normal, kKey), 0.15), kKeyLight));
  light = plus(light, times(wrapped(dot(normal, kFill), 0.4), kFillLight));
  const double sheen = 0.06 * std::pow(std::max(0.0, dot(normal, kKeyHalf)), 24);
  return plus(multiply(albedo, light), times(sheen, kKeyLight));
}

std::vector<Vec3f> vertex_colours(const Mesh& mesh) {
  const Attribute* const red = find_attribute(mesh, "red");
  const Attribute* const green = find_attribute(mesh, "green");
  const Attribute* const blue = find_attribute(mesh, "blue");
  if (red == nullptr || green == nullptr || blue == nullptr) return {};
  const double white = white_of({red, green, blue});
  const auto linear = [&](const Attribute* channel, std::size_t v) {
    return static_cast<float>(decode_srgb(std::clamp(channel->values.at(v) / white, 0.0, 1.0)));
  };
  std::vector<Vec3f> colours(mesh.vertices.size());
  for (std::size_t v = 0; v < colours.size(); ++v) colours[v] = {linear(red, v), linear(green, v), linear(blue, v)};
  return colours;
}

}  // namespace pointskin::render_detail
