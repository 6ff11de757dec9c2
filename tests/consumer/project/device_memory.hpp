// Memory of a device as a program of its own has it: of a GPU, on a stream of its own, where the library was built with
// CUDA, the CUDA runtime is found and a GPU answers; else the host's, which is the CPU's device memory.
#pragma once

#include <pointskin/pointskin.hpp>

#include <cstddef>
#include <cstdint>
#include <memory>
#include <stdexcept>
#include <vector>

#ifdef HAS_CUDA_RUNTIME
#include <cuda_runtime_api.h>
#endif

class Memory {
 public:
  Memory() {
#ifdef HAS_CUDA_RUNTIME
    on_gpu_ = pointskin::Device::automatic().kind == pointskin::DeviceKind::cuda;
    if (on_gpu_) check(cudaStreamCreate(&stream_));
#endif
  }

  [[nodiscard]] pointskin::Workspace workspace() const {
#ifdef HAS_CUDA_RUNTIME
    if (on_gpu_) return {pointskin::Device::cuda(), stream_};
#endif
    return pointskin::Device::cpu();
  }

  /// Copies of these, until the program ends.
  template <class T>
  pointskin::DeviceSpan<const T> put(const std::vector<T>& values) {
#ifdef HAS_CUDA_RUNTIME
    if (on_gpu_) {
      void* data = nullptr;
      check(cudaMallocAsync(&data, values.size() * sizeof(T), stream_));
      check(cudaMemcpyAsync(data, values.data(), values.size() * sizeof(T), cudaMemcpyHostToDevice, stream_));
      return {static_cast<const T*>(data), static_cast<std::int64_t>(values.size())};
    }
#endif
    const auto kept = std::make_shared<const std::vector<T>>(values);
    kept_.push_back(kept);
    return {kept->data(), static_cast<std::int64_t>(kept->size())};
  }

  template <class T>
  std::vector<T> get(const pointskin::DeviceSpan<T>& from) const {
    std::vector<T> values(static_cast<std::size_t>(from.size));
#ifdef HAS_CUDA_RUNTIME
    if (on_gpu_) {
      check(cudaMemcpyAsync(values.data(), from.data, values.size() * sizeof(T), cudaMemcpyDeviceToHost, stream_));
      check(cudaStreamSynchronize(stream_));
      return values;
    }
#endif
    values.assign(from.data, from.data + from.size);
    return values;
  }

 private:
#ifdef HAS_CUDA_RUNTIME
  static void check(cudaError_t status) {
    if (status != cudaSuccess) throw std::runtime_error(cudaGetErrorString(status));
  }
  cudaStream_t stream_ = nullptr;
  bool on_gpu_ = false;
#endif
  std::vector<std::shared_ptr<const void>> kept_;
};
