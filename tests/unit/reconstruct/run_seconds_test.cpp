// Which device is done first: the guess at a run's work, and the choice.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/suggest_device.hpp>

#include "reconstruct/run_seconds.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using detail::guess_work;
using detail::RunWork;
using detail::seconds_on_cpu;
using detail::seconds_on_gpu;

double guessed_nodes(const Cloud& cloud, const Options& options, int threads = 2) {
  exec::Cpu ex(threads);
  return guess_work(ex, cloud, options).nodes;
}

double true_nodes(const Cloud& cloud, const Options& options) {
  Reconstructor reconstructor(Device::cpu(2));
  (void)reconstructor.reconstruct(cloud, options);
  return static_cast<double>(reconstructor.report().nodes);
}

Options at_depth(int depth) {
  Options options;
  options.depth = depth;
  return options;
}

TEST(GuessWork, NodesAreWithinAThirdOfTheRuns) {
  for (const std::int64_t points : {3'000, 30'000, 300'000})
    for (const Cloud& cloud : {test::sphere_cloud(points, 1), test::torus_cloud(points, 2)})
      for (const int depth : {5, 6, 8, 9}) {
        const double run = true_nodes(cloud, at_depth(depth));
        EXPECT_NEAR(guessed_nodes(cloud, at_depth(depth)) / run, 1, 1.0 / 3) << points << " points, depth " << depth;
      }
}

TEST(GuessWork, StraysAreLeftOut) {
  Cloud cloud = test::sphere_cloud(100'000, 3);
  const double without = guessed_nodes(cloud, at_depth(8));
  cloud.positions.push_back({400, 0, 0});
  cloud.normals.push_back({1, 0, 0});
  EXPECT_NEAR(guessed_nodes(cloud, at_depth(8)) / without, 1, 0.01);
  Options keeping = at_depth(8);
  keeping.keep_strays = true;
  EXPECT_LT(guessed_nodes(cloud, keeping), 0.5 * without);
}

TEST(GuessWork, DoesNotDependOnThreads) {
  const Cloud cloud = test::torus_cloud(400'000, 4);  // more than the sample
  EXPECT_EQ(guessed_nodes(cloud, at_depth(9), 1), guessed_nodes(cloud, at_depth(9), 7));
}

TEST(GuessWork, GuessesAtAnAutomaticDepth) {
  const Cloud cloud = test::sphere_cloud(100'000, 5);
  const int depth = suggest_depth(cloud).depth;
  const double nodes = guessed_nodes(cloud, at_depth(Options::kAutomaticDepth));
  EXPECT_GE(nodes, guessed_nodes(cloud, at_depth(depth - 1)));
  EXPECT_LE(nodes, guessed_nodes(cloud, at_depth(depth + 1)));
}

TEST(RunSeconds, AreThoseThatWereMeasured) {
  // A sphere on two NVIDIA H200 and 16 cores of their hosts: 0.177 and 0.179 s, 0.388 and 0.397; 2.173 and 1.614, 0.887 and 0.686.
  const RunWork million{1e6, 1'413'761};
  EXPECT_NEAR(seconds_on_cpu(million, 16), 0.178, 0.03);
  EXPECT_NEAR(seconds_on_gpu(million), 0.393, 0.04);
  const RunWork deep{1e7, 22'287'841};
  EXPECT_NEAR(seconds_on_cpu(deep, 16), 1.894, 0.28);
  EXPECT_NEAR(seconds_on_gpu(deep), 0.787, 0.1);
  EXPECT_GT(seconds_on_cpu(million, 2), seconds_on_gpu(million));
}

TEST(SuggestDevice, IsTheCpuForSmallClouds) {
  const Device device = suggest_device(test::sphere_cloud(10'000, 6), at_depth(6), 3);
  EXPECT_EQ(device.kind, DeviceKind::cpu);
  EXPECT_EQ(device.threads, 3);
  EXPECT_EQ(suggest_device(Cloud()).kind, DeviceKind::cpu);
}

TEST(SuggestDevice, IsAGpuForLargeWorkWhereOneAnswers) {
  const Device device = suggest_device(test::sphere_cloud(200'000, 7), at_depth(12), 1);
  EXPECT_EQ(device.kind, Device::automatic().kind);
}

TEST(SuggestDevice, RefusesOptionsOutOfRange) {
  EXPECT_THROW((void)suggest_device(test::sphere_cloud(100, 8), at_depth(99)), Error);
}

}  // namespace
}  // namespace pointskin
