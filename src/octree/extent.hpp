// The extent of points, as a reduction over the lanes of exec/reduce_order.hpp.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/reduce_order.hpp"
#include "octree/bounding_box.hpp"
#include "octree/strays.hpp"

namespace pointskin::octree {

/// The extent of a lane with this box.
PSK_HD inline Extent extent_of_lane(const Bounds& box) { return {box, box}; }

struct JoinExtents {
  static constexpr bool kAnyOrder = true;
  PSK_HD Extent operator()(const Extent& a, const Extent& b) const {
    return {JoinBoxes{}(a.all, b.all),
            {JoinBoxes::upper_of(a.inner.lower, b.inner.lower), JoinBoxes::lower_of(a.inner.upper, b.inner.upper)}};
  }
};

}  // namespace pointskin::octree
