// Stray points, on every space.
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <string>
#include <vector>

#include "core/stray_limit.hpp"
#include "octree/frame.hpp"
#include "octree/strays.hpp"
#include "support/shapes.hpp"
#include "support/spaces.hpp"
#include "support/stray_clouds.hpp"

namespace pointskin::test {

template <exec::Space S>
octree::StrayPoints strays_on(S& ex, const std::vector<Vec3f>& positions) {
  const exec::Buffer<Vec3f> buffer = upload(ex, positions);
  return octree::find_strays(ex, buffer.cview());
}

inline std::vector<std::int64_t> ascending(const octree::StrayPoints& strays) {
  std::vector<std::int64_t> indices(strays.indices.begin(), strays.indices.end());
  std::sort(indices.begin(), indices.end());
  return indices;
}

inline std::vector<Vec3f> without(const std::vector<Vec3f>& positions, const std::vector<std::int64_t>& left_out) {
  std::vector<Vec3f> others;
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!std::binary_search(left_out.begin(), left_out.end(), static_cast<std::int64_t>(i)))
      others.push_back(positions[i]);
  return others;
}

/// Compares all of the answer with the definition. @returns the number of strays
template <exec::Space S>
std::int64_t expect_definition(S& ex, const std::vector<Vec3f>& positions) {
  const octree::StrayPoints found = strays_on(ex, positions);
  const std::vector<std::int64_t> indices = ascending(found);
  EXPECT_EQ(indices, brute_strays(positions));
  const Bounds core = bounds_of(without(positions, indices));
  EXPECT_EQ(found.core.lower, core.lower);
  EXPECT_EQ(found.core.upper, core.upper);
  for (std::size_t i = 0; i < found.indices.size(); ++i)
    EXPECT_EQ(found.positions[i], positions[static_cast<std::size_t>(found.indices[i])]);
  return found.size();
}

template <exec::Space S>
class StraysOn : public OnSpace<S> {};
TYPED_TEST_SUITE_P(StraysOn);

TYPED_TEST_P(StraysOn, AreNotFoundInCloudsWithout) {
  for (const NamedCloud& c : clouds_without_strays()) {
    SCOPED_TRACE(c.name);
    EXPECT_EQ(expect_definition(this->space(), c.cloud.positions), 0);
  }
}

TYPED_TEST_P(StraysOn, AreAllThatWereAdded) {
  for (const std::int64_t n : {2'500, 40'000, 300'000})
    for (const NamedPlaces& strays : stray_places()) {
      SCOPED_TRACE(strays.name + ", " + std::to_string(n) + " points");
      const Cloud cloud = with_points_at(torus_cloud(n, 1, 0.7, 0.3), strays.places);
      EXPECT_EQ(expect_definition(this->space(), cloud.positions), std::ssize(strays.places));
    }
}

TYPED_TEST_P(StraysOn, AreFoundByTheHundredInLargeClouds) {
  const Cloud cloud = with_points_at(sphere_cloud(400'000, 2), places_around(250, 3, 8, 1000));
  EXPECT_EQ(expect_definition(this->space(), cloud.positions), 250);
}

TYPED_TEST_P(StraysOn, AreFoundAlongsideFarPartsOfTheScene) {
  Cloud cloud = sphere_cloud(400'000, 4);
  append(cloud, sphere_cloud(200, 5, 0.2, {40, 0, 0}));
  cloud = with_points_at(cloud, {{1e5F, 0, 0}, {0, -3e5F, 0}});
  EXPECT_EQ(expect_definition(this->space(), cloud.positions), 2);
}

TYPED_TEST_P(StraysOn, FollowTheirDefinitionInRandomClouds) {
  int with_strays = 0;
  for (std::uint64_t seed = 1; seed <= 60; ++seed) {
    Random random(seed);
    const std::int64_t n = 128 + random.below(seed % 10 == 0 ? 60'000 : 5'000);
    const auto few = static_cast<int>(random.below(2 * stray_limit(n)));
    Cloud cloud = seed % 3 == 0 ? plane_cloud(n, seed) : sphere_cloud(n, seed);
    cloud = with_points_at(cloud, places_around(few, seed + 1000, random.in(1, 4), random.in(4, 300)));
    if (seed % 4 == 0)  // in order of x: the lanes of the first pass see unlike parts
      std::sort(cloud.positions.begin(), cloud.positions.end(),
                [](const Vec3f& a, const Vec3f& b) { return a.x < b.x; });
    SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(n) + " and " + std::to_string(few));
    with_strays += expect_definition(this->space(), cloud.positions) > 0 ? 1 : 0;
  }
  EXPECT_GT(with_strays, 10);
  EXPECT_LT(with_strays, 50);
}

TYPED_TEST_P(StraysOn, BeginFartherAwayThanTheLongestSide) {
  for (const float x : {2.0F, 2.5F, 2.9F, 3.1F, 3.5F, 4.0F, 5.0F, 6.0F, 8.0F}) {  // from a box that ends at 1, 2 wide
    SCOPED_TRACE(x);
    const Cloud cloud = with_points_at(sphere_cloud(20'000, 8), {{x, 0, 0}});
    EXPECT_EQ(expect_definition(this->space(), cloud.positions), x > 3 ? 1 : 0);
  }
}

TYPED_TEST_P(StraysOn, AreKeptWhereTheyHardlyWidenTheBox) {
  for (const float z : {2.5F, 2.9F, 3.1F, 4.0F}) {  // above a plane 2 wide
    SCOPED_TRACE(z);
    const Cloud cloud = with_points_at(plane_cloud(20'000, 9), {{0, 0, z}});
    EXPECT_EQ(expect_definition(this->space(), cloud.positions), z > 3 ? 1 : 0);
  }
}

TYPED_TEST_P(StraysOn, DoNotDependOnTheOrderOfThePoints) {
  const Cloud cloud = with_points_at(sphere_cloud(30'000, 6), places_around(20, 7, 6, 200));
  const octree::StrayPoints expected = strays_on(this->space(), cloud.positions);
  ASSERT_EQ(expected.size(), 20);
  for (const std::uint64_t seed : {1, 2, 3}) {
    const octree::StrayPoints found = strays_on(this->space(), shuffled(cloud, seed).positions);
    EXPECT_EQ(found.positions, expected.positions);  // the farthest first
    EXPECT_EQ(found.core.lower, expected.core.lower);
    EXPECT_EQ(found.core.upper, expected.core.upper);
  }
}

TYPED_TEST_P(StraysOn, LeaveTheOtherIndices) {
  for (const std::vector<std::int32_t>& listed :
       {std::vector<std::int32_t>{}, {0}, {999}, {3, 2, 1}, {500, 0, 999, 998}}) {
    octree::StrayPoints strays;
    strays.indices = listed;
    std::vector<std::int32_t> expected;
    for (std::int32_t i = 0; i < 1000 && !listed.empty(); ++i)
      if (std::find(listed.begin(), listed.end(), i) == listed.end()) expected.push_back(i);
    EXPECT_EQ(to_host(this->space(), octree::without_strays(this->space(), 1000, strays)), expected);
  }
}

REGISTER_TYPED_TEST_SUITE_P(StraysOn, AreNotFoundInCloudsWithout, AreAllThatWereAdded,
                            AreFoundByTheHundredInLargeClouds, AreFoundAlongsideFarPartsOfTheScene,
                            FollowTheirDefinitionInRandomClouds, BeginFartherAwayThanTheLongestSide,
                            AreKeptWhereTheyHardlyWidenTheBox, DoNotDependOnTheOrderOfThePoints, LeaveTheOtherIndices);

}  // namespace pointskin::test
