// Whether two triangles of a mesh meet elsewhere than in the corners and edges that they share.
#pragma once

#include <pointskin/vector.hpp>

#include <array>

namespace pointskin::mesh_detail {

/// A triangle of a mesh: where its corners are, and their ids, which say what two triangles share.
struct MeshTriangle {
  std::array<Vec3f, 3> corners;  ///< finite
  Triangle ids;
};

/// How two triangles meet, what they share apart. Both hold their borders.
enum class Contact {
  none,      ///< not at all
  touching,  ///< in points that do not lie inside of both
  crossing,  ///< their insides meet: one passes through the other, or they overlap in a plane
};

/// Compares the intersection of two triangles with the convex hull of the corners that they share by id: nothing, a
/// corner or an edge. Two triangles with the same three corners meet in their insides.
///
/// Exact for all finite floats, also for triangles in one plane and for those without area, which are segments or
/// points and have no inside: every decision is the sign of a determinant (mesh/exact_sign.hpp) or a comparison of
/// coordinates. Does not depend on the order of the triangles and of their corners.
/// O(1): about 0.1 us for neighbours on a smooth surface.
Contact contact_of(const MeshTriangle& s, const MeshTriangle& t);

/// A point that both triangles hold, up to rounding in double: the middle of the corners of one that lie in the other
/// and of the places where edges of one pass through the other. The triangles must meet.
Vec3d place_of_contact(const MeshTriangle& s, const MeshTriangle& t);

}  // namespace pointskin::mesh_detail
