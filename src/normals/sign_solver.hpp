// Signs of all normals: patches of neighbours that agree, then trial reconstructions that decide on the patches.
#pragma once

#include <pointskin/error.hpp>
#include <pointskin/normals.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numeric>
#include <utility>
#include <vector>

#include "core/stopwatch.hpp"
#include "exec/algorithms.hpp"
#include "normals/arrays.hpp"
#include "normals/disjoint_sets.hpp"
#include "normals/evidence.hpp"
#include "normals/judge.hpp"
#include "normals/sign_graph.hpp"
#include "normals/sign_kernels.hpp"
#include "normals/trial_field.hpp"

namespace pointskin::normals {

/// Links whose votes agree at least so far join patches, the surest first: sums over longer borders are surer. The rest
/// is for trial fields to decide.
inline constexpr std::array kAgreements = {0.98, 0.9, 0.8, 0.7, 0.6};

/// Patches whose couplings are measured: a solve each.
inline constexpr std::size_t kJudgedPatches = 14;

/// Signs of samples that the field or the neighbours turn are settled when fewer than this share change in a round.
inline constexpr double kSettled = 0.001;

template <exec::Space Exec>
class SignSolver {
 public:
  SignSolver(Exec& ex, const LinkedLines& lines, const octree::OctreeData& tree, const Evidence& evidence,
             const NormalOptions& options, NormalReport& report)
      : ex_(ex), lines_(lines), tree_(tree), evidence_(evidence), options_(options), report_(report) {}

  /// Neighbours alone.
  void propagate() {
    const std::int64_t n = lines_.positions.size;
    patches_ = start_patches(ex_, lines_, evidence_.typical > 0);
    for (const double agreement : kAgreements) merge_patches(ex_, {agreement, 0, evidence_.typical}, patches_);
    merge_patches(ex_, {kAgreements.back(), std::max<std::int64_t>(32, n / 2000), evidence_.typical}, patches_);
    report_.patches = patches_.count;
    join_patches();
    signs_ = exec::make_buffer<std::int32_t>(ex_, n);
    fixed_.assign(patch_signs_.size(), false);
    if (!evidence_.signs.empty()) follow_evidence();
    compose(patch_signs_);
  }

  /// Trial reconstructions.
  void judge() {
    TrialField<Exec> trial(ex_, tree_, lines_.positions, lines_.normals);
    if (options_.method == NormalMethod::iterate) iterate(trial);
    judge_patches(trial);
    judge_sides(trial);
    compose(patch_signs_);
    if (evidence_.is_certain())
      trial.solve(signs_.cview());
    else
      clean_up(trial);
    settle_confidence(trial);
  }

  /// (n) signs of the lines.
  [[nodiscard]] const exec::Buffer<std::int32_t>& signs() const { return signs_; }
  /// (n) in [0, 1]; after judge().
  [[nodiscard]] const exec::Buffer<float>& confidence() const { return confidence_; }

 private:
  /// Components of patches, with the less sure votes.
  void join_patches() {
    SignPatches upper;
    upper.count = patches_.count;
    upper.labels = exec::iota(ex_, patches_.count);
    upper.signs = exec::make_buffer<std::int32_t>(ex_, patches_.count);
    exec::fill(ex_, upper.signs.view(), std::int32_t{1});
    upper.sizes = exec::make_buffer<std::uint64_t>(ex_, patches_.count);
    copy(ex_, patches_.sizes.cview(), upper.sizes.view());
    upper.pairs = std::move(patches_.pairs);
    upper.votes = std::move(patches_.votes);
    merge_patches(ex_, {0, 0, evidence_.typical}, upper);
    report_.components = upper.count;
    components_ = to_host(ex_, upper.labels);
    const std::vector<std::int32_t> signs = to_host(ex_, upper.signs);
    patch_signs_.assign(signs.begin(), signs.end());
    sizes_ = to_host(ex_, patches_.sizes);
  }

  void compose(const std::vector<int>& patch_signs) {
    const exec::Buffer<std::int32_t> on_device =
        to_device(ex_, std::vector<std::int32_t>(patch_signs.begin(), patch_signs.end()));
    for_each(ex_, "normals.compose", signs_.size(),
             signs::ComposeSigns{patches_.labels.cview(), patches_.signs.cview(), on_device.cview(), signs_.view()});
  }

  struct Votes {
    std::int64_t net = 0, gross = 0;
    [[nodiscard]] bool decide(double share) const {
      const auto size = static_cast<double>(std::abs(net));
      return gross > 0 && size >= share * static_cast<double>(gross) &&
             size >= 3 * std::sqrt(static_cast<double>(gross));
    }
  };
  /// Of samples, for the sign within their patch.
  std::vector<Votes> votes_of_patches(ArrayView<const std::int32_t> votes) {
    const exec::Buffer<std::uint64_t> net = zeros(ex_, patches_.count);
    const exec::Buffer<std::uint64_t> gross = zeros(ex_, patches_.count);
    for_each(ex_, "normals.votes", votes.size,
             signs::CountVotes{patches_.labels.cview(), patches_.signs.cview(), votes, net.data(), gross.data()});
    const std::vector<std::uint64_t> nets = to_host(ex_, net);
    const std::vector<std::uint64_t> all = to_host(ex_, gross);
    std::vector<Votes> out(nets.size());
    for (std::size_t c = 0; c < out.size(); ++c)
      out[c] = {static_cast<std::int64_t>(nets[c]), static_cast<std::int64_t>(all[c])};
    return out;
  }

  /// Patches, then components, whose samples mostly say the same: most normals are right, or most are wrong.
  void follow_evidence() {
    constexpr double kPatchShare = 0.2;  // 60 : 40
    constexpr double kComponentShare = 0.1;
    const std::vector<Votes> votes = votes_of_patches(evidence_.signs);
    std::vector<Votes> of_components(votes.size());
    for (std::size_t c = 0; c < votes.size(); ++c) {
      Votes& all = of_components[static_cast<std::size_t>(components_[c])];
      all.net += patch_signs_[c] * votes[c].net;
      all.gross += votes[c].gross;
    }
    for (std::size_t c = 0; c < votes.size(); ++c) {
      const Votes& all = of_components[static_cast<std::size_t>(components_[c])];
      if (votes[c].decide(kPatchShare)) {
        patch_signs_[c] = votes[c].net < 0 ? -1 : 1;
        fixed_[c] = true;
      } else if (all.decide(kComponentShare)) {
        patch_signs_[c] *= all.net < 0 ? -1 : 1;
        fixed_[c] = true;
      }
    }
  }

  /// False if there is no time or round left for another solve; else it is counted.
  bool may_solve() {
    if (options_.progress &&
        !options_.progress({"iterate", 0.5 + 0.45 * report_.rounds / std::max(1, options_.max_rounds)}))
      throw Error(ErrorCode::interrupted, "cancelled while signs were decided");
    const double seconds = watch_.milliseconds() / 1000;
    if (report_.rounds >= options_.max_rounds || (options_.time_limit_s > 0 && seconds > options_.time_limit_s)) {
      report_.settled = false;
      return false;
    }
    ++report_.rounds;
    return true;
  }

  struct SetSums {
    double area = 0, field = 0, along = 0;
    [[nodiscard]] double mean() const { return area > 0 ? field / area : 0; }
  };
  /// @param sets  (patches) which sum a patch adds to, or -1
  std::vector<SetSums> measure(const TrialField<Exec>& trial, ArrayView<const std::int32_t> signs,
                               const std::vector<std::int32_t>& sets, std::size_t count) {
    constexpr int kSums = signs::MeasureSets::kSums;
    const exec::Buffer<std::int32_t> on_device = to_device(ex_, sets);
    const exec::Buffer<std::uint64_t> sums = zeros(ex_, kSums * static_cast<std::int64_t>(count));
    for_each(ex_, "normals.measure", signs.size,
             signs::MeasureSets{trial.view(), lines_.positions, lines_.normals, trial.areas(), signs,
                                patches_.labels.cview(), on_device.cview(), sums.data()});
    const std::vector<std::uint64_t> all = to_host(ex_, sums);
    std::vector<SetSums> out(count);
    for (std::size_t s = 0; s < count; ++s)
      out[s] = {signs::from_fixed_point(all[kSums * s]), signs::from_fixed_point(all[kSums * s + 1]),
                signs::from_fixed_point(all[kSums * s + 2])};
    return out;
  }

  /// The largest patches, by how their fields act on each other, if there are several.
  void judge_patches(TrialField<Exec>& trial) {
    const std::vector<std::size_t> large = largest_patches();
    sets_ = DisjointSets(patch_signs_.size());
    unite_components();
    if (large.size() < 2 || std::all_of(large.begin(), large.end(), [&](std::size_t c) { return fixed_[c]; })) return;
    std::vector<std::int32_t> sets(patch_signs_.size(), -1);
    for (std::size_t a = 0; a < large.size(); ++a) sets[large[a]] = static_cast<std::int32_t>(a);
    Couplings couplings{large.size(), std::vector<double>(large.size() * large.size())};
    std::vector<double> fields(large.size() * large.size());
    std::vector<double> areas(large.size());
    auto all = exec::make_buffer<std::int32_t>(ex_, signs_.size());
    for_each(ex_, "normals.compose", signs_.size(), with_signs(std::vector<int>(patch_signs_.size(), 1), all));
    for (std::size_t a = 0; a < large.size(); ++a) {
      if (!may_solve()) return;
      std::vector<int> alone(patch_signs_.size(), 0);
      alone[large[a]] = 1;
      compose(alone);
      trial.solve(signs_.cview());
      const std::vector<SetSums> sums = measure(trial, all.cview(), sets, large.size());
      for (std::size_t b = 0; b < large.size(); ++b) {
        couplings.values[a * large.size() + b] = sums[b].along;
        fields[a * large.size() + b] = sums[b].field;
        areas[b] = sums[b].area;
      }
    }
    apply(couplings, large);
    choose_sides_of(large, couplings, fields, areas);
  }

  /// Patches that their fields hold together, by where their fields put each other. Those that only doubtful links
  /// join are tied, not held: the sheets of a thin wall meet at its rims alone.
  void choose_sides_of(const std::vector<std::size_t>& large, const Couplings& couplings,
                       const std::vector<double>& fields, const std::vector<double>& areas) {
    constexpr double kHolds = 0.1;  // of what the smaller does to itself
    constexpr double kTies = 0.05;  // of the smaller's area; a side that is clear costs or saves 1
    const std::size_t n = large.size();
    DisjointSets held(n);
    for (std::size_t a = 0; a < n; ++a)
      for (std::size_t b = 0; b < a; ++b)
        if (std::abs(couplings.relative(a, b)) >= kHolds) held.unite(a, b);
    const DisjointSets::Numbers sets = held.numbers();
    const auto set_of = [&](std::size_t a) { return static_cast<std::size_t>(sets.of[a]); };
    Sides sides(sets.count);
    std::vector<bool> fixed(sets.count, false);
    for (std::size_t a = 0; a < n; ++a) {
      sides.areas[set_of(a)] += areas[a];
      if (fixed_[large[a]]) fixed[set_of(a)] = true;
      for (std::size_t b = 0; b < n; ++b) {
        sides.means[set_of(a) * sets.count + set_of(b)] += patch_signs_[large[a]] * fields[a * n + b];
        if (components_[large[a]] == components_[large[b]] && set_of(a) > set_of(b))
          sides.ties[set_of(a) * sets.count + set_of(b)] += kTies * std::min(areas[a], areas[b]);
      }
    }
    for (std::size_t a = 0; a < sets.count; ++a)
      for (std::size_t b = 0; b < sets.count; ++b) sides.means[a * sets.count + b] /= std::max(sides.areas[b], 1e-9);
    std::vector<int> turned(sets.count, 1);
    choose_sides(sides, fixed, turned);
    for (std::size_t c = 0; c < patch_signs_.size(); ++c) {
      const std::size_t at = judged_like(c, large);
      if (at < n && !fixed_[c]) patch_signs_[c] *= turned[set_of(at)];
    }
    report_.turned += std::count(turned.begin(), turned.end(), -1);
  }

  /// Where patch c is among the judged ones, or else the largest that it hangs together with; their number if none.
  [[nodiscard]] std::size_t judged_like(std::size_t c, const std::vector<std::size_t>& large) const {
    auto at = std::find(large.begin(), large.end(), c);
    if (at == large.end())
      at = std::find_if(large.begin(), large.end(), [&](std::size_t a) { return sets_.root(a) == sets_.root(c); });
    return static_cast<std::size_t>(at - large.begin());
  }

  signs::ComposeSigns with_signs(const std::vector<int>& patch_signs, exec::Buffer<std::int32_t>& out) {
    kept_signs_ = to_device(ex_, std::vector<std::int32_t>(patch_signs.begin(), patch_signs.end()));
    return {patches_.labels.cview(), patches_.signs.cview(), kept_signs_.cview(), out.view()};
  }

  std::vector<std::size_t> largest_patches() const {
    std::vector<std::size_t> order(sizes_.size());
    std::iota(order.begin(), order.end(), std::size_t{0});
    std::stable_sort(order.begin(), order.end(), [&](std::size_t a, std::size_t b) { return sizes_[a] > sizes_[b]; });
    const auto least = static_cast<std::uint64_t>(std::max<std::int64_t>(32, lines_.positions.size / 2000));
    std::size_t count = 0;
    while (count < std::min(order.size(), kJudgedPatches) && sizes_[order[count]] >= least) ++count;
    order.resize(count);
    return order;
  }

  void apply(const Couplings& couplings, const std::vector<std::size_t>& large) {
    std::vector<int> chosen;
    std::vector<bool> fixed;
    for (const std::size_t c : large) {
      chosen.push_back(patch_signs_[c]);
      fixed.push_back(fixed_[c]);
    }
    choose_signs(couplings, fixed, chosen);
    for (std::size_t a = 0; a < large.size(); ++a) {
      if (patch_signs_[large[a]] != chosen[a]) ++report_.turned;
      patch_signs_[large[a]] = chosen[a];
      for (std::size_t b = 0; b < a; ++b)
        if (couplings.relative(a, b) != 0) sets_.unite(large[a], large[b]);
    }
  }

  void unite_components() {
    std::vector<std::size_t> first(patch_signs_.size(), patch_signs_.size());
    for (std::size_t c = 0; c < patch_signs_.size(); ++c) {
      std::size_t& of = first[static_cast<std::size_t>(components_[c])];
      of = std::min(of, c);
      sets_.unite(of, c);
    }
  }

  /// Turns whole sets whose samples are at -1/2 or 3/2 instead of 1/2. From the outermost ones inwards: what they
  /// enclose changes with them.
  void judge_sides(TrialField<Exec>& trial) {
    constexpr int kRounds = 6;
    constexpr double kInsideOut = -0.3;  // -1/2 on a closed surface; nearer to 0 the scan is open, and may be a room
    const DisjointSets::Numbers sets = sets_.numbers();
    const auto set_of = [&](std::size_t c) { return static_cast<std::size_t>(sets.of[c]); };
    std::vector<bool> fixed(sets.count, false);
    for (std::size_t c = 0; c < sets.of.size(); ++c)
      if (fixed_[c]) fixed[set_of(c)] = true;
    std::vector<int> turns(sets.count, 0);
    for (int round = 0; round < kRounds && may_solve(); ++round) {
      compose(patch_signs_);
      trial.solve(signs_.cview());
      const std::vector<SetSums> sums = measure(trial, signs_.cview(), sets.of, sets.count);
      SetSums total;
      std::vector<bool> turn(sets.count, false);
      bool any = false;
      for (std::size_t r = 0; r < sets.count; ++r) {
        total.area += sums[r].area;
        total.field += sums[r].field;
        turn[r] = turns[r] < 2 && (fixed[r] ? evidence_.may_be_inside_out && sums[r].mean() < kInsideOut
                                            : sums[r].mean() < -0.01 || sums[r].mean() > 1);
        if (turn[r]) ++turns[r];
        any = any || turn[r];
      }
      report_.enclosing = total.mean();
      if (!any) return;
      for (std::size_t c = 0; c < sets.of.size(); ++c)
        if (turn[set_of(c)]) patch_signs_[c] = -patch_signs_[c];
      report_.turned += std::count(turn.begin(), turn.end(), true);
    }
  }

  /// iPSR: signs follow the field until they stay; then every patch takes what most of its samples say.
  void iterate(TrialField<Exec>& trial) {
    constexpr int kRounds = 25;
    if (options_.random_start)
      for_each(ex_, "normals.random", signs_.size(), signs::RandomSigns{options_.seed, signs_.view()});
    follow_field(trial, kRounds);
    const std::vector<Votes> votes = votes_of_patches(signs_.cview());
    for (std::size_t c = 0; c < votes.size(); ++c)
      if (votes[c].decide(0.1) && !fixed_[c]) patch_signs_[c] = votes[c].net < 0 ? -1 : 1;
  }

  void follow_field(TrialField<Exec>& trial, int rounds) {
    auto changed = exec::make_buffer<std::int32_t>(ex_, signs_.size());
    for (int round = 0; round < rounds && may_solve(); ++round) {
      trial.solve(signs_.cview());
      for_each(ex_, "normals.follow", signs_.size(),
               signs::FollowField{trial.view(), lines_.positions, lines_.normals, signs_.view(), changed.view()});
      if (is_settled(changed)) break;
    }
  }

  bool is_settled(const exec::Buffer<std::int32_t>& changed) {
    const std::int64_t count = exec::sum_counts(ex_, "normals.changed", changed.cview());
    return static_cast<double>(count) <= kSettled * static_cast<double>(changed.size());
  }

  /// Single samples that neighbours and field contradict; confidence.
  void clean_up(TrialField<Exec>& trial) {
    constexpr int kRounds = 3;
    const std::int64_t n = signs_.size();
    auto agreement = exec::make_buffer<float>(ex_, n);
    auto changed = exec::make_buffer<std::int32_t>(ex_, n);
    for (int round = 0; round < kRounds; ++round) {
      trial.solve(signs_.cview());
      measure_agreement(ex_, lines_, signs_.cview(), agreement.view());
      for_each(ex_, "normals.clean", n,
               signs::CleanUp{trial.view(), lines_.positions, lines_.normals, agreement.cview(), signs_.view(),
                              changed.view()});
      if (is_settled(changed) || !may_solve()) break;
    }
  }

  void settle_confidence(TrialField<Exec>& trial) {
    const std::int64_t n = signs_.size();
    auto agreement = exec::make_buffer<float>(ex_, n);
    measure_agreement(ex_, lines_, signs_.cview(), agreement.view());
    const double sides = options_.method == NormalMethod::sensor || options_.method == NormalMethod::repair
                             ? 1.0
                             : std::clamp(5 * std::abs(report_.enclosing), 0.5, 1.0);
    confidence_ = exec::make_buffer<float>(ex_, n);
    for_each(ex_, "normals.confidence", n,
             signs::Confidence{trial.view(), lines_.positions, lines_.normals, agreement.cview(), lines_.flatness,
                               signs_.cview(), static_cast<float>(sides), confidence_.view()});
  }

  Exec& ex_;
  LinkedLines lines_;
  const octree::OctreeData& tree_;
  Evidence evidence_;
  const NormalOptions& options_;
  NormalReport& report_;
  Stopwatch watch_;

  SignPatches patches_;
  std::vector<std::int32_t> components_;  // of patches
  std::vector<int> patch_signs_;
  std::vector<std::uint64_t> sizes_;
  std::vector<bool> fixed_;  // patches whose sign the input decides
  DisjointSets sets_;        // patches whose signs hang together: all of a set are turned at once
  exec::Buffer<std::int32_t> kept_signs_;
  exec::Buffer<std::int32_t> signs_;
  exec::Buffer<float> confidence_;
};

}  // namespace pointskin::normals
