// What tests of the public API on a GPU share.
#pragma once

#include <gtest/gtest.h>

#include <pointskin/device.hpp>
#include <pointskin/error.hpp>

#include "support/gpus.hpp"

namespace pointskin::test {

/// Tests with the GPUs of tests/support/gpus.hpp: skipped where they do not answer, failed where POINTSKIN_REQUIRE_GPU says that they must.
class GpuTest : public testing::Test {
 protected:
  void SetUp() override {
#ifdef POINTSKIN_HAS_CUDA
    share_what_is_small();
#endif
    try {
      gpu_ = Device::cuda(gpus_under_test());
    } catch (const Error& error) {
      ASSERT_EQ(error.code(), ErrorCode::device_unavailable) << error.what();
      if (gpu_required()) FAIL() << "POINTSKIN_REQUIRE_GPU says that there are enough GPUs, but " << error.what();
      GTEST_SKIP() << kTooFewGpus << ": " << error.what();
    }
  }

  Device gpu_;
};

}  // namespace pointskin::test
