#include <pointskin/cloud.hpp>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <utility>
#include <vector>

#include "wire.hpp"

namespace pointskin::studio::wire {
namespace {

/// The low 21 bits of `x`, two zeros between each.
std::uint64_t spread(std::uint64_t x) {
  x &= 0x1fffff;
  x = (x | x << 32) & 0x1f00000000ffff;
  x = (x | x << 16) & 0x1f0000ff0000ff;
  x = (x | x << 8) & 0x100f00f00f00f00f;
  x = (x | x << 4) & 0x10c30c30c30c30c3;
  return (x | x << 2) & 0x1249249249249249;
}

std::vector<std::pair<std::uint64_t, std::int64_t>> keys_of(const std::vector<Vec3f>& positions) {
  const Bounds box = bounds_of(positions);
  const float side =
      std::max({box.upper.x - box.lower.x, box.upper.y - box.lower.y, box.upper.z - box.lower.z, 1e-30F});
  const auto step = [side](float x, float lower) {
    return static_cast<std::uint64_t>(std::clamp((x - lower) / side * 2097151.0F, 0.0F, 2097151.0F));
  };
  std::vector<std::pair<std::uint64_t, std::int64_t>> keys(positions.size());
  for (std::size_t i = 0; i < keys.size(); ++i) {
    const Vec3f& p = positions[i];
    const std::uint64_t key =
        spread(step(p.x, box.lower.x)) | spread(step(p.y, box.lower.y)) << 1 | spread(step(p.z, box.lower.z)) << 2;
    keys[i] = {key, static_cast<std::int64_t>(i)};
  }
  return keys;
}

}  // namespace

std::vector<std::int64_t> even_order(const std::vector<Vec3f>& positions) {
  if (positions.empty()) return {};
  auto keys = keys_of(positions);
  std::sort(keys.begin(), keys.end());
  const auto count = static_cast<std::uint64_t>(keys.size());
  const int bits = std::bit_width(count - 1);
  std::vector<std::int64_t> order;
  order.reserve(keys.size());
  for (std::uint64_t i = 0; i < std::uint64_t{1} << bits; ++i) {
    std::uint64_t reversed = 0;
    for (int b = 0; b < bits; ++b) reversed |= (i >> b & 1) << (bits - 1 - b);
    if (reversed < count) order.push_back(keys[reversed].second);
  }
  return order;
}

}  // namespace pointskin::studio::wire
