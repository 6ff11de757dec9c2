// Regions of a view's plane: inside of an odd number of closed polygons.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "edit/view_frame.hpp"

namespace pointskin::edit {

/// An edge of a polygon.
struct PlaneEdge {
  PlanePoint from, to;
};

/// Edges of all polygons, in any order.
struct Polygons {
  ArrayView<const PlaneEdge> edges;

  /// Counts the edges that a ray to the right crosses. An edge has its lower end and lacks its upper one, so a ray
  /// through a corner crosses the outline once or not at all. O(edges).
  [[nodiscard]] PSK_HD bool contains(const PlanePoint& p) const {
    bool inside = false;
    for (std::int64_t i = 0; i < edges.size; ++i) {
      const PlaneEdge& e = edges[i];
      if ((e.from.y <= p.y) == (e.to.y <= p.y)) continue;
      const double x = e.from.x + (p.y - e.from.y) / (e.to.y - e.from.y) * (e.to.x - e.from.x);
      if (p.x < x) inside = !inside;
    }
    return inside;
  }
};

}  // namespace pointskin::edit
