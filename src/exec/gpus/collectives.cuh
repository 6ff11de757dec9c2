// Sorts, scans and choices by all GPUs of a group, with the results of exec/cuda_collectives.cu.
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/cuda.hpp"
#include "exec/memory.hpp"

namespace pointskin::exec::gpus {

/// True if the group of `ex`, if it is one, shares such work.
inline bool shares_collective(const Cuda& ex, std::int64_t elements) {
  return ex.group() != nullptr && elements >= ex.group()->worth().elements;
}

/// Each GPU chooses in its share; what it found goes behind what those before it found. Waits for the counts.
Buffer<std::int32_t> select_flagged(Cuda& ex, const char* label, ArrayView<const std::uint8_t> flags);

/// Each GPU adds up its intervals; then it scans each, beginning with the sum of those before. Reads twice. For integers: sums of others
/// would depend on the number of GPUs. out.size is in.size or in.size + 1, as exec::exclusive_scan has it.
template <class T>
void exclusive_scan(Cuda& ex, const char* label, ArrayView<const T> in, ArrayView<T> out);

/// Each GPU sorts its share; then each merges its share of the result. Stable. `values` may be null: keys alone. Waits for the cuts.
void sort(Cuda& ex, const char* label, Buffer<std::uint64_t>& keys, Buffer<std::int32_t>* values, int first_bit,
          int end_bit);

}  // namespace pointskin::exec::gpus
