// Memory of one GPU: a pool that keeps what is freed. This header needs no CUDA.
#pragma once

#include <memory>
#include <span>

#include "exec/memory.hpp"

namespace pointskin::exec {

/// A pool of GPU `index` in the order of `stream`, a cudaStream_t, which it destroys at its end if it owns it.
/// @param readers  other GPUs that read and write what comes from it
/// @throws Error device_unavailable if the driver makes none
std::shared_ptr<MemoryPool> make_cuda_pool(int index, void* stream, bool owns_stream,
                                           std::span<const int> readers = {});

}  // namespace pointskin::exec
