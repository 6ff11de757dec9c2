// Every CUDA call and launch is checked: a failure becomes an Error that says what failed and where.
#pragma once

#include <cuda_runtime_api.h>

#include <pointskin/error.hpp>

#include <string>

namespace pointskin::exec {

/// @throws Error over_limit for exhausted memory, device_unavailable for anything else
inline void cuda_check(cudaError_t status, const char* doing) {
  if (status == cudaSuccess) return;
  const ErrorCode code = status == cudaErrorMemoryAllocation ? ErrorCode::over_limit : ErrorCode::device_unavailable;
  throw Error(code, std::string("CUDA: ") + cudaGetErrorString(status) + "; while " + doing);
}

}  // namespace pointskin::exec
