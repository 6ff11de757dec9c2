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
  void release_memory();

  Device member_;     // of each reconstructor
  exec::Cpu cpu_;     // as many threads as work at once
  std::mutex mutex_;  // guards idle_
  std::vector<std::unique_ptr<Reconstructor>> idle_;
};

}  // namespace pointskin::detail
