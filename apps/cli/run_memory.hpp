// The memory of a reconstruction: what it will take, and what --max-memory leaves it.
#pragma once

#include <cstdint>
#include <string>

#include <pointskin/cloud.hpp>
#include <pointskin/device.hpp>
#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin::cli {

/// Resident size of this process now, in bytes.
std::int64_t process_bytes();

/// Largest resident size of this process so far, in bytes.
std::int64_t host_peak_bytes();

/// What a run takes where the limit counts: of the process on the CPU, of the device on a GPU. In bytes.
struct MemoryEstimate {
  std::int64_t buffers = 0;  ///< of the work: memory.device_peak_bytes of the report
  std::int64_t beside = 0;   ///< the program, the cloud and the envelope, which share the CPU's memory with the work
  std::int64_t so_far = 0;   ///< the most that reading, and finding a depth, took

  [[nodiscard]] std::int64_t total() const;
};

/// The memory of one run. To be made when the input has been read and nothing else has begun.
class RunMemory {
 public:
  /// No limit, and no wish to know.
  RunMemory() = default;
  /// @param limit  of --max-memory; 0: none
  RunMemory(const Device& device, const Options& options, std::int64_t limit);

  /// Refuses what cannot fit, before more memory is taken to know that better.
  /// @throws Error over_limit
  void check(const Cloud& cloud) const;

  /// O(n log n). Takes less memory than the run.
  /// @throws Error as estimate_device_bytes
  [[nodiscard]] MemoryEstimate estimate(const Cloud& cloud, const Options& options) const;

  /// @throws Error over_limit if the estimate is above the limit
  void check(const MemoryEstimate& estimate) const;

  /// Options::max_memory_bytes for the run.
  [[nodiscard]] std::int64_t limit_of_run() const;

  /// Limits a workspace for good: to limit_of_run(), or, without --max-memory, to 4/5 of what its device has left.
  void limit(const Workspace& workspace) const;

  /// Calls work(), whose options have that limit. Errors about it name --max-memory.
  template <class Work>
  auto within_limit(const Work& work) const {
    try {
      return work();
    } catch (const Error& error) {
      if (limit_ > 0 && error.code() == ErrorCode::over_limit) throw_named(error);
      throw;
    }
  }

 private:
  [[noreturn]] void throw_named(const Error& error) const;
  /// The most that was taken of what the limit counts.
  [[nodiscard]] std::int64_t so_far() const;
  /// What the limit is compared with: a fiftieth more, or 1 MiB, by which the size of a process
  /// differs from run to run.
  [[nodiscard]] std::int64_t most() const;

  Device device_;
  std::int64_t limit_ = 0;
  std::int64_t beside_ = 0;
};

/// What --max-memory leaves to work that begins now, beside the program: at least a byte.
std::int64_t bytes_left_of(std::int64_t limit);

/// "62.5 MiB (65536000 bytes)".
std::string bytes_text(std::int64_t bytes);

}  // namespace pointskin::cli
