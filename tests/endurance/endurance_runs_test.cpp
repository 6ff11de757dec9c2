// A thousand reconstructions in one process, between errors and cancellations: it does not grow, and every result has
// the bytes that it has alone.
#include <gtest/gtest.h>

#include <pointskin/reconstruct.hpp>

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "endurance/disturbances.hpp"
#include "endurance/jobs.hpp"
#include "endurance/process_state.hpp"

namespace pointskin {
namespace {

using test::endurance_runs;
using test::hash_of;
using test::Job;

constexpr int kJobs = 44;    // every set of options at every depth
constexpr int kWarmUp = 50;  // runs after which nothing may grow

class Endurance : public testing::Test {
 protected:
  Endurance() {
    for (const Job& job : jobs_) alone_.push_back(test::hash_alone(job, Device::cpu(1)));
  }

  /// Which job the run `i` does: all of them first, then any.
  std::size_t job_of(int i) { return static_cast<std::size_t>(i < kJobs ? i : random_.below(kJobs)); }

  std::vector<Job> jobs_ = test::endurance_jobs(kJobs);
  std::vector<std::uint64_t> alone_;
  test::Random random_{17};
};

/// Three ways to the same bytes.
Mesh mesh_by(int way, Reconstructor& reconstructor, const Job& job) {
  if (way % 3 == 0) return reconstructor.reconstruct(job.cloud, job.options);
  if (way % 3 == 1) return reconstructor.solve(job.cloud, SolveOptions(job.options)).extract(job.options);
  Mesh mesh;
  mesh.vertices.resize(1000);  // what it held before must not matter
  reconstructor.reconstruct(job.cloud, job.options, mesh);
  return mesh;
}

TEST_F(Endurance, OneReconstructorNeitherGrowsNorChangesItsResults) {
  Reconstructor reconstructor(Device::cpu(2));
  test::ProcessState before;
  for (int i = 0; i < endurance_runs(); ++i) {
    if (i == kWarmUp) {
      reconstructor.workspace().release_memory();
      before = test::process_state();
    }
    const std::size_t number = job_of(i);
    SCOPED_TRACE("run " + std::to_string(i) + ": " + jobs_[number].name);
    test::disturb(i, reconstructor, jobs_[number]);
    ASSERT_EQ(hash_of(mesh_by(i, reconstructor, jobs_[number])), alone_[number]);
    ASSERT_EQ(reconstructor.workspace().held_bytes(), 0);
  }
  reconstructor.workspace().release_memory();
  test::expect_no_growth(before, test::process_state());
}

TEST_F(Endurance, ReconstructorsThatComeAndGoLeaveNothing) {
  test::ProcessState before;
  for (int i = 0; i < endurance_runs(); ++i) {
    if (i == kWarmUp) before = test::process_state();
    const std::size_t number = job_of(i);
    SCOPED_TRACE("run " + std::to_string(i) + ": " + jobs_[number].name);
    Reconstructor reconstructor(Device::cpu(1 + i % 3));
    test::disturb(i, reconstructor, jobs_[number]);
    ASSERT_EQ(hash_of(mesh_by(i, reconstructor, jobs_[number])), alone_[number]);
  }
  test::expect_no_growth(before, test::process_state());
}

}  // namespace
}  // namespace pointskin
