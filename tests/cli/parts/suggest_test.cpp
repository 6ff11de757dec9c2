// Misspelt words find the word that was meant, and others find none.
#include "suggest.hpp"

#include <gtest/gtest.h>

#include <string>
#include <vector>

namespace pointskin::cli {
namespace {

const std::vector<std::string> kOptions = {"--output", "--depth", "--samples-per-node", "--max-memory",
                                           "--scale",  "--shift", "--no-normals",       "--trim",
                                           "-o",       "-q"};

TEST(SpellingDistance, CountsWhatMustBeChanged) {
  EXPECT_EQ(spelling_distance("depth", "depth"), 0);
  EXPECT_EQ(spelling_distance("dpth", "depth"), 1) << "a letter more";
  EXPECT_EQ(spelling_distance("deepth", "depth"), 1) << "a letter less";
  EXPECT_EQ(spelling_distance("dapth", "depth"), 1) << "another letter";
  EXPECT_EQ(spelling_distance("detph", "depth"), 1) << "two swapped";
  EXPECT_EQ(spelling_distance("", "depth"), 5);
  EXPECT_EQ(spelling_distance("depth", ""), 5);
  EXPECT_EQ(spelling_distance("kitten", "sitting"), 3);
  EXPECT_EQ(spelling_distance("ca", "abc"), 3) << "no letter is touched twice";
}

TEST(Nearest, FindsMisspeltOptions) {
  EXPECT_EQ(nearest("--dpth", kOptions), "--depth");
  EXPECT_EQ(nearest("--detph", kOptions), "--depth");
  EXPECT_EQ(nearest("-depth", kOptions), "--depth");
  EXPECT_EQ(nearest("--tirm", kOptions), "--trim");
}

TEST(Nearest, FindsOtherWaysOfWritingAndBeginnings) {
  EXPECT_EQ(nearest("--samplesPerNode", kOptions), "--samples-per-node");
  EXPECT_EQ(nearest("--samples_per_node", kOptions), "--samples-per-node");
  EXPECT_EQ(nearest("--maxMemory", kOptions), "--max-memory");
  EXPECT_EQ(nearest("--NO-NORMALS", kOptions), "--no-normals");
  EXPECT_EQ(nearest("--samples", kOptions), "--samples-per-node");
  EXPECT_EQ(nearest("--out", kOptions), "--output");
  EXPECT_EQ(nearest("--trimming", kOptions), "--trim");
  EXPECT_EQ(nearest("-O", kOptions), "-o");
}

TEST(Nearest, FindsNothingWhereNothingIsNear) {
  for (const char* word : {"--frobnicate", "--xyz", "-x", "--", "", "--d"})
    EXPECT_EQ(nearest(word, kOptions), "") << word;
  EXPECT_EQ(nearest("--depth", {}), "");
}

TEST(Nearest, TakesTheFirstOfSeveralAlike) {
  EXPECT_EQ(nearest("--ab", {"--abcd", "--abce"}), "");
  EXPECT_EQ(nearest("--abc", {"--abcd", "--abce"}), "--abcd");
}

}  // namespace
}  // namespace pointskin::cli
