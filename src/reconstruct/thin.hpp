// A few of the points of a cloud.
#pragma once

#include <cstdint>

#include <pointskin/cloud.hpp>
#include <pointskin/reconstruct.hpp>

#include "exec/space.hpp"
#include "reconstruct/input.hpp"

namespace pointskin::detail {

/// Up to `count` of the points that a run with these options uses, evenly spread over their Morton order, with their
/// normals, relative to the cloud's origin. Does not depend on the order of the points.
/// @throws Error as upload and frame_around
template <exec::Space Exec>
Cloud thin_cloud(Exec& ex, const Input& input, const Options& options, std::int64_t count);

}  // namespace pointskin::detail
