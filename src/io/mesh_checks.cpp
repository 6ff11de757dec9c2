#include "io/mesh_checks.hpp"

#include <pointskin/error.hpp>

#include <cmath>

#include "core/format.hpp"

namespace pointskin::io {

void check_finite(const char* what, std::size_t first, std::span<const Vec3f> vectors) {
  for (std::size_t i = 0; i < vectors.size(); ++i) {
    const Vec3f& v = vectors[i];
    if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
      throw Error(ErrorCode::invalid_input, fmt::format("{} {} is not finite", what, first + i));
  }
}

void check_corners(std::int64_t vertices, std::span<const Triangle> triangles) {
  for (const Triangle& triangle : triangles)
    for (const std::int32_t corner : triangle)
      if (corner < 0 || corner >= vertices)
        throw Error(ErrorCode::invalid_input, fmt::format("a triangle names vertex {} of {}", corner, vertices));
}

}  // namespace pointskin::io
