// The steps on the complete levels on a GPU, with the bits of complete_solve.cpp: all of them in one cooperative launch, one
// thread a corner of the last level.
#pragma once

#include <algorithm>
#include <cstddef>
#include <vector>

#include "exec/cuda_primitives.cuh"
#include "poisson/complete_steps.hpp"

namespace pointskin::poisson {

struct SweepComplete : exec::SweepAll {
  static constexpr int kMostSteps = 72;

  CompleteAt at;
  CompleteStep steps[kMostSteps];

  [[nodiscard]] PSK_HD int indices(int round) const {
    return static_cast<int>(at.levels.fields[steps[round].level].level.nodes());
  }
  PSK_HD void operator()(int round, int n, Nothing) const { at(steps[round], n); }
};
static_assert(sizeof(SweepComplete) <= 4000, "arguments of a kernel have 4 KiB");

inline void do_steps(exec::Cuda& ex, const CompleteLevels& levels, const std::vector<CompleteStep>& plan) {
  const auto all = static_cast<int>(plan.size());
  for (int done = 0; done < all; done += SweepComplete::kMostSteps) {
    SweepComplete some{{}, {levels}, {}};
    const int count = std::min(all - done, SweepComplete::kMostSteps);
    std::copy_n(plan.begin() + done, count, some.steps);
    sweep(ex, "solve.complete", count, levels.fields[levels.top].level.nodes(), some);
  }
}

}  // namespace pointskin::poisson
