// What is never written: vertices that are not finite, and triangles that name none.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>

#include <pointskin/mesh.hpp>
#include <pointskin/vector.hpp>

namespace pointskin::io {

/// @param vectors  those from `first` on
/// @throws Error invalid_input, naming the first that is not finite: "<what> <number> is not finite"
void check_finite(const char* what, std::size_t first, std::span<const Vec3f> vectors);

/// @throws Error invalid_input if a triangle names a vertex outside of [0, vertices)
void check_corners(std::int64_t vertices, std::span<const Triangle> triangles);

}  // namespace pointskin::io
