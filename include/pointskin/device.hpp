// Where a reconstruction runs.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

enum class DeviceKind { cpu, cuda };

/// A processor to run on, or several GPUs of one host that work as one. A plain value that owns nothing.
struct Device {
  DeviceKind kind = DeviceKind::cpu;
  int index = 0;             ///< which GPU, counted as the CUDA runtime counts; 0 for the CPU
  int threads = 0;           ///< CPU threads; 0 means all that the process may use
  std::vector<int> further;  ///< GPUs that work along with `index`; empty: it works alone

  /// The CPU with `threads` threads (0: all).
  /// @throws Error usage if `threads` is negative
  static Device cpu(int threads = 0);

  /// GPU number `index`.
  /// @throws Error device_unavailable if the library was built without CUDA, or no such GPU answers
  static Device cuda(int index = 0);

  /// Several GPUs as one: large arrays lie on all of them in equal shares, and each does its share of the work on them. The result
  /// has the same bytes as that of one. Arrays on a GPU that a program passes must be of memory that all of them reach, as
  /// cudaMalloc's is; the stream and small work are the first one's. Worth it from some thirty million nodes of an octree on,
  /// and where one has not enough memory.
  /// @param gpus  one or more, each once; the first leads
  /// @throws Error usage if there is none, or one twice; device_unavailable as cuda(int). What works there throws
  ///         device_unavailable if two of them do not reach each other's memory
  static Device cuda(const std::vector<int>& gpus);

  /// The first GPU if the library was built with CUDA and one answers, else the CPU. Never throws.
  static Device automatic(int threads = 0);

  /// Parses "auto", "cpu", "cuda", "cuda:N", "cuda:N,M" (several as one) or "cuda:all".
  /// @throws Error usage for any other text, device_unavailable as cuda()
  static Device parse(const std::string& text, int threads = 0);

  /// All GPUs, the leading one first; none for the CPU.
  [[nodiscard]] std::vector<int> gpus() const;

  /// What parse() reads: "cpu", "cuda:0" or "cuda:0,2".
  [[nodiscard]] std::string text() const;

  /// A name for people, such as "NVIDIA H100 80GB HBM3", "4 x NVIDIA H200" or "CPU, 2 threads".
  [[nodiscard]] std::string name() const;

  /// Memory of the device in bytes: free memory of the GPU, or available memory of the machine. Of several GPUs as many times that
  /// of the one with the least.
  [[nodiscard]] std::int64_t available_bytes() const;
};

/// True if the library was built with CUDA. Says nothing about GPUs being present.
bool built_with_cuda() noexcept;

}  // namespace pointskin
