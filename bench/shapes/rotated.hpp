// A shape that is turned against the axes, along which grids are better than elsewhere.
#pragma once

#include <pointskin/mesh.hpp>

#include <memory>

#include "shapes.hpp"

namespace pointskin::bench {

/// How many rotations there are; they are numbered from 1.
inline constexpr int kRotations = 2;

/// One of the fixed rotations, applied to a vector. None of them takes an axis near to an axis or a diagonal.
Vec3d rotated(const Vec3d& v, int rotation);

/// The inverse of rotated().
Vec3d unrotated(const Vec3d& v, int rotation);

/// Turns a mesh around the origin of the world, its normals, too. @throws Error usage for a rotation that there is not
void rotate(Mesh& mesh, int rotation);

/// `shape`, turned around the origin.
std::unique_ptr<Shape> make_rotated(std::unique_ptr<Shape> shape, int rotation);

}  // namespace pointskin::bench
