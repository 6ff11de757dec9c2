#include "octree/frame.hpp"

#include <pointskin/error.hpp>

#include <algorithm>

#include "exec/this_space.hpp"
#include "octree/bounding_box.hpp"

namespace pointskin::octree {
namespace {}  // namespace

template <exec::Space Exec>
Bounds box_around(Exec& ex, ArrayView<const Vec3f> positions) {
  return exec::reduce<Bounds>(ex, "octree.bounds", positions.size, BoxOf{positions}, JoinBoxes{});
}

template <exec::Space Exec>
Frame fit_frame(Exec& ex, ArrayView<const Vec3f> positions, double scale) {
  if (positions.empty()) throw Error(ErrorCode::empty_result, "the cloud has no points; nothing to reconstruct");
  return frame_around(box_around(ex, positions), scale);
}

PSK_INSTANTIATE(box_around);
PSK_INSTANTIATE(fit_frame);

}  // namespace pointskin::octree
