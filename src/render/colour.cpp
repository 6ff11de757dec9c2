#include "render/colour.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::render_detail {

double decode_srgb(double encoded) {
  return encoded <= 0.04045 ? encoded / 12.92 : std::pow((encoded + 0.055) / 1.055, 2.4);
}

double encode_srgb(double linear) {
  return linear <= 0.0031308 ? 12.92 * linear : 1.055 * std::pow(linear, 1 / 2.4) - 0.055;
}

SrgbEncoder::SrgbEncoder() {
  for (std::size_t i = 0; i <= kTableSize; ++i) {
    const double linear = static_cast<double>(i) / static_cast<double>(kTableSize);
    table_[i] = static_cast<std::uint8_t>(std::lround(255 * encode_srgb(linear)));
  }
}

std::uint8_t SrgbEncoder::operator()(double linear) const {
  // A comparison that fails for NaN comes first.
  const double clamped = linear > 0 ? std::min(linear, 1.0) : 0;
  return table_[static_cast<std::size_t>(clamped * static_cast<double>(kTableSize) + 0.5)];
}

}  // namespace pointskin::render_detail
