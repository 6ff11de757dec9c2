// A value at a place in the order of many that lie on a disk.
#pragma once

#include <cstdint>

#include "scale/sample_values.hpp"

namespace pointskin::scale {

/// The value of a column at place k, from 0 on, if all were in ascending order. None is negative or NaN.
/// @throws Error as Spool
/// Reads the column twice, `part` values at once: the bits of such floats ascend with them, so that the upper half of the bits is
/// counted first, and then the lower half among those of the place.
float kth_value(const SampleValues& values, SampleValues::Column column, std::int64_t k, std::int64_t part);

}  // namespace pointskin::scale
