// What a run found wrong, or doubtful, with its input or its result.
#pragma once

#include <string>

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

/// What a Warning is about.
enum class WarningKind {
  strays,              ///< points far from all others were left out
  normals_disagree,    ///< normals of neighbouring points are opposed
  normals_inside_out,  ///< normals point into what the points enclose
  normals_doubtful,    ///< most normals that were estimated are a guess
  off_surface,         ///< most points lie away from the surface
  at_domain_faces,     ///< the surface runs into the faces of the working cube
  far_from_points,     ///< much of the surface is far from all points
  coarse_depth,        ///< the points hold clearly more detail than the depth shows
  coarse_coordinates,  ///< the coordinates have too few digits for how far apart the points lie
  attributes_missing,  ///< no point that is used has a value of an attribute, so the mesh is without it
};

/// "strays", "normals_disagree" and so on: the enumerator's own name.
const char* name_of(WarningKind kind);

/// One thing, in one sentence for people that says how much of it there is and what helps. Options are named as on the
/// command line.
struct Warning {
  WarningKind kind = WarningKind::strays;
  double share = 0;  ///< how much, in [0, 1]: of the points, of pairs of neighbours, of the surface's area; of the
                     ///< cells of the depth that the points hold, those that the depth cannot show; of the
                     ///< points' spacing, a step of their coordinates; 0 for strays and attributes
  std::string text;
};

}  // namespace pointskin
