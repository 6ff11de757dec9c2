// What tests of the public API on a GPU share.
#pragma once

#include <gtest/gtest.h>

#include <pointskin/device.hpp>
#include <pointskin/error.hpp>

#include "support/spaces.hpp"

namespace pointskin::test {

/// Tests with a GPU: skipped where none answers, failed where POINTSKIN_REQUIRE_GPU=1 says that one must.
class GpuTest : public testing::Test {
 protected:
  void SetUp() override {
    try {
      gpu_ = Device::cuda(0);
    } catch (const Error& error) {
      ASSERT_EQ(error.code(), ErrorCode::device_unavailable) << error.what();
      if (gpu_required()) FAIL() << "POINTSKIN_REQUIRE_GPU=1, but " << error.what();
      GTEST_SKIP() << error.what();
    }
  }

  Device gpu_;
};

}  // namespace pointskin::test
