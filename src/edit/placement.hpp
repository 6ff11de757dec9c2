// Moving a part of another cloud to its place, and onto the points that are there.
// Source: Chen & Medioni, "Object modelling by registration of multiple range images", 1992 (point-to-plane); Besl &
// McKay, "A method for registration of 3-D shapes", 1992. Differs: matches beyond three times the root mean square are
// left out, and normals must agree.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

#include <array>
#include <optional>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "exec/space.hpp"
#include "octree/frame.hpp"
#include "octree/search.hpp"

namespace pointskin::edit {

/// p -> M p + shift, and for normals n -> turn n.
struct Placement {
  double matrix[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};  ///< row by row: a rotation times a scale
  double turn[9] = {1, 0, 0, 0, 1, 0, 0, 0, 1};    ///< the rotation
  double shift[3] = {0, 0, 0};

  PSK_HD static double row(const double* m, int r, const Vec3f& v) {
    return m[3 * r] * v.x + m[3 * r + 1] * v.y + m[3 * r + 2] * v.z;
  }
  [[nodiscard]] PSK_HD Vec3f place(const Vec3f& p) const {
    return {static_cast<float>(row(matrix, 0, p) + shift[0]), static_cast<float>(row(matrix, 1, p) + shift[1]),
            static_cast<float>(row(matrix, 2, p) + shift[2])};
  }
  [[nodiscard]] PSK_HD Vec3f turned(const Vec3f& n) const {
    return {static_cast<float>(row(turn, 0, n)), static_cast<float>(row(turn, 1, n)),
            static_cast<float>(row(turn, 2, n))};
  }
};

/// Moves points and normals in place.
template <exec::Space Exec>
void place(Exec& ex, const Placement& placement, ArrayView<Vec3f> positions, ArrayView<Vec3f> normals);

/// What the points are to be moved onto: samples with normals in the unit cube, in the order of the tree's keys; ids of
/// `points` are places in that order.
struct SnapTarget {
  octree::SearchView points;
  ArrayView<const Vec3f> normals;
  octree::Frame cube;
};

/// The rigid motion that brings `positions` onto the target, by point-to-plane ICP from where they are. Matches are
/// nearest samples no farther than a tenth of the box of `positions` at first, with normals less than 60 degrees apart.
/// Nothing if fewer than one point in 20, or than 20 points, have a match.
/// @param positions  shape (n), relative to the cloud's origin, world units
/// At most 40 rounds of O(n log samples), a round trip each. Deterministic, the same bits on every device.
template <exec::Space Exec>
std::optional<Placement> find_snap(Exec& ex, const SnapTarget& target, ArrayView<const Vec3f> positions,
                                   ArrayView<const Vec3f> normals);

namespace snap {

/// Sums over matches: the normal equations of the motion (turn about `centre`, then shift) that brings points onto the
/// planes of their matches.
struct Equations {
  double matrix[21] = {};  ///< upper triangle of the 6 x 6 matrix, row by row
  double right[6] = {};
  double squared = 0;  ///< of the distances between points and matches
  double count = 0;
};

/// The motion that solves the equations, as a step of `motion`; false if they have no solution.
/// @param change  receives how far points `radius` away from the centre move at most
bool step(const Equations& equations, const Vec3d& centre, double radius, Placement& motion, double& change);

}  // namespace snap
}  // namespace pointskin::edit
