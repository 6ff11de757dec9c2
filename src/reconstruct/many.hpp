// Many clouds at once: each on one thread of the CPU, or on one stream of a GPU.
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include <pointskin/reconstruct.hpp>

#include "exec/cpu.hpp"

namespace pointskin::detail {

/// Reconstructors that work side by side, kept with their memory from one call to the next.
class Crew {
 public:
  explicit Crew(const Device& device);

  /// Reconstructor::reconstruct_many.
  /// @param whole  a reconstructor of the whole device, for clouds that are reconstructed alone
  std::vector<Reconstruction> reconstruct(std::span<const Cloud> clouds, const Options& options, Reconstructor& whole);

 private:
  /// One that no thread uses now.
  std::unique_ptr<Reconstructor> take();
  void put_back(std::unique_ptr<Reconstructor> reconstructor);
  /// Of those that no thread uses. @returns false if there were none
  bool release_memory();

  /// By the whole device.
  Reconstruction reconstruct_alone(const Cloud& cloud, const Options& options, Reconstructor& whole);
  /// By one that no other thread uses; one that runs out of memory is gone.
  Reconstruction reconstruct_beside(const Cloud& cloud, const Options& options);
  [[nodiscard]] bool ran_out_of_gpu_memory(const Reconstruction& result) const;

  std::vector<Device> devices_;  // of the reconstructors: of several GPUs each has its own clouds
  exec::Cpu cpu_;                // as many threads as work at once
  std::mutex mutex_;             // guards idle_ and made_
  std::size_t made_ = 0;
  std::vector<std::unique_ptr<Reconstructor>> idle_;
};

/// Reconstructor::reconstruct_many, one cloud after the other.
std::vector<Reconstruction> reconstruct_in_turn(std::span<const Cloud> clouds, const Options& options,
                                                Reconstructor& reconstructor);

}  // namespace pointskin::detail
