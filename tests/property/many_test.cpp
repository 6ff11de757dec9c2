// Many clouds at once.
#include <gtest/gtest.h>

#include <pointskin/cancel.hpp>
#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <atomic>
#include <limits>
#include <vector>

#include "endurance/jobs.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::hash_of;

/// Of different shapes and sizes; the first is larger than half of all together.
std::vector<Cloud> some_clouds() {
  std::vector<Cloud> clouds{test::sphere_cloud(60'000, 1)};
  for (std::uint64_t i = 0; i < 20; ++i) {
    const auto points = static_cast<std::int64_t>(300 + 97 * i);
    clouds.push_back(i % 2 == 0 ? test::torus_cloud(points, i) : test::sphere_cloud(points, i, 1 + 0.1 * i));
  }
  return clouds;
}

Options at_depth(int depth) {
  Options options;
  options.depth = depth;
  return options;
}

void expect_alike(const std::vector<Cloud>& clouds, const Options& options, int threads) {
  Reconstructor one(Device::cpu(1));
  Reconstructor many(Device::cpu(threads));
  for (int round = 0; round < 2; ++round) {  // the second uses the memory of the first
    const std::vector<Reconstruction> results = many.reconstruct_many(clouds, options);
    ASSERT_EQ(results.size(), clouds.size());
    for (std::size_t i = 0; i < clouds.size(); ++i) {
      ASSERT_FALSE(results[i].error) << results[i].error->what();
      EXPECT_EQ(hash_of(results[i].mesh), hash_of(one.reconstruct(clouds[i], options))) << i;
      EXPECT_EQ(results[i].report.points, clouds[i].size());
      EXPECT_EQ(results[i].report.nodes, one.report().nodes);
    }
  }
}

TEST(ReconstructMany, IsTheSameAsOneByOne) {
  for (const int threads : {1, 2, 5}) expect_alike(some_clouds(), at_depth(5), threads);
}

TEST(ReconstructMany, ManyOptionsActOnEveryCloud) {
  Options options = at_depth(4);
  options.field = FieldKind::distance;
  options.normals = false;
  expect_alike(some_clouds(), options, 3);
}

TEST(ReconstructMany, TakesNoneAndOne) {
  Reconstructor reconstructor(Device::cpu(3));
  EXPECT_TRUE(reconstructor.reconstruct_many({}).empty());
  expect_alike({test::sphere_cloud(500, 1)}, at_depth(4), 3);
}

TEST(ReconstructMany, AnErrorStaysWithItsCloud) {
  std::vector<Cloud> clouds = some_clouds();
  clouds[3] = Cloud();
  clouds[7].normals.clear();
  clouds[11].positions[5].x = std::numeric_limits<float>::quiet_NaN();
  Options options = at_depth(4);
  options.point_normals = PointNormals::given;
  Reconstructor reconstructor(Device::cpu(2));
  const std::vector<Reconstruction> results = reconstructor.reconstruct_many(clouds, options);
  const auto code_of = [&](std::size_t i) { return results[i].error ? results[i].error->code() : ErrorCode::internal; };
  EXPECT_EQ(code_of(3), ErrorCode::empty_result);
  EXPECT_EQ(code_of(7), ErrorCode::no_normals);
  EXPECT_EQ(code_of(11), ErrorCode::invalid_input);
  for (const std::size_t i : {3, 7, 11}) EXPECT_TRUE(results[i].mesh.triangles.empty());
  for (std::size_t i = 0; i < clouds.size(); ++i)
    if (!results[i].error) {
      EXPECT_EQ(hash_of(results[i].mesh), hash_of(reconstructor.reconstruct(clouds[i], options)));
    }
  EXPECT_EQ(std::count_if(results.begin(), results.end(), [](const Reconstruction& one) { return !!one.error; }), 3);
}

TEST(ReconstructMany, RefusesOptionsOutOfRangeAtOnce) {
  Reconstructor reconstructor(Device::cpu(2));
  EXPECT_THROW((void)reconstructor.reconstruct_many(some_clouds(), at_depth(99)), Error);
}

TEST(ReconstructMany, TellsHowManyAreDoneAndEndsWhenAsked) {
  const std::vector<Cloud> clouds = some_clouds();
  Reconstructor reconstructor(Device::cpu(3));
  Options options = at_depth(4);
  std::vector<double> told;
  options.progress = [&](const Progress& progress) {
    told.push_back(progress.fraction);
    return true;
  };
  (void)reconstructor.reconstruct_many(clouds, options);
  ASSERT_EQ(told.size(), clouds.size());
  for (std::size_t i = 0; i < told.size(); ++i)
    EXPECT_DOUBLE_EQ(told[i], static_cast<double>(i + 1) / static_cast<double>(clouds.size()));
  told.clear();
  options.progress = [&](const Progress& progress) {
    told.push_back(progress.fraction);
    return told.size() < 4;
  };
  try {
    (void)reconstructor.reconstruct_many(clouds, options);
    FAIL() << "went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
  EXPECT_EQ(told.size(), 4);
}

TEST(ReconstructMany, ACancelScopeCountsInAllThreads) {
  const std::atomic<bool> stop{true};
  const CancelScope scope(stop);
  Reconstructor reconstructor(Device::cpu(3));
  try {
    (void)reconstructor.reconstruct_many(some_clouds(), at_depth(4));
    FAIL() << "went on";
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::interrupted);
  }
}

}  // namespace
}  // namespace pointskin
