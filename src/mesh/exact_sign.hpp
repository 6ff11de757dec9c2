// Exact signs of the determinants that say on which side a point is of a plane, and of a line in a plane.
// Source: Shewchuk, "Adaptive precision floating-point arithmetic and fast robust geometric predicates", Discrete &
// Computational Geometry 18, 1997: bounds on the error of the determinants, and exact sums of doubles.
// Differs: where the bound does not decide, the coordinates are mostly whole multiples of one power of two, few enough
// for integers of 128 bits. Where they are not, products of two floats are doubles without error, those of three are
// sums of two doubles without error, and the determinant is expanded into them and summed exactly. The paper's stages
// between the bound and the exact sum are left out.
//
// Nothing overflows or underflows: products of three floats are multiples of 2^-447 and below 2^384.
#pragma once

#include <pointskin/vector.hpp>

namespace pointskin::mesh_detail {

/// Sign of det(b - a, c - a, d - a): 1 if d lies on the side of the plane through a, b and c that (b - a) x (c - a)
/// points to, -1 on the other side, 0 on the plane, or where a, b and c lie on a line.
/// Right for all finite floats. O(1), the longer the nearer d is to the plane: 10 ns to 2 us.
int side_of_plane(const Vec3f& a, const Vec3f& b, const Vec3f& c, const Vec3f& d);

/// Sign of the turn from b - a to c - a where coordinate `axis` (0 to 2) is left out: 1 if it is counter-clockwise in
/// the plane of the two coordinates that follow `axis`, -1 if it is clockwise, 0 if a, b and c lie on a line there.
/// Right for all finite floats.
int turn(const Vec3f& a, const Vec3f& b, const Vec3f& c, int axis);

}  // namespace pointskin::mesh_detail
