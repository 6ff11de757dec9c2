// What a caller has to give.
#pragma once

#include <pointskin/error.hpp>

namespace pointskin::edit {

/// @throws Error usage, with `story`, unless it holds
inline void require(bool holds, const char* story) {
  if (!holds) throw Error(ErrorCode::usage, story);
}

}  // namespace pointskin::edit
