#include "normals/sign_graph.hpp"

#include <pointskin/error.hpp>

#include <cstring>
#include <limits>
#include <utility>

#include "exec/atomic.hpp"
#include "exec/this_space.hpp"

namespace pointskin::normals {
namespace {

using namespace sign_graph;

/// The surest link of every point: at both of its ends, so that picks never run in a circle.
struct PickLinks {
  static constexpr int kIndexBits = 36;
  LinkedLines lines;
  bool has_sides;
  std::uint64_t* best;

  /// Among equal votes any order will do, but not one along the points: chains would be long.
  PSK_HD static std::uint64_t shuffled(std::uint64_t link) {
    return link * 0x9e3779b97f4a7c15ULL & ((std::uint64_t{1} << kIndexBits) - 1);  // odd: no two become one
  }
  PSK_HD void operator()(std::int64_t i) const {
    for (int l = 0; l < kLinks; ++l) {
      const std::int64_t link = i * kNeighbours + l;
      const std::int32_t j = lines.ids[link];
      if (j < 0) return;
      const std::uint64_t key = key_of(i, j, link);
      if (key == 0) continue;
      exec::raise_to(best + i, key);
      exec::raise_to(best + j, key);
    }
  }
  [[nodiscard]] PSK_HD std::uint64_t key_of(std::int64_t i, std::int32_t j, std::int64_t link) const {
    const std::int64_t vote = vote_of(lines, i, j);
    if (vote == 0 || (has_sides && vote < 0)) return 0;
    return static_cast<std::uint64_t>(size_of(vote)) << kIndexBits | shuffled(link);
  }
};

/// Which link a point has picked: found again among its own, or named by the other end.
struct NamePicks {
  PickLinks pick;
  ArrayView<std::int64_t> picked;  // starts as -1
  PSK_HD void operator()(std::int64_t i) const {
    for (int l = 0; l < kLinks; ++l) {
      const std::int64_t link = i * kNeighbours + l;
      const std::int32_t j = pick.lines.ids[link];
      if (j < 0) return;
      const std::uint64_t key = pick.key_of(i, j, link);
      if (key == 0) continue;
      if (pick.best[i] == key) picked[i] = link;
      if (pick.best[j] == key) picked[j] = link;  // one writer: keys differ
    }
  }
};

/// A forest: everyone's parent, and the sign relative to it.
struct Forest {
  ArrayView<std::int32_t> parents;
  ArrayView<std::int32_t> signs;
};

struct HookPoints {
  LinkedLines lines;
  ArrayView<const std::int64_t> picked;
  Forest forest;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t link = picked[i];
    forest.parents[i] = static_cast<std::int32_t>(i);
    forest.signs[i] = 1;
    if (link < 0) return;
    const std::int64_t from = link / kNeighbours;
    const std::int32_t to = lines.ids[link];
    const std::int64_t other = from == i ? to : from;
    if (picked[other] == link && i < other) return;  // both picked it: the first is the root
    forest.parents[i] = static_cast<std::int32_t>(other);
    forest.signs[i] = vote_of(lines, from, to) < 0 ? -1 : 1;
  }
};

/// Walks to the root. Expected chains are short: ties are shuffled.
struct Resolve {
  Forest forest;
  ArrayView<std::int32_t> roots;
  ArrayView<std::int32_t> signs;
  PSK_HD void operator()(std::int64_t i) const {
    auto at = static_cast<std::int32_t>(i);
    std::int32_t sign = 1;
    while (forest.parents[at] != at) {
      sign *= forest.signs[at];
      at = forest.parents[at];
    }
    roots[i] = at;
    signs[i] = sign;
  }
};

struct IsRoot {
  ArrayView<const std::int32_t> roots;
  PSK_HD bool operator()(std::int64_t i) const { return roots[i] == i; }
};
struct NumberRoots {
  ArrayView<const std::int32_t> list;
  ArrayView<std::int32_t> number;
  PSK_HD void operator()(std::int64_t r) const { number[list[r]] = static_cast<std::int32_t>(r); }
};
struct ApplyNumbers {
  ArrayView<const std::int32_t> number;
  ArrayView<std::int32_t> roots;
  PSK_HD void operator()(std::int64_t i) const { roots[i] = number[roots[i]]; }
};

/// What became of the patches before: their new labels, and signs relative to them.
struct Joined {
  std::int32_t count = 0;
  exec::Buffer<std::int32_t> labels, signs;
};

template <exec::Space Exec>
Joined join(Exec& ex, std::int64_t n, const Forest& forest) {
  Joined out;
  out.labels = exec::make_buffer<std::int32_t>(ex, n);
  out.signs = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, "normals.join", n, Resolve{forest, out.labels.view(), out.signs.view()});
  const exec::Buffer<std::int32_t> roots = select(ex, "normals.join", n, IsRoot{out.labels.cview()});
  out.count = static_cast<std::int32_t>(roots.size());
  auto number = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, "normals.join", roots.size(), NumberRoots{roots.cview(), number.view()});
  for_each(ex, "normals.join", n, ApplyNumbers{number.cview(), out.labels.view()});
  return out;
}

struct CountSizes {
  ArrayView<const std::int32_t> labels;
  ArrayView<const std::uint64_t> weights;  // empty: 1 each
  std::uint64_t* sizes;
  PSK_HD void operator()(std::int64_t i) const { exec::add(sizes + labels[i], weights.empty() ? 1 : weights[i]); }
};

PSK_HD std::uint64_t pair_of(std::int32_t a, std::int32_t b) {
  return a < b ? static_cast<std::uint64_t>(a) << 32 | static_cast<std::uint32_t>(b)
               : static_cast<std::uint64_t>(b) << 32 | static_cast<std::uint32_t>(a);
}

/// A link between two patches.
struct IsBetween {
  LinkedLines lines;
  ArrayView<const std::int32_t> labels;
  PSK_HD bool operator()(std::int64_t e) const {
    const std::int64_t i = e / kLinks;
    const std::int32_t j = lines.ids[i * kNeighbours + e % kLinks];
    return j >= 0 && labels[i] != labels[j] && vote_of(lines, i, j) != 0;
  }
};
struct WriteLinks {
  LinkedLines lines;
  ArrayView<const std::int32_t> labels, signs, links;
  ArrayView<std::uint64_t> pairs;
  ArrayView<std::int16_t> votes;
  PSK_HD void operator()(std::int64_t m) const {
    const std::int64_t i = links[m] / kLinks;
    const std::int32_t j = lines.ids[i * kNeighbours + links[m] % kLinks];
    const std::int64_t vote = vote_of(lines, i, j) * signs[i] * signs[j];
    pairs[m] = pair_of(labels[i], labels[j]);
    votes[m] = static_cast<std::int16_t>(vote);
  }
};

/// Pairs are sorted by the bits that labels have.
struct Pack {
  int bits;
  ArrayView<const std::uint64_t> pairs;
  ArrayView<std::uint64_t> keys;
  PSK_HD void operator()(std::int64_t m) const { keys[m] = (pairs[m] >> 32) << bits | (pairs[m] & 0xffffffff); }
};
PSK_HD PatchVotes to_votes(const PatchVotes& votes) { return votes; }
PSK_HD PatchVotes to_votes(std::int16_t vote) { return {vote, size_of(vote), 1}; }

template <class Vote>
struct SumRuns {
  int bits;
  ArrayView<const std::uint64_t> keys;
  ArrayView<const std::int32_t> starts, order;
  ArrayView<const Vote> votes;
  ArrayView<std::uint64_t> pairs_out;
  ArrayView<PatchVotes> votes_out;
  PSK_HD void operator()(std::int64_t r) const {
    const std::int64_t last = r + 1 < starts.size ? starts[r + 1] : keys.size;
    PatchVotes sum;
    for (std::int64_t m = starts[r]; m < last; ++m) sum = sum + to_votes(votes[order[m]]);
    const std::uint64_t key = keys[starts[r]];
    pairs_out[r] = (key >> bits) << 32 | (key & ((std::uint64_t{1} << bits) - 1));
    votes_out[r] = sum;
  }
};

/// One entry for every pair, ascending, and the sums of their votes. @param votes  PatchVotes, or those of single links
template <exec::Space Exec, class Vote>
exec::Buffer<PatchVotes> sum_pairs(Exec& ex, std::int32_t count, exec::Buffer<std::uint64_t>& pairs,
                                   const exec::Buffer<Vote>& votes) {
  int bits = 1;
  while (bits < 31 && (std::int32_t{1} << bits) < count) ++bits;
  const std::int64_t m = pairs.size();
  auto keys = exec::make_buffer<std::uint64_t>(ex, m);
  for_each(ex, "normals.pairs", m, Pack{bits, pairs.cview(), keys.view()});
  pairs.reset();
  exec::Buffer<std::int32_t> order = exec::iota(ex, m);
  sort_pairs(ex, "normals.pairs", keys, order, 2 * bits);
  const exec::Buffer<std::int32_t> starts = exec::run_starts(ex, "normals.pairs", keys.cview());
  pairs = exec::make_buffer<std::uint64_t>(ex, starts.size());
  auto sums = exec::make_buffer<PatchVotes>(ex, starts.size());
  for_each(ex, "normals.pairs", starts.size(),
           SumRuns<Vote>{bits, keys.cview(), starts.cview(), order.cview(), votes.cview(), pairs.view(), sums.view()});
  return sums;
}

/// Pairs that may merge, at both of their patches.
struct PickPairs {
  MergeRule rule;
  ArrayView<const std::uint64_t> pairs, sizes;
  ArrayView<const PatchVotes> votes;
  std::uint64_t* best;

  /// Of normals that have their likely signs: a border through a surface, not from sheet to sheet, where votes are weak
  /// and, along a longer border, contradict each other. @param smaller  points of the smaller patch
  [[nodiscard]] PSK_HD bool may_turn(const PatchVotes& v, std::int64_t smaller) const {
    constexpr std::int64_t kLong = 16;
    constexpr double kAgreed = 0.8;
    constexpr double kAsGood = 0.8;
    constexpr double kLongest = 256.0 * kFullVote;
    constexpr double kAllAgreed = 0.9;
    if (rule.typical > 1) return false;
    const auto net = static_cast<double>(size_of(v.net));
    const auto gross = static_cast<double>(v.gross);
    if (smaller < rule.small && net >= rule.agreement * gross) return true;
    if (gross >= kLongest && net >= kAllAgreed * gross) return true;
    return v.count >= kLong && net >= kAgreed * gross &&
           gross >= kAsGood * rule.typical * static_cast<double>(v.count * kFullVote);
  }
  [[nodiscard]] PSK_HD std::uint64_t key_of(std::int64_t m) const {
    const PatchVotes v = votes[m];
    const auto net = static_cast<double>(size_of(v.net));
    const auto gross = static_cast<double>(v.gross);
    if (v.net == 0) return 0;
    const std::uint64_t a = sizes[static_cast<std::int64_t>(pairs[m] >> 32)];
    const std::uint64_t b = sizes[static_cast<std::int64_t>(pairs[m] & 0xffffffff)];
    const auto smaller = static_cast<std::int64_t>(a < b ? a : b);
    if (net < rule.agreement * gross && smaller >= rule.small) return 0;
    if (rule.typical > 0 && v.net < 0 && !may_turn(v, smaller)) return 0;
    const auto score = static_cast<float>(net * net / gross);  // positive floats have the order of their bits
    std::uint32_t bits;
    memcpy(&bits, &score, sizeof bits);
    return static_cast<std::uint64_t>(bits) << 32 | (static_cast<std::uint32_t>(m) * 0x9e3779b1U);
  }
  PSK_HD void operator()(std::int64_t m) const {
    const std::uint64_t key = key_of(m);
    if (key == 0) return;
    exec::raise_to(best + (pairs[m] >> 32), key);
    exec::raise_to(best + (pairs[m] & 0xffffffff), key);
  }
};
struct NamePairs {
  PickPairs pick;
  ArrayView<std::int32_t> picked;  // starts as -1
  PSK_HD void operator()(std::int64_t m) const {
    const std::uint64_t key = pick.key_of(m);
    if (key == 0) return;
    for (const std::uint64_t patch : {pick.pairs[m] >> 32, pick.pairs[m] & 0xffffffff})
      if (pick.best[patch] == key) picked[static_cast<std::int64_t>(patch)] = static_cast<std::int32_t>(m);
  }
};
struct HookPatches {
  ArrayView<const std::uint64_t> pairs;
  ArrayView<const PatchVotes> votes;
  ArrayView<const std::int32_t> picked;
  Forest forest;
  PSK_HD void operator()(std::int64_t c) const {
    const std::int32_t m = picked[c];
    forest.parents[c] = static_cast<std::int32_t>(c);
    forest.signs[c] = 1;
    if (m < 0) return;
    const auto a = static_cast<std::int64_t>(pairs[m] >> 32);
    const auto b = static_cast<std::int64_t>(pairs[m] & 0xffffffff);
    const std::int64_t other = a == c ? b : a;
    if (picked[other] == m && c < other) return;
    forest.parents[c] = static_cast<std::int32_t>(other);
    forest.signs[c] = votes[m].net < 0 ? -1 : 1;
  }
};

struct Relabel {
  ArrayView<const std::int32_t> new_labels, new_signs;
  ArrayView<std::int32_t> labels, signs;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t old = labels[i];
    labels[i] = new_labels[old];
    signs[i] *= new_signs[old];
  }
};
struct StaysApart {
  ArrayView<const std::uint64_t> pairs;
  ArrayView<const std::int32_t> new_labels;
  PSK_HD bool operator()(std::int64_t m) const {
    return new_labels[static_cast<std::int64_t>(pairs[m] >> 32)] !=
           new_labels[static_cast<std::int64_t>(pairs[m] & 0xffffffff)];
  }
};
struct RelabelPairs {
  ArrayView<const std::int32_t> kept, new_labels, new_signs;
  ArrayView<const std::uint64_t> pairs;
  ArrayView<const PatchVotes> votes;
  ArrayView<std::uint64_t> pairs_out;
  ArrayView<PatchVotes> votes_out;
  PSK_HD void operator()(std::int64_t k) const {
    const std::int32_t m = kept[k];
    const auto a = static_cast<std::int64_t>(pairs[m] >> 32);
    const auto b = static_cast<std::int64_t>(pairs[m] & 0xffffffff);
    pairs_out[k] = pair_of(new_labels[a], new_labels[b]);
    votes_out[k] = {votes[m].net * new_signs[a] * new_signs[b], votes[m].gross, votes[m].count};
  }
};

/// Patches after a round, with the pairs that are left.
template <exec::Space Exec>
void apply(Exec& ex, const Joined& joined, SignPatches& patches) {
  for_each(ex, "normals.relabel", patches.labels.size(),
           Relabel{joined.labels.cview(), joined.signs.cview(), patches.labels.view(), patches.signs.view()});
  auto sizes = exec::make_buffer<std::uint64_t>(ex, joined.count);
  exec::fill(ex, sizes.view(), std::uint64_t{0});
  for_each(ex, "normals.sizes", patches.count, CountSizes{joined.labels.cview(), patches.sizes.cview(), sizes.data()});
  patches.sizes = std::move(sizes);
  const exec::Buffer<std::int32_t> kept =
      select(ex, "normals.relabel", patches.pairs.size(), StaysApart{patches.pairs.cview(), joined.labels.cview()});
  auto pairs = exec::make_buffer<std::uint64_t>(ex, kept.size());
  auto votes = exec::make_buffer<PatchVotes>(ex, kept.size());
  for_each(ex, "normals.relabel", kept.size(),
           RelabelPairs{kept.cview(), joined.labels.cview(), joined.signs.cview(), patches.pairs.cview(),
                        patches.votes.cview(), pairs.view(), votes.view()});
  patches.count = joined.count;
  patches.votes = sum_pairs(ex, patches.count, pairs, votes);
  patches.pairs = std::move(pairs);
}

struct Agreement {
  LinkedLines lines;
  ArrayView<const std::int32_t> signs;
  ArrayView<float> share;
  PSK_HD void operator()(std::int64_t i) const {
    std::int64_t net = 0;
    std::int64_t gross = 0;
    for (int l = 0; l < kLinks; ++l) {
      const std::int32_t j = lines.ids[i * kNeighbours + l];
      if (j < 0) break;
      const std::int64_t vote = vote_of(lines, i, j);
      net += vote * signs[i] * signs[j];
      gross += size_of(vote);
    }
    share[i] = gross > 0 ? 0.5F + 0.5F * (static_cast<float>(net) / static_cast<float>(gross)) : 0.5F;
  }
};

}  // namespace

template <exec::Space Exec>
SignPatches start_patches(Exec& ex, const LinkedLines& lines, bool has_sides) {
  const std::int64_t n = lines.positions.size;
  if (n > std::numeric_limits<std::int32_t>::max() / kNeighbours)
    throw Error(ErrorCode::over_limit, "too many points to orient at once; thin the cloud or split it");
  auto best = exec::make_buffer<std::uint64_t>(ex, n);
  exec::fill(ex, best.view(), std::uint64_t{0});
  const PickLinks pick{lines, has_sides, best.data()};
  for_each(ex, "normals.pick", n, pick);
  auto picked = exec::make_buffer<std::int64_t>(ex, n);
  exec::fill(ex, picked.view(), std::int64_t{-1});
  for_each(ex, "normals.pick", n, NamePicks{pick, picked.view()});
  best.reset();
  auto parents = exec::make_buffer<std::int32_t>(ex, n);
  auto signs = exec::make_buffer<std::int32_t>(ex, n);
  const Forest forest{parents.view(), signs.view()};
  for_each(ex, "normals.hook", n, HookPoints{lines, picked.cview(), forest});
  picked.reset();

  SignPatches patches;
  Joined joined = join(ex, n, forest);
  patches.count = joined.count;
  patches.labels = std::move(joined.labels);
  patches.signs = std::move(joined.signs);
  patches.sizes = exec::make_buffer<std::uint64_t>(ex, patches.count);
  exec::fill(ex, patches.sizes.view(), std::uint64_t{0});
  for_each(ex, "normals.sizes", n, CountSizes{patches.labels.cview(), {}, patches.sizes.data()});
  exec::Buffer<std::int32_t> links = select(ex, "normals.links", n * kLinks, IsBetween{lines, patches.labels.cview()});
  patches.pairs = exec::make_buffer<std::uint64_t>(ex, links.size());
  auto votes = exec::make_buffer<std::int16_t>(ex, links.size());
  for_each(ex, "normals.links", links.size(),
           WriteLinks{lines, patches.labels.cview(), patches.signs.cview(), links.cview(), patches.pairs.view(),
                      votes.view()});
  links.reset();
  patches.votes = sum_pairs(ex, patches.count, patches.pairs, votes);
  return patches;
}

template <exec::Space Exec>
void merge_patches(Exec& ex, const MergeRule& rule, SignPatches& patches) {
  while (!patches.pairs.empty()) {
    auto best = exec::make_buffer<std::uint64_t>(ex, patches.count);
    auto picked = exec::make_buffer<std::int32_t>(ex, patches.count);
    exec::fill(ex, best.view(), std::uint64_t{0});
    exec::fill(ex, picked.view(), std::int32_t{-1});
    const PickPairs pick{rule, patches.pairs.cview(), patches.sizes.cview(), patches.votes.cview(), best.data()};
    for_each(ex, "normals.pick", patches.pairs.size(), pick);
    for_each(ex, "normals.pick", patches.pairs.size(), NamePairs{pick, picked.view()});
    auto parents = exec::make_buffer<std::int32_t>(ex, patches.count);
    auto signs = exec::make_buffer<std::int32_t>(ex, patches.count);
    const Forest forest{parents.view(), signs.view()};
    for_each(ex, "normals.hook", patches.count,
             HookPatches{patches.pairs.cview(), patches.votes.cview(), picked.cview(), forest});
    const Joined joined = join(ex, patches.count, forest);
    if (joined.count == patches.count) return;
    apply(ex, joined, patches);
  }
}

template <exec::Space Exec>
void measure_agreement(Exec& ex, const LinkedLines& lines, ArrayView<const std::int32_t> signs,
                       ArrayView<float> share) {
  for_each(ex, "normals.agreement", share.size, Agreement{lines, signs, share});
}

PSK_INSTANTIATE(start_patches);
PSK_INSTANTIATE(merge_patches);
PSK_INSTANTIATE(measure_agreement);

}  // namespace pointskin::normals
