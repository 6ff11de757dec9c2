#include "edit/guide.hpp"

#include <algorithm>
#include <limits>

namespace pointskin::edit {

DepthRange depth_range(const ViewFrame& view, const Bounds& box, double nearest) {
  DepthRange range{std::numeric_limits<double>::infinity(), -std::numeric_limits<double>::infinity()};
  for (int corner = 0; corner < 8; ++corner) {
    const double depth =
        view.depth_of({(corner & 4) != 0 ? box.upper.x : box.lower.x, (corner & 2) != 0 ? box.upper.y : box.lower.y,
                       (corner & 1) != 0 ? box.upper.z : box.lower.z});
    range.first = std::min(range.first, depth);
    range.last = std::max(range.last, depth);
  }
  if (view.perspective) range.first = std::max(range.first, nearest);
  return range;
}

}  // namespace pointskin::edit
