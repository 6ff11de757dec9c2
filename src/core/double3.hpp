// The name that the fluid's kernels have for Vec3d.
#pragma once

#include "core/matrix3.hpp"

namespace pointskin {

using Double3 = Vec3d;

}  // namespace pointskin
