// From a user's deformation to what kernels read: validated, split into rotation and stretch, relative to the cloud.
#pragma once

#include <pointskin/deform.hpp>

#include <cstdint>
#include <vector>

#include "deform/deform_map.hpp"

namespace pointskin::deform {

/// A linear map as rotation and stretch: M = R(rotation) (I + stretch).
struct PolarParts {
  Vec3d rotation;      ///< axis times angle, at most pi
  Symmetric3 stretch;  ///< S - I
};

/// Polar decomposition of a 3x3 matrix, row by row, whose determinant is positive.
/// Source: Higham, "Computing the polar decomposition, with applications", SIAM J. Sci. Stat. Comput. 7, 1986 (Newton's
/// iteration). Exact for the identity.
PolarParts polar_parts(const std::array<double, 9>& matrix);

/// A deformation on the host. HandleData::nearest_row counts in `point_sets`.
struct PreparedDeformation {
  std::vector<HandleData> handles;
  std::vector<LatticeData> lattices;
  std::vector<Vec3d> moves;
  std::vector<std::vector<std::int64_t>> point_sets;
  bool identity = true;  ///< nothing moves anything
};

/// @param deformation  valid
/// @param origin       of the cloud
PreparedDeformation prepare(const Deformation& deformation, const Vec3d& origin);

}  // namespace pointskin::deform
