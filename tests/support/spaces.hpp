// Runs one test body on every space. Bodies are type-parameterised tests in headers; a .cpp instantiates them over
// CpuSpaces, a .cu of tests/parity/ over CudaSpaces (their functors need nvcc).
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include "exec/cpu_primitives.hpp"
#ifdef __CUDACC__
#include "exec/cuda_primitives.cuh"
#endif
#include "exec/algorithms.hpp"
#include "support/gpus.hpp"

namespace pointskin::test {

/// A bijection of 64 bits without visible structure: deterministic data on every device.
/// Source: Steele, Lea & Flood, "Fast splittable pseudorandom number generators", 2014 (the mixer of SplitMix64).
PSK_HD inline std::uint64_t hash(std::uint64_t v) {
  v += 0x9e3779b97f4a7c15;
  v = (v ^ (v >> 30)) * 0xbf58476d1ce4e5b9;
  v = (v ^ (v >> 27)) * 0x94d049bb133111eb;
  return v ^ (v >> 31);
}

/// How tests get at a space.
template <class S>
struct SpaceUnderTest;

template <>
struct SpaceUnderTest<exec::Cpu> {
  static bool available() { return true; }
  static std::unique_ptr<exec::Cpu> open() { return std::make_unique<exec::Cpu>(4); }
};
using CpuSpaces = ::testing::Types<exec::Cpu>;

#ifdef __CUDACC__
template <>
struct SpaceUnderTest<exec::Cuda> {
  static bool available() {
    const std::vector<int> gpus = gpus_under_test();
    return exec::cuda_device_count() > *std::max_element(gpus.begin(), gpus.end());
  }
  static std::unique_ptr<exec::Cuda> open() {
    share_what_is_small();
    return std::make_unique<exec::Cuda>(gpus_under_test());
  }
};
using CudaSpaces = ::testing::Types<exec::Cuda>;
#endif

/// Fixture with a fresh space. Its tests are skipped, or fail, where the space is not available.
template <exec::Space S>
class OnSpace : public ::testing::Test {
 public:
  S& space() { return *space_; }

 protected:
  void SetUp() override {
    if (SpaceUnderTest<S>::available()) {
      space_ = SpaceUnderTest<S>::open();
      return;
    }
    if (gpu_required()) FAIL() << "there are not as many GPUs as POINTSKIN_REQUIRE_GPU says";
    GTEST_SKIP() << kTooFewGpus;
  }

 private:
  std::unique_ptr<S> space_;
};

template <class T, exec::Space S>
exec::Buffer<T> upload(S& ex, const std::vector<T>& from) {
  auto to = exec::make_buffer<T>(ex, static_cast<std::int64_t>(from.size()));
  copy_to_device(ex, from.data(), to.view());
  return to;
}

template <class T, exec::Space S>
std::vector<T> to_host(S& ex, const exec::Buffer<T>& from) {
  std::vector<T> to(static_cast<std::size_t>(from.size()));
  copy_to_host(ex, from.cview(), to.data());
  return to;
}

/// Fails at the first difference only: arrays here are too long to print.
template <class T>
void expect_same(const std::vector<T>& got, const std::vector<T>& expected) {
  ASSERT_EQ(got.size(), expected.size());
  for (std::size_t i = 0; i < got.size(); ++i)
    if (!(got[i] == expected[i])) FAIL() << "first difference at " << i << " of " << got.size();
}

}  // namespace pointskin::test
