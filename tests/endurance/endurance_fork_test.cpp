// Processes that have reconstructed and then fork: their children reconstruct with the same bytes, and end.
#include <gtest/gtest.h>

#include <pointskin/reconstruct.hpp>

#include <cstddef>
#include <cstdint>
#include <vector>

#include "endurance/children.hpp"
#include "endurance/jobs.hpp"

namespace pointskin {
namespace {

using test::end_of_child;
using test::hash_of;
using test::Job;

class Fork : public testing::Test {
 protected:
  void SetUp() override {
#ifdef __SANITIZE_THREAD__
    GTEST_SKIP() << "ThreadSanitizer refuses threads in a forked child";
#endif
  }

  const std::vector<Job> jobs_ = test::endurance_jobs(11);
  const int forks_ = test::endurance_runs() / 5;
};

TEST_F(Fork, AChildReconstructsWithTheSameBytes) {
  Reconstructor reconstructor(Device::cpu(2));
  for (int i = 0; i < forks_; ++i) {
    const Job& job = jobs_[static_cast<std::size_t>(i) % jobs_.size()];
    SCOPED_TRACE(job.name);
    const std::uint64_t expected = hash_of(reconstructor.reconstruct(job.cloud, job.options));
    const auto again = [&](Reconstructor& in) { return hash_of(in.reconstruct(job.cloud, job.options)) == expected; };
    ASSERT_EQ(end_of_child([&] { return again(reconstructor); }), "well") << "what was made before the fork";
    ASSERT_EQ(end_of_child([&] {
                Reconstructor of_the_child(Device::cpu(2));
                return again(of_the_child);
              }),
              "well");
  }
}

TEST_F(Fork, AFieldOfTheParentAnswersInTheChild) {
  const Field field = Reconstructor(Device::cpu(2)).solve(jobs_[1].cloud, {.depth = 5});
  const std::uint64_t expected = hash_of(field.extract());
  EXPECT_EQ(end_of_child([&] { return hash_of(field.extract()) == expected; }), "well");
  EXPECT_EQ(hash_of(field.extract()), expected) << "the parent's own is as it was";
}

TEST_F(Fork, AChildOfAChildReconstructs) {
  const Job& job = jobs_[0];
  const std::uint64_t expected = test::hash_alone(job, Device::cpu(2));
  const auto same = [&] { return test::hash_alone(job, Device::cpu(2)) == expected; };
  EXPECT_EQ(end_of_child([&] { return same() && end_of_child(same) == "well"; }), "well");
}

}  // namespace
}  // namespace pointskin
