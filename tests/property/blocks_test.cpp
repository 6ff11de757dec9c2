// The mesh has the same bytes for any division into blocks: clouds, options and divisions that a seed chooses. ctest tries a few;
// POINTSKIN_BLOCKS_CASES tries as many as it says.
#include <gtest/gtest.h>

#include <pointskin/device.hpp>

#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>

#include "support/blocks_against_whole.hpp"

namespace pointskin {
namespace {

TEST(Blocks, GiveTheMeshOfTheWholeForAnyCloudOptionsAndDivision) {
  const char* const said = std::getenv("POINTSKIN_BLOCKS_CASES");
  const std::uint64_t cases = said != nullptr ? std::stoull(said) : 2;
  int divisions = 0, cut = 0;
  for (std::uint64_t seed = 1; seed <= cases && !testing::Test::HasFailure(); ++seed) {
    const test::BlocksCompared compared = test::compare_blocks(seed, 2, Device::cpu(2));
    divisions += compared.divisions;
    cut += compared.is_cut ? 1 : 0;
    if (said == nullptr) continue;
    std::printf("seed %llu: %s; %s: %d divisions%s\n", static_cast<unsigned long long>(seed), compared.cloud.c_str(),
                compared.options.c_str(), compared.divisions, compared.is_cut ? ", cut" : "");
    std::fflush(stdout);
  }
  EXPECT_GT(divisions, static_cast<int>(cases));
  if (said != nullptr) std::printf("%d divisions, %d clouds cut\n", divisions, cut);
}

}  // namespace
}  // namespace pointskin
