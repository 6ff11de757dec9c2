// The space that this file is compiled for, with its primitives. What includes it is a step: the build compiles it once
// for every space (docs/architecture.md), and it ends in a PSK_INSTANTIATE for every function of its header.
#pragma once

#if defined(PSK_THIS_SPACE)  // a space from elsewhere: the header that defines ThisSpace
#include PSK_THIS_SPACE
#elif defined(__CUDACC__)
#include "exec/cuda_primitives.cuh"
namespace pointskin::exec {
using ThisSpace = Cuda;
}
#else
#include "exec/cpu_primitives.hpp"
namespace pointskin::exec {
using ThisSpace = Cpu;
}
#endif

#include "exec/algorithms.hpp"

/// Instantiates a function template for the space that this file is compiled for, its first parameter; what follows the
/// name are the others.
#define PSK_INSTANTIATE(function, ...)                                                 \
  template decltype(function<::pointskin::exec::ThisSpace __VA_OPT__(, ) __VA_ARGS__>) \
      function<::pointskin::exec::ThisSpace __VA_OPT__(, ) __VA_ARGS__>
