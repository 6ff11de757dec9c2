// Where the points of an edited cloud come from.
#pragma once

#include <cstdint>

namespace pointskin::edit {

inline constexpr std::uint8_t kOriginal = 0;  ///< of the base cloud; only these decide on the isovalue
inline constexpr std::uint8_t kGuide = 1;     ///< put there to guide the surface; says nothing about normals
inline constexpr std::uint8_t kInserted = 2;  ///< copied from another cloud

}  // namespace pointskin::edit
