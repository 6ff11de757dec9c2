// Where a run is.
#pragma once

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

/// Handed to the `progress` of options.
struct Progress {
  const char* phase = "";  ///< "octree", "splat", "solve", "extract"; of normals "estimate", "propagate", "iterate";
                           ///< of many clouds "many"
  double fraction = 0;     ///< of the whole run, in [0, 1], never decreasing
};

}  // namespace pointskin
