// Where sorted runs are cut so that several GPUs can merge them, each its share of the result. Nothing here needs a GPU.
// Source: Francis & Mathieson, "A benchmark parallel sort for shared memory multiprocessors", 1988: ranks in all runs decide the
// cuts exactly, whatever the keys.
#pragma once

#include <cstdint>

#include "core/host_device.hpp"
#include "exec/gpus/shares.hpp"

namespace pointskin::exec::gpus {

/// The bits of a key that decide.
struct KeyBits {
  int first, end;

  [[nodiscard]] PSK_HD std::uint64_t operator()(std::uint64_t key) const {
    const std::uint64_t upper = key >> first;
    return end - first >= 64 ? upper : upper & ((std::uint64_t{1} << (end - first)) - 1);
  }
};

/// Keys in runs, one a share, each sorted by `bits`. In the stable order of all, equal keys of an earlier run come first.
struct SortedRuns {
  const std::uint64_t* keys;
  Shares shares;
  KeyBits bits;

  /// Elements of run `run` that come before element `at` of run `own`.
  [[nodiscard]] PSK_HD std::int64_t before(int run, int own, std::int64_t at) const {
    const std::int64_t begin = shares.begin(run);
    if (run == own) return at;
    const std::uint64_t key = bits(keys[shares.begin(own) + at]);
    std::int64_t low = 0;
    std::int64_t high = shares.size(run);
    while (low < high) {
      const std::int64_t middle = low + (high - low) / 2;
      const std::uint64_t other = bits(keys[begin + middle]);
      if (other < key || (other == key && run < own))
        low = middle + 1;
      else
        high = middle;
    }
    return low;
  }

  /// Place of element `at` of run `own` in the order of all.
  [[nodiscard]] PSK_HD std::int64_t rank(int own, std::int64_t at) const {
    std::int64_t sum = 0;
    for (int run = 0; run < shares.count; ++run) sum += before(run, own, at);
    return sum;
  }
};

/// Elements of one run that belong to the first `first_of_all` of the order of all. Many lanes look at once: a look costs as many reads
/// of other GPUs' memory, one after another, as the runs have bits in their sizes.
struct CutSearch {
  SortedRuns runs;
  int run;
  std::int64_t first_of_all;

  std::int64_t low = 0;   // so many belong
  std::int64_t high = 0;  // no more than so many

  [[nodiscard]] PSK_HD bool is_done() const { return low >= high; }
  /// What lane `lane` of `lanes` looks at: an element in [low, high), ascending with the lane.
  [[nodiscard]] PSK_HD std::int64_t place(int lane, int lanes) const {
    return low + (high - low) * (2 * lane + 1) / (2 * lanes);
  }
  [[nodiscard]] PSK_HD bool belongs(std::int64_t at) const { return runs.rank(run, at) < first_of_all; }
  /// After all lanes have looked: `belonging` of them, the first ones, saw an element that belongs.
  PSK_HD void narrow(int belonging, int lanes) {
    const std::int64_t begin = low;
    if (belonging > 0) low = place_from(begin, high, belonging - 1, lanes) + 1;
    if (belonging < lanes) high = place_from(begin, high, belonging, lanes);
  }

 private:
  [[nodiscard]] PSK_HD static std::int64_t place_from(std::int64_t low, std::int64_t high, int lane, int lanes) {
    return low + (high - low) * (2 * lane + 1) / (2 * lanes);
  }
};

}  // namespace pointskin::exec::gpus
