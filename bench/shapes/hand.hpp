#pragma once

#include <memory>

#include "shapes.hpp"

namespace pointskin::bench {

/// The shape "hand" (make_shape).
std::unique_ptr<Shape> make_hand();

}  // namespace pointskin::bench
