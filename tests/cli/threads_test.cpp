// Threads that the system does not let be made.
#include <string>

#include <gtest/gtest.h>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

class LimitedThreads : public testing::Test {
 protected:
  void SetUp() override {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
    GTEST_SKIP() << "sanitizers take address space of their own";
#endif
    write_file(folder_ / "in.ply", ply_bytes(sphere(2000)));
    ASSERT_EQ(reconstruct("", "whole.ply", "2").exit_code, 0);
  }

  Result reconstruct(const std::string& limit, const std::string& output, const std::string& threads) {
    return run_shell(
        limit + "exec \"$P\" reconstruct in.ply -q --depth 6 --device cpu --threads " + threads + " -o " + output,
        folder_ / "");
  }

  TemporaryFolder folder_;
};

TEST_F(LimitedThreads, AreFewerAndMakeTheSameMesh) {
  const Result result = reconstruct("ulimit -v 2000000; ", "out.ply", "4096");
  ASSERT_EQ(result.exit_code, 0) << result.signal << result.err;
  EXPECT_EQ(read_file(folder_ / "out.ply"), read_file(folder_ / "whole.ply"));
}

TEST_F(LimitedThreads, NeverAbortTheProgram) {
  for (const char* kibibytes : {"1000000", "400000", "200000", "120000"})
    for (const char* threads : {"4096", "16", "2"}) {
      const Result result = reconstruct(std::string("ulimit -v ") + kibibytes + "; ", "out.ply", threads);
      EXPECT_TRUE(result.exit_code == 0 || result.exit_code == 6)
          << kibibytes << " KiB, " << threads << " threads: " << result.exit_code << " " << result.err;
      if (result.exit_code == 6) {
        EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
      }
    }
}

TEST_F(LimitedThreads, WithoutALimitAreAtMost256) {
  const Result result = reconstruct("", "out.ply", "4096");
  ASSERT_EQ(result.exit_code, 0) << result.signal << result.err;
  EXPECT_EQ(read_file(folder_ / "out.ply"), read_file(folder_ / "whole.ply"));
}

}  // namespace
}  // namespace pointskin::test
