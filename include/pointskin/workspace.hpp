// Where runs work: a device with a stream and a pool of memory, shared by what is given the same one.
#pragma once

#include <cstdint>
#include <memory>

#include <pointskin/device.hpp>
#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

namespace detail {
struct WorkspaceData;
}

/// A stream of a device's work and a pool that keeps freed memory for the next run. A cheap handle: copies stand for
/// the same workspace, which lives as long as any object or array in it. Objects that share one take turns on its
/// stream and reuse each other's memory; a workspace and all in it belong to one thread at a time.
class Workspace {
 public:
  /// A workspace of its own on `device`. Implicit, so that a Device will do where nothing is to be shared.
  /// @throws Error device_unavailable if the device does not answer, usage for a negative number of threads
  Workspace(const Device& device = Device::automatic());  // NOLINT(google-explicit-constructor)

  /// Work goes to a stream of the caller's.
  /// @param cuda_stream  a cudaStream_t of the GPU `device`, also the default stream (null). It must live as long as
  /// this
  ///                     workspace and all in it. Work is enqueued there in the order of the calls; where a call
  ///                     returns results to the host it waits for them.
  /// @throws Error usage unless `device` is a GPU, device_unavailable if it does not answer
  Workspace(const Device& device, void* cuda_stream);

  [[nodiscard]] const Device& device() const;

  /// The cudaStream_t that work is enqueued on; of several GPUs the first one's, where all has its end; null on the CPU, where work is done when its call returns.
  [[nodiscard]] void* stream() const;

  /// Waits until the stream's work is done. @throws Error device_unavailable if some of it failed
  void synchronize() const;

  /// Gives memory that is kept for the next run back to the system.
  void release_memory() const;

  /// What all arrays in the workspace may hold together from now on, in bytes; 0: no limit. What would pass it ends with
  /// Error over_limit. Options::max_memory_bytes of a run counts besides.
  /// What is held already stays. @throws Error usage if `bytes` is negative
  void limit_memory(std::int64_t bytes) const;

  /// What all arrays in the workspace hold together now, in bytes.
  [[nodiscard]] std::int64_t held_bytes() const;

  /// For the library.
  [[nodiscard]] const detail::WorkspaceData& data() const { return *data_; }

 private:
  std::shared_ptr<const detail::WorkspaceData> data_;
};

}  // namespace pointskin
