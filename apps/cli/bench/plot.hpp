// The picture of `pointskin bench --plot`.
#pragma once

#include <string>

#include "bench/results.hpp"

namespace pointskin::cli {

/// Median time against points, and against depth, as SVG: a line per device and depth, or device and cloud; whole
/// programs dashed.
std::string plot(const Results& results);

}  // namespace pointskin::cli
