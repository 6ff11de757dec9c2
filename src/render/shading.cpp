#include "render/shading.hpp"
#include "core/vec3.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::render_detail {
namespace {

/// Light that wraps a little around the edge of what it lights, as that of a large lamp does; 1 when facing it.
double wrapped(double cosine, double wrap) {
  const double x = std::max(0.0, (cosine + wrap) / (1 + wrap));
  return x * x;
}

/// x^24, without a call.
double power_24(double x) {
  const double x2 = x * x, x4 = x2 * x2, x8 = x4 * x4;
  return x8 * x8 * x8;
}

}  // namespace

Colour background(double height) {
  static const Colour kTop = from_srgb(0.985, 0.988, 0.992);
  static const Colour kBottom = from_srgb(0.845, 0.855, 0.870);
  return mix(kBottom, kTop, std::clamp(height, 0.0, 1.0));
}

Vec3d key_light_direction() { return normalized({-0.55, 0.70, 0.65}); }

Colour shade(const Colour& albedo, const Vec3d& normal, const Light& light, const Lighting& lighting) {
  static const Vec3d kKey = key_light_direction();
  static const Vec3d kFill = normalized({0.85, 0.10, 0.45});
  static const Vec3d kKeyHalf = normalized(kKey + Vec3d{0, 0, 1});
  constexpr Colour kKeyLight{1.00, 0.96, 0.90}, kFillLight{0.14, 0.17, 0.22};
  constexpr Colour kSky{0.27, 0.30, 0.35}, kGround{0.11, 0.10, 0.09};

  const double skyward = 0.5 + 0.5 * dot(normal, lighting.up);
  const double key = wrapped(dot(normal, kKey), 0.15);
  if (lighting.even) {
    const double facing = std::max(0.0, normal[2]);
    return (0.42 + 0.16 * skyward + 0.34 * key + 0.16 * facing) * light.open * albedo;
  }
  Colour sum = light.open * mix(kGround, kSky, skyward);
  // Shadows keep a part of the lamp, so that what lies in them is seen; hollows hide some of it, too.
  const double shadow = 0.35 + 0.65 * light.key;
  sum += key * shadow * (0.45 + 0.55 * light.open) * kKeyLight;
  sum += wrapped(dot(normal, kFill), 0.4) * light.open * kFillLight;
  const double sheen = 0.06 * power_24(std::max(0.0, dot(normal, kKeyHalf)));
  return multiply(albedo, sum) + sheen * light.open * light.key * kKeyLight;
}

}  // namespace pointskin::render_detail
