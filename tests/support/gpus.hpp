// Which GPUs tests run on.
#pragma once

#include <cstdlib>
#include <sstream>
#include <string>
#include <vector>

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

}  // namespace pointskin::test
