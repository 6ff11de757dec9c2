// Many clouds at once on the CPU, each on one thread.
#pragma once

#include <memory>
#include <mutex>
#include <span>
#include <vector>

#include <pointskin/reconstruct.hpp>

#include "exec/cpu.hpp"

namespace pointskin::detail {

/// Reconstructors of one thread each, kept with their memory from one call to the next.
class Crew {
 public:
  /// @param threads  as of Device
  explicit Crew(int threads) : cpu_(threads) {}

  /// Reconstructor::reconstruct_many on the CPU.
  /// @param all_threads  for clouds that are reconstructed alone
  std::vector<Reconstruction> reconstruct(std::span<const Cloud> clouds, const Options& options,
                                          Reconstructor& all_threads);

 private:
  /// One that no thread uses now.
  std::unique_ptr<Reconstructor> take();
  void put_back(std::unique_ptr<Reconstructor> reconstructor);

  exec::Cpu cpu_;
  std::mutex mutex_;  // guards idle_
  std::vector<std::unique_ptr<Reconstructor>> idle_;
};

/// Reconstructor::reconstruct_many, one cloud after the other.
std::vector<Reconstruction> reconstruct_in_turn(std::span<const Cloud> clouds, const Options& options,
                                                Reconstructor& reconstructor);

}  // namespace pointskin::detail
