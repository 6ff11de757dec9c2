// Runs that go wrong, or are cancelled, between those that do not.
#pragma once

#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>

#include "endurance/jobs.hpp"

namespace pointskin::test {

/// Code of the Error that a run ends in; none if it ends well.
inline std::optional<ErrorCode> end_of_run(Reconstructor& reconstructor, const Cloud& cloud, const Options& options) {
  try {
    (void)reconstructor.reconstruct(cloud, options);
  } catch (const Error& error) {
    return error.code();
  }
  return std::nullopt;
}

/// The callback says no when it is called for the `calls`-th time, from 0 on.
inline void cancel(Reconstructor& reconstructor, Job job, int calls) {
  int left = calls;
  job.options.progress = [&left](const Progress&) { return left-- > 0; };
  const std::optional<ErrorCode> end = end_of_run(reconstructor, job.cloud, job.options);
  EXPECT_EQ(end, left < 0 ? std::optional(ErrorCode::interrupted) : std::nullopt);
}

/// What the callback throws comes out of the run as it is.
inline void throw_from_progress(Reconstructor& reconstructor, Job job) {
  job.options.progress = [](const Progress& progress) {
    if (progress.fraction > 0.3) throw std::domain_error("of the caller");
    return true;
  };
  EXPECT_THROW((void)reconstructor.reconstruct(job.cloud, job.options), std::domain_error);
}

/// The memory of a run is cut short when it has begun: the run then ends, or does without what it can do without.
inline void run_short_of_memory(Reconstructor& reconstructor, Job job) {
  ASSERT_EQ(end_of_run(reconstructor, job.cloud, job.options), std::nullopt);
  job.options.max_memory_bytes = reconstructor.report().device_peak_bytes * 9 / 10;
  EXPECT_EQ(end_of_run(reconstructor, job.cloud, job.options).value_or(ErrorCode::over_limit), ErrorCode::over_limit);
}

/// One of ten ways to go wrong, in turn.
inline void disturb(int turn, Reconstructor& reconstructor, Job job) {
  const auto expect = [&](ErrorCode code) { EXPECT_EQ(end_of_run(reconstructor, job.cloud, job.options), code); };
  switch (turn % 10) {
    case 0:
      job.options.depth = 99;
      return expect(ErrorCode::usage);
    case 1:
      job.cloud = Cloud{};
      return expect(ErrorCode::empty_result);
    case 2:
      job.cloud.normals.clear();
      job.options.point_normals = PointNormals::given;
      return expect(ErrorCode::no_normals);
    case 3:
      job.cloud.positions[7].y = std::numeric_limits<float>::quiet_NaN();
      return expect(ErrorCode::invalid_input);
    case 4:
      job.options.max_memory_bytes = 4096;
      return expect(ErrorCode::over_limit);
    case 5:
      return run_short_of_memory(reconstructor, job);
    case 6:
      return throw_from_progress(reconstructor, job);
    default:
      return cancel(reconstructor, job, turn / 10 % 12);
  }
}

}  // namespace pointskin::test
