// What orders points that share a key.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "core/mix_bits.hpp"
#include "core/typed_view.hpp"
#include "octree/frame.hpp"

namespace pointskin::detail {

/// Mixes the bits of a point; equal points have equal hashes.
struct HashPoint {
  ArrayView<const Vec3f> positions, normals;
  ArrayView<std::uint64_t> hashes;
  octree::Selection selection{};

  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t from = selection(i);
    const Vec3f p = positions[from];
    const Vec3f n = normals.empty() ? Vec3f{} : normals[from];
    hashes[i] = mix_vector(mix_vector(kHashSeed, p), n);
  }
};

/// Mixes an attribute into the lower half of a point's hash. Points that differ otherwise keep the order that they have
/// without attributes, so that the surface does not depend on these.
struct HashAttribute {
  TypedView values;
  ArrayView<std::uint64_t> hashes;
  octree::Selection selection{};
  PSK_HD void operator()(std::int64_t i) const {
    constexpr std::uint64_t kLower = 0xffffffff;
    hashes[i] = (hashes[i] & ~kLower) | (values.mixed_into(hashes[i], selection(i)) & kLower);
  }
};

PSK_HD inline bool is_finite(const Vec3f& v) {
  const float sum = 0 * v.x + 0 * v.y + 0 * v.z;  // anything not finite becomes NaN
  return sum == 0;
}

}  // namespace pointskin::detail
