// A limit of 32-bit ids.
#pragma once

#include <cstdint>
#include <limits>
#include <pointskin/error.hpp>
#include <string>

namespace pointskin::surface {

inline void check_size(const char* what, std::int64_t count) {
  if (count > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "the surface needs " + std::to_string(count) + " " + what +
                                           ", more than 32-bit ids reach; choose a smaller depth");
}

}  // namespace pointskin::surface
