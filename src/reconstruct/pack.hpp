// Arrays of other programs, where the space works, in the layout of the library.
#pragma once

#include <cstdint>

#include <pointskin/arrays.hpp>

#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "exec/typed_buffer.hpp"

namespace pointskin::detail {

/// Rounds rows of three numbers to floats. @param array  shape (n, 3), in the space's memory. O(n).
template <exec::Space Exec>
exec::Buffer<Vec3f> pack_triples(Exec& ex, const StridedArray& array);

/// Copies one column into a row. @param array  shape (n, 1), in the space's memory. O(n).
template <exec::Space Exec>
exec::Buffer<std::uint8_t> pack_column(Exec& ex, const StridedArray& array);

}  // namespace pointskin::detail
