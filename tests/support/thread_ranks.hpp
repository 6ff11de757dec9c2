// Ranks that are threads of one process: what messages carry is copied from one to the others.
#pragma once

#include <functional>

#include <pointskin/ranks.hpp>

namespace pointskin::test {

/// Calls work(ranks) in `count` threads, each as one of as many ranks. Where one throws, the others stop waiting for it.
/// @throws what the first one that threw has thrown
void run_as_ranks(int count, const std::function<void(Ranks&)>& work);

}  // namespace pointskin::test
