// Where a reconstruction runs.
#pragma once

#include <cstdint>
#include <string>

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

enum class DeviceKind { cpu, cuda };

/// A processor to run on. A plain value: cheap to copy, owns nothing.
struct Device {
  DeviceKind kind = DeviceKind::cpu;
  int index = 0;    ///< which GPU, counted as the CUDA runtime counts; 0 for the CPU
  int threads = 0;  ///< CPU threads; 0 means all that the process may use

  /// The CPU with `threads` threads (0: all).
  /// @throws Error usage if `threads` is negative
  static Device cpu(int threads = 0);

  /// GPU number `index`.
  /// @throws Error device_unavailable if the library was built without CUDA, or no such GPU answers
  static Device cuda(int index = 0);

  /// The first GPU if the library was built with CUDA and one answers, else the CPU. Never throws.
  static Device automatic(int threads = 0);

  /// Parses "auto", "cpu", "cuda" or "cuda:N".
  /// @throws Error usage for any other text, device_unavailable as cuda()
  static Device parse(const std::string& text, int threads = 0);

  /// A name for people, such as "NVIDIA H100 80GB HBM3" or "CPU, 2 threads".
  [[nodiscard]] std::string name() const;

  /// Memory of the device in bytes: free memory of the GPU, or available memory of the machine.
  [[nodiscard]] std::int64_t available_bytes() const;
};

/// True if the library was built with CUDA. Says nothing about GPUs being present.
bool built_with_cuda() noexcept;

}  // namespace pointskin
