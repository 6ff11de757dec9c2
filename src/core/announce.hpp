// Where a run is, told to its caller.
#pragma once

#include <functional>
#include <string>

#include <pointskin/error.hpp>
#include <pointskin/progress.hpp>

namespace pointskin {

/// @param progress  of the caller, or empty
/// @throws Error interrupted if the caller wants to stop
inline void announce(const std::function<bool(const Progress&)>& progress, const char* phase, double fraction) {
  if (progress && !progress({phase, fraction}))
    throw Error(ErrorCode::interrupted, std::string("cancelled before the phase \"") + phase + "\"");
}

}  // namespace pointskin
