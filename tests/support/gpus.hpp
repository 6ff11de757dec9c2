// Which GPUs tests run on.
#pragma once

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

#ifdef POINTSKIN_HAS_CUDA
#include "exec/gpus/group.hpp"
#endif

namespace pointskin::test {

/// The numbers in POINTSKIN_TEST_GPUS, such as "0,1": several as one. Without it the first GPU.
inline std::vector<int> gpus_under_test() {
  const char* text = std::getenv("POINTSKIN_TEST_GPUS");
  if (text == nullptr) return {0};
  std::vector<int> gpus;
  std::istringstream in(text);
  for (std::string number; std::getline(in, number, ',');) gpus.push_back(std::stoi(number));
  return gpus;
}

/// True if a missing GPU is a failure: POINTSKIN_REQUIRE_GPU says how many must be there, as 1.
inline bool gpu_required() {
  const char* value = std::getenv("POINTSKIN_REQUIRE_GPU");
  return value != nullptr && std::atoi(value) >= static_cast<int>(gpus_under_test().size());
}

/// Why tests are skipped: tests/CMakeLists.txt looks for it.
inline constexpr const char* kTooFewGpus = "too few GPUs for this test";

#ifdef POINTSKIN_HAS_CUDA
/// Several GPUs share arrays and work that would not be worth it, so that small tests try what large clouds do: all of them, or with
/// POINTSKIN_TEST_SHARES=mixed those above some thousand elements, so that what is shared and what is not take turns.
inline void share_what_is_small() {
  const char* shares = std::getenv("POINTSKIN_TEST_SHARES");
  const bool is_mixed = shares != nullptr && std::string(shares) == "mixed";
  exec::gpus::worth_sharing() = is_mixed ? exec::gpus::WorthSharing{.threads = 4096, .elements = 4096, .bytes = 65536}
                                         : exec::gpus::WorthSharing{.threads = 1, .elements = 1, .bytes = 1};
}
#endif

}  // namespace pointskin::test
