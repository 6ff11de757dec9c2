// The CPU space: worker threads and a memory pool. oneTBB, or std::thread where a sanitizer needs it.
#pragma once

#include <chrono>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <functional>
#include <memory>

#include "exec/memory.hpp"

namespace pointskin::exec {

/// Runs work on CPU threads. Every primitive cuts its range into blocks whose borders depend on the range alone, so
/// results are the same for any number of threads.
class Cpu {
 public:
  /// @param threads  > 0, or 0 for all that the process may use; fewer where the system does not let so many be made,
  ///                 and 256 at most unless the machine has more cores
  /// @throws Error usage if `threads` is negative
  explicit Cpu(int threads = 0);
  ~Cpu();
  Cpu(const Cpu&) = delete;
  Cpu& operator=(const Cpu&) = delete;

  /// Few threads: neighbouring corners share what one thread has loaded.
  static constexpr bool kManyThreads = false;
  /// Its memory is the host's, and steps have no kernels of their own for it.
  static constexpr bool kOnHost = true;
  static constexpr bool kOwnKernels = false;

  [[nodiscard]] int threads() const noexcept { return threads_; }
  [[nodiscard]] int host_threads() const noexcept { return threads_; }
  [[nodiscard]] const std::shared_ptr<MemoryPool>& pool() const noexcept { return pool_; }

  /// Calls block(i) once for every i in [0, count), on any thread, in any order; returns when all are done.
  /// An exception of one call is rethrown here after the others have stopped. Must not be nested. Before every call the
  /// flag of the calling thread's CancelScope is asked.
  void run_blocks(std::int64_t count, const std::function<void(std::int64_t)>& block);

  /// There is none.
  [[nodiscard]] void* stream() const noexcept { return nullptr; }

  /// Does nothing: CPU work is done when its call returns.
  void synchronize() {}

  /// Copies bytes. For many threads at once.
  void read(const void* from, void* to, std::size_t bytes) const { std::memcpy(to, from, bytes); }

  /// Now, as a point in time of milliseconds_between().
  using Mark = std::chrono::steady_clock::time_point;
  [[nodiscard]] Mark mark() const { return std::chrono::steady_clock::now(); }
  [[nodiscard]] double milliseconds_between(const Mark& from, const Mark& to) const {
    return std::chrono::duration<double, std::milli>(to - from).count();
  }

  /// Does nothing: any thread may use the CPU.
  void activate() {}

 private:
  struct Workers;
  int threads_;
  std::unique_ptr<Workers> workers_;
  std::shared_ptr<MemoryPool> pool_;
};

}  // namespace pointskin::exec
