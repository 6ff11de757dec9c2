// Many reconstructions on a GPU in one process: its memory does not run out, the bytes are those of the CPU; and what
// happens when the device is reset under a reconstructor, or the process forks.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <cuda_runtime_api.h>
#include <unistd.h>

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <thread>
#include <vector>

#include "endurance/children.hpp"
#include "endurance/disturbances.hpp"
#include "endurance/jobs.hpp"
#include "endurance/process_state.hpp"
#include "parity/gpu_test.hpp"

namespace pointskin {
namespace {

using test::hash_of;
using test::Job;

constexpr int kJobs = 44;
constexpr int kWarmUp = 50;

class GpuEndurance : public test::GpuTest {
 protected:
  static std::int64_t free_bytes() {
    std::size_t free = 0, total = 0;
    EXPECT_EQ(::cudaMemGetInfo(&free, &total), cudaSuccess);
    return static_cast<std::int64_t>(free);
  }

  const std::vector<Job> jobs_ = test::endurance_jobs(kJobs);
};

TEST_F(GpuEndurance, NeitherTheDeviceNorTheHostLosesMemory) {
  std::vector<std::uint64_t> on_cpu;
  for (const Job& job : jobs_) on_cpu.push_back(test::hash_alone(job, Device::cpu()));
  Reconstructor reconstructor(gpu_);
  test::Random random(17);
  test::ProcessState before;
  std::int64_t free_before = 0;
  for (int i = 0; i < test::endurance_runs(); ++i) {
    if (i == kWarmUp) {
      reconstructor.workspace().release_memory();
      before = test::process_state();
      free_before = free_bytes();
    }
    const auto number = static_cast<std::size_t>(i < kJobs ? i : random.below(kJobs));
    SCOPED_TRACE("run " + std::to_string(i) + ": " + jobs_[number].name);
    test::disturb(i, reconstructor, jobs_[number]);
    ASSERT_EQ(hash_of(reconstructor.reconstruct(jobs_[number].cloud, jobs_[number].options)), on_cpu[number]);
    ASSERT_EQ(reconstructor.workspace().held_bytes(), 0);
  }
  reconstructor.workspace().release_memory();
  test::expect_no_growth(before, test::process_state());
  constexpr std::int64_t kOfOthers = std::int64_t{64} << 20;  // other processes may take and free memory meanwhile
  EXPECT_GE(free_bytes(), free_before - kOfOthers);
}

TEST_F(GpuEndurance, ReconstructorsThatComeAndGoLeaveNothingOnTheDevice) {
  std::int64_t free_before = 0;
  for (int i = 0; i < test::endurance_runs(); ++i) {
    if (i == kWarmUp) free_before = free_bytes();
    (void)Reconstructor(gpu_).reconstruct(jobs_[static_cast<std::size_t>(i) % kJobs].cloud, Options{{.depth = 5}});
  }
  EXPECT_GE(free_bytes(), free_before - (std::int64_t{64} << 20));
}

// A forked child has no use of its parent's CUDA: it must hear so, and may use the CPU.
TEST_F(GpuEndurance, AForkedChildGetsAnErrorAndTheCpuStillWorks) {
  const Job& job = jobs_[0];
  const std::uint64_t expected = test::hash_alone(job, gpu_);
  const auto refused = [&] {
    try {
      (void)test::hash_alone(job, gpu_);
    } catch (const Error& error) {
      return error.code() == ErrorCode::device_unavailable;
    }
    return false;
  };
  EXPECT_EQ(test::end_of_child(refused), "well");
  EXPECT_EQ(test::end_of_child([&] { return test::hash_alone(job, Device::cpu(2)) == expected; }), "well");
  EXPECT_EQ(test::hash_alone(job, gpu_), expected) << "the parent's GPU is as it was";
}

// In a process of its own (a new program, since a forked one has no GPU): what runs here must not notice.
TEST_F(GpuEndurance, AResetInAnotherProcessChangesNothing) {
  const Job& job = jobs_[1];
  Reconstructor reconstructor(gpu_);
  const std::uint64_t expected = hash_of(reconstructor.reconstruct(job.cloud, job.options));
  std::string program = "/proc/self/exe", filter = "--gtest_filter=ResetOfTheDevice.*",
              disabled = "--gtest_also_run_disabled_tests";
  char* const arguments[] = {program.data(), filter.data(), disabled.data(), nullptr};
  EXPECT_EQ(test::end_of_child([&] { return ::execv("/proc/self/exe", arguments) == 0; }), "well");
  EXPECT_EQ(hash_of(reconstructor.reconstruct(job.cloud, job.options)), expected);
}

/// What a run on `reconstructor` ends in: the hash, or none where it ended in the error that the device is lost.
std::optional<std::uint64_t> hash_or_loss(Reconstructor& reconstructor, const Job& job) {
  try {
    return hash_of(reconstructor.reconstruct(job.cloud, job.options));
  } catch (const Error& error) {
    EXPECT_EQ(error.code(), ErrorCode::device_unavailable) << error.what();
  }
  return std::nullopt;
}

/// A reset takes all memory of the process on the device, so it has a process of its own: the test above starts it.
class ResetOfTheDevice : public test::GpuTest {};

TEST_F(ResetOfTheDevice, DISABLED_GivesAnErrorOrWorksAndALaterReconstructorWorks) {
  const Job job = test::endurance_jobs(1)[0];
  const std::uint64_t expected = test::hash_alone(job, Device::cpu(2));
  Reconstructor reconstructor(gpu_);
  EXPECT_EQ(hash_of(reconstructor.reconstruct(job.cloud, job.options)), expected);
  std::thread([] { EXPECT_EQ(::cudaDeviceReset(), cudaSuccess); }).join();
  const std::optional<std::uint64_t> after = hash_or_loss(reconstructor, job);
  if (after) EXPECT_EQ(*after, expected);
  EXPECT_EQ(test::hash_alone(job, Device::cpu(2)), expected) << "the CPU does not need the device";
  Reconstructor fresh(gpu_);
  const std::optional<std::uint64_t> of_fresh = hash_or_loss(fresh, job);
  if (of_fresh) EXPECT_EQ(*of_fresh, expected);
}

}  // namespace
}  // namespace pointskin
