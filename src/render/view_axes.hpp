// The viewer's axes for azimuth, elevation and up axis.
#pragma once

#include <pointskin/render.hpp>

namespace pointskin::render_detail {

/// Unit vectors in the coordinates of what is seen; `back` points to the viewer.
struct ViewAxes {
  Vec3d right{1, 0, 0}, up{0, 1, 0}, back{0, 0, 1};
};

/// @param azimuth, elevation  radians, as in RenderOptions
ViewAxes view_axes(UpAxis up, double azimuth, double elevation);

/// The axis that points up.
Vec3d up_direction(UpAxis up);

/// Azimuth and elevation, radians, from which the viewer stands in the direction `back`, of unit length.
struct ViewAngles {
  double azimuth = 0, elevation = 0;
};
ViewAngles view_angles(UpAxis up, const Vec3d& back);

}  // namespace pointskin::render_detail
