// The nearest of many things to a point.
#pragma once

#include <cstdint>
#include <limits>

#include "mesh/box_tree.hpp"

namespace pointskin::mesh_detail {

/// What a search found.
struct Nearest {
  double squared_distance = std::numeric_limits<double>::infinity();
  std::int32_t slot = -1;  ///< place in the tree that was searched
};

/// The thing of `tree` nearest to `p`; of several at the same distance the one with the smallest id.
/// @param squared_distance_of  of a slot, from `p`; not below that of the thing's box
/// @param hint                 slot that may be near, or -1; changes the time taken, not the answer
template <class Distance>
Nearest nearest_in(const BoxTree& tree, const Vec3d& p, const Distance& squared_distance_of, std::int32_t hint) {
  Nearest best;
  const auto visit = [&](std::int32_t slot) {
    const double d = squared_distance_of(slot);
    if (d < best.squared_distance || (d == best.squared_distance && tree.id(slot) < tree.id(best.slot)))
      best = {d, slot};
  };
  if (hint >= 0) visit(hint);
  tree.visit_near(p, best.squared_distance, visit);
  return best;
}

}  // namespace pointskin::mesh_detail
