// Arrays of points as an object takes them that works in a workspace.
#pragma once

#include <pointskin/c.h>
#include <pointskin/arrays.hpp>

#include <utility>

#include "c/convert.hpp"

namespace pointskin::c {

/// Calls f(DevicePoints) with points where the workspace works: used where they lie if possible, else packed there or
/// copied there. On the host, points that are not finite are left out.
/// @throws Error usage for arrays on a device in a workspace on the CPU
template <class F>
decltype(auto) with_device_points(const Workspace& workspace, const psk_points* given, const F& f) {
  const psk_points points = known(&required(given, "points"));
  const StridedPoints arrays = strided(given);
  const bool works_on_gpu = workspace.device().kind == DeviceKind::cuda;
  const bool on_gpu = is_on_device(points);
  if (on_gpu && !works_on_gpu)
    throw Error(ErrorCode::usage, "the arrays are on a GPU, but the workspace is on the CPU");
  if (on_gpu || (!works_on_gpu && is_used_in_place(arrays) && are_finite(arrays)))
    return f(static_cast<const DevicePoints&>(device_points_of(workspace, arrays)));
  ReadOptions how;
  how.threads = workspace.device().threads;
  return f(static_cast<const DevicePoints&>(upload(workspace, cloud_of(arrays, how))));
}

}  // namespace pointskin::c
