// The CUDA space: one stream of one GPU and a stream-ordered memory pool, or several GPUs that work as one (exec/gpus). This header
// needs no CUDA.
#pragma once

#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <string>

#include "exec/gpus/group.hpp"
#include "exec/memory.hpp"

namespace pointskin::exec {

/// Runs work on one stream of one GPU. Everything is enqueued in order on that stream; nothing synchronises the whole
/// device. Memory comes from a pool of this object that keeps what is freed. Several GPUs are a group: its lead does what is
/// small, and large launches are shared (in_shares() in exec/cuda_primitives.cuh). The same bytes for any number of them.
class Cuda {
 public:
  /// @throws Error device_unavailable if there is no GPU of this index or it does not answer
  explicit Cuda(int index);
  /// @param gpus  one or more, each once; the first leads
  /// @throws Error device_unavailable if one of them does not answer, or two do not reach each other's memory
  explicit Cuda(std::span<const int> gpus);
  /// The same on a stream of somebody else's, who keeps it: a cudaStream_t of this GPU.
  Cuda(int index, void* stream);
  ~Cuda();
  Cuda(const Cuda&) = delete;
  Cuda& operator=(const Cuda&) = delete;

  /// Thousands of threads hide each other's waiting: one corner each.
  static constexpr bool kManyThreads = true;
  /// Its memory is not the host's, and some steps have kernels of their own for it, in <step>_kernel.cuh.
  static constexpr bool kOnHost = false;
  static constexpr bool kOwnKernels = true;

  [[nodiscard]] int index() const noexcept { return index_; }
  /// The stream as a cudaStream_t; of a group the lead's.
  [[nodiscard]] void* stream() const noexcept { return stream_; }
  /// Null for one GPU.
  [[nodiscard]] gpus::Group* group() const noexcept { return group_.get(); }
  /// Makes what is enqueued on stream() from now on wait for all before, on all GPUs.
  void join() const {
    if (group_ != nullptr) group_->to_lead();
  }
  [[nodiscard]] const std::shared_ptr<MemoryPool>& pool() const noexcept { return pool_; }

  /// Waits until the stream's work is done. @throws Error device_unavailable if some of it failed
  void synchronize();

  /// Copies bytes of its memory to the host's. For many threads at once: what makes them is to be done (synchronize()).
  void read(const void* from, void* to, std::size_t bytes) const;

  /// Copies many bytes to the host's memory or from there, through page-locked memory, by several threads of the host:
  /// one alone copies, and maps new pages, slower than the bus. Waits.
  void fetch(const void* from, void* to, std::size_t bytes);
  void send(const void* from, void* to, std::size_t bytes);
  /// From here on that is faster than a copy by the driver.
  static constexpr std::size_t kManyBytes = std::size_t{8} << 20;

  /// A point in the stream's work; the last kMarks of them can be asked for. Does not wait.
  using Mark = int;
  static constexpr int kMarks = 16;
  [[nodiscard]] Mark mark();

  /// Time that the stream took from one mark to another. Waits until the second is reached.
  [[nodiscard]] double milliseconds_between(Mark from, Mark to) const;

  /// Makes this GPU the calling thread's current one. To be called before work from a thread that may have used
  /// another.
  void activate();

  [[nodiscard]] int multiprocessors() const noexcept { return multiprocessors_; }
  [[nodiscard]] int host_threads() const noexcept { return 0; }

  /// Page-locked host memory for small read-backs, `kStagingBytes` long; and as much for one that others may overtake.
  [[nodiscard]] void* staging() const noexcept { return staging_; }
  [[nodiscard]] void* late_staging() const noexcept { return static_cast<char*>(staging_) + kStagingBytes; }
  static constexpr std::int64_t kStagingBytes = 4096;

  /// What a kernel that fills one of them writes to `arrived()` when all is there, and the wait for it: it sees the ticket sooner than
  /// the driver would say that the stream's work is done.
  [[nodiscard]] std::uint32_t next_ticket() noexcept { return ++ticket_; }
  [[nodiscard]] volatile std::uint32_t* arrived() const noexcept { return arrived_; }
  /// Returns when it or a later one has arrived. @throws Error device_unavailable if some of the work before failed
  void wait_for(std::uint32_t ticket);

 private:
  struct Opened {
    int index;
    void* stream = nullptr;
    std::unique_ptr<gpus::Group> group;
    std::shared_ptr<MemoryPool> pool;
  };
  static Opened open(std::span<const int> gpus);
  static Opened open(int index, void* stream);
  explicit Cuda(Opened opened);

  /// Calls copy(offset, bytes) for all parts, on several threads; those of a group share its links to the host.
  template <class Copy>
  void copy_in_parts(std::size_t bytes, const Copy& copy);
  /// read() by the thread's current GPU.
  void copy_to_host(const void* from, void* to, std::size_t bytes) const;

  int index_;
  int multiprocessors_ = 0;
  void* stream_ = nullptr;
  void* staging_ = nullptr;
  volatile std::uint32_t* arrived_ = nullptr;  // behind the staging memory
  std::uint32_t ticket_ = 0;
  void* marks_[kMarks] = {};  // cudaEvent_t
  class Lanes;
  std::unique_ptr<Lanes> lanes_;
  int next_mark_ = 0;
  std::unique_ptr<gpus::Group> group_;
  std::shared_ptr<MemoryPool> pool_;
};

/// Number of GPUs that answer; 0 without a driver.
int cuda_device_count() noexcept;

/// Marketing name of a GPU, such as "NVIDIA H100 80GB HBM3".
std::string cuda_device_name(int index);

/// Free memory of a GPU in bytes.
std::int64_t cuda_free_bytes(int index);

}  // namespace pointskin::exec
