// What devices are called. Nothing here needs a GPU; where there are some, they answer.
#include <gtest/gtest.h>
#include <pointskin/device.hpp>
#include <pointskin/error.hpp>

#include <string>
#include <vector>

#include "property/reconstruction.hpp"

namespace pointskin {
namespace {

/// As if the machine had these GPUs.
Device device_of(const std::vector<int>& gpus) {
  Device device;
  device.kind = DeviceKind::cuda;
  device.index = gpus.front();
  device.further.assign(gpus.begin() + 1, gpus.end());
  return device;
}

ErrorCode code_of(const std::string& text) {
  const auto error = test::error_of([&] { (void)Device::parse(text); });
  return error.value_or(ErrorCode::internal);
}

TEST(Devices, SayWhatParseReads) {
  EXPECT_EQ(Device::cpu(3).text(), "cpu");
  EXPECT_EQ(device_of({1}).text(), "cuda:1");
  EXPECT_EQ(device_of({2, 0}).text(), "cuda:2,0");
}

TEST(Devices, NameAllTheirGpusTheLeadingOneFirst) {
  EXPECT_EQ(Device::cpu().gpus(), std::vector<int>{});
  EXPECT_EQ(device_of({2, 0, 1}).gpus(), (std::vector<int>{2, 0, 1}));
}

TEST(Devices, AreRefusedWhereTheTextIsNoList) {
  for (const char* text : {"cuda:", "cuda:,", "cuda:0,", "cuda:0,,1", "cuda:0,x", "cuda:-1", "cuda:0 1", "cuda:every"})
    EXPECT_EQ(code_of(text), ErrorCode::usage) << text;
}

TEST(Devices, AreRefusedWhereAGpuIsNamedTwice) {
  EXPECT_EQ(code_of("cuda:0,1,0"), ErrorCode::usage);
  EXPECT_EQ(test::error_of([] { (void)Device::cuda(std::vector<int>{}); }), ErrorCode::usage);
}

TEST(Devices, AreUnavailableWhereAGpuDoesNotAnswer) {
  EXPECT_EQ(code_of("cuda:0,4096"), ErrorCode::device_unavailable);
}

}  // namespace
}  // namespace pointskin
