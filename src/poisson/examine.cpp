#include "poisson/examine.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "exec/atomic.hpp"
#include "exec/this_space.hpp"
#include "poisson/examine_sample.hpp"
#include "poisson/in_blocks.hpp"

namespace pointskin::poisson {
namespace {

constexpr const char* kLabel = "density.examine";

/// Words that are counted in, all in one buffer. The lonely samples are the first: `Samples` keeps the buffer for it.
enum Word : int { kLonelyOnes, kTallies, kDensity, kPairs, kWords = kPairs + NoiseBin::kCount };

/// Three counts of at most kLookedAt in one word, so that one atomic addition does for all.
struct Tally {
  static constexpr int kBits = 20;
  static_assert(kLookedAt < std::int64_t{1} << kBits);

  std::uint64_t asked, alike, on_lines;

  PSK_HD static Tally of(std::uint64_t word) {
    constexpr std::uint64_t kMask = (std::uint64_t{1} << kBits) - 1;
    return {word & kMask, word >> kBits & kMask, word >> 2 * kBits};
  }
  [[nodiscard]] PSK_HD std::uint64_t word() const { return asked | alike << kBits | on_lines << 2 * kBits; }
};

/// Densities add up in fixed point, in any order the same: in samples per face of the unit cube, over the number of all
/// samples.
constexpr float kFixed = 65536;
constexpr float kDensest = 17'179'869'184.0F;  // 2^34: of kLookedAt samples the sum is below 2^63

/// What a few of the samples that are looked at add.
struct LookedAt {
  std::uint64_t tally = 0, density = 0;
  PSK_HD LookedAt operator+(const LookedAt& other) const { return {tally + other.tally, density + other.density}; }
};

/// By lanes, whose sums are added to the words at once.
struct LookAt {
  static constexpr int kLanes = 32;
  using Sum = LookedAt;

  Around around;
  std::int64_t looked_at;
  float cell_area;  // of a finest cell's face
  ArrayView<const float> own_side, areas;
  std::uint64_t* words;

  [[nodiscard]] PSK_HD LookedAt part(std::int64_t group, int lane) const {
    const std::int64_t s = group * kLanes + lane;
    return s < looked_at ? look_at(s * around.positions.size / looked_at) : LookedAt{};
  }
  PSK_HD void finish(std::int64_t /*group*/, const LookedAt& sum) const {
    exec::add(words + kDensity, sum.density);
    exec::add(words + kTallies, sum.tally);
  }

  [[nodiscard]] PSK_HD LookedAt look_at(std::int64_t i) const {
    const std::int64_t n = around.positions.size;
    const float density = 1 / (std::abs(own_side[i]) * cell_area * static_cast<float>(n));
    const Seen seen = around.seen_from(i);
    Tally tally{seen.can_tell(), seen.can_tell() && seen.faces_like_others(), 0};
    if (i + Followed::kFourth < n) {
      const Followed followed(around.positions, around.normals, i, areas[i] * cell_area);
      if (followed.on_line) tally.on_lines = 1;
      if (followed.is_pair) exec::add(words + kPairs + NoiseBin::of(followed.noise2), 1);
    }
    return {tally.word(), static_cast<std::uint64_t>(kFixed * (density < kDensest ? density : kDensest))};
  }
};

/// The same of a part of the cloud.
struct LookAtPart {
  static constexpr int kLanes = LookAt::kLanes;
  using Sum = LookedAt;

  LookAt look;  // of what is there
  PartOfCloud own;

  [[nodiscard]] PSK_HD LookedAt part(std::int64_t group, int lane) const {
    const std::int64_t s = group * kLanes + lane;
    const std::int64_t i = s * own.all / look.looked_at - own.first;
    if (s >= look.looked_at || i < 0 || i >= own.count) return {};
    LookedAt seen = look.look_at(own.before + i);
    // LookAt knows no samples but those that are there.
    const float density = 1 / (std::abs(look.own_side[own.before + i]) * look.cell_area * static_cast<float>(own.all));
    seen.density = static_cast<std::uint64_t>(kFixed * (density < kDensest ? density : kDensest));
    return seen;
  }
  PSK_HD void finish(std::int64_t group, const LookedAt& sum) const { look.finish(group, sum); }
};

/// A part's own samples.
struct ExaminePart {
  Examine examine;
  std::int64_t before;
  PSK_HD void operator()(std::int64_t i) const { examine(before + i); }
};

/// One thread.
struct Judge {
  const std::uint64_t* words;
  std::int64_t points, looked_at;
  float cell_area;
  ArrayView<Cloudwide> found;

  PSK_HD void operator()(std::int64_t /*i*/) const {
    const auto looked = static_cast<float>(looked_at);
    const float density = static_cast<float>(words[kDensity]) / kFixed / looked;
    const float usual = 1 / (density * cell_area * static_cast<float>(points));
    const Tally tally = Tally::of(words[kTallies]);
    const auto asked = static_cast<float>(tally.asked);
    found[0] = {averaging_for(words + kPairs, static_cast<float>(tally.on_lines) / looked), kUnusualArea * usual,
                asked >= kTelling * looked && static_cast<float>(tally.alike) >= kMostlyAlike * asked};
  }
};

/// A GPU has a kernel of its own for it (examine_kernel.cuh).
template <exec::Space Exec>
requires(!Exec::kOwnKernels) void examine_each(Exec& ex, const char* label, std::int64_t n, const Examine& examine) {
  for_each(ex, label, n, examine);
}

}  // namespace

template <exec::Space Exec>
void examine_samples(Exec& ex, int depth, int coarsest, exec::Buffer<float> own_side, exec::Buffer<float> bends,
                     Samples& samples) {
  const std::int64_t n = samples.areas.size();
  const Around around{samples.positions.cview(), samples.normals.cview(), samples.splat_depths.cview()};
  const std::int64_t looked_at = std::min(kLookedAt, n);
  const float cell_area = 1 / static_cast<float>(std::int64_t{1} << 2 * depth);
  samples.lonely = exec::make_buffer<std::uint64_t>(ex, kWords);
  exec::fill(ex, samples.lonely.view(), std::uint64_t{0});
  for_each_by_lanes(
      ex, kLabel, (looked_at + LookAt::kLanes - 1) / LookAt::kLanes,
      LookAt{around, looked_at, cell_area, own_side.cview(), samples.areas.cview(), samples.lonely.data()});
  auto found = exec::make_buffer<Cloudwide>(ex, 1);
  for_each(ex, kLabel, 1, Judge{samples.lonely.data(), n, looked_at, cell_area, found.view()});
  examine_each(ex, kLabel, n,
               Examine{around, found.cview(), cell_area, static_cast<float>(coarsest), static_cast<float>(depth),
                       samples.areas.view(), bends.view(), own_side.view(), samples.lonely.data() + kLonelyOnes});
  samples.splat_depths = std::move(own_side);
  samples.trust = std::move(bends);
}

template <exec::Space Exec>
LookAtCloud look_at_part(Exec& ex, int depth, const PartOfCloud& part, ArrayView<const float> own_side,
                         const Samples& samples) {
  const std::int64_t looked_at = std::min(kLookedAt, part.all);
  const float cell_area = 1 / static_cast<float>(std::int64_t{1} << 2 * depth);
  const Around around{samples.positions.cview(), samples.normals.cview(), samples.splat_depths.cview()};
  auto words = exec::make_buffer<std::uint64_t>(ex, kWords);
  exec::fill(ex, words.view(), std::uint64_t{0});
  const LookAt look{around, looked_at, cell_area, own_side, samples.areas.cview(), words.data()};
  for_each_by_lanes(ex, kLabel, (looked_at + LookAt::kLanes - 1) / LookAt::kLanes, LookAtPart{look, part});
  LookAtCloud result;
  result.words.resize(kWords);
  copy_to_host(ex, words.cview(), result.words.data());
  return result;
}

template <exec::Space Exec>
void examine_part(Exec& ex, int depth, int coarsest, const PartOfCloud& part, const LookAtCloud& look,
                  exec::Buffer<float> own_side, exec::Buffer<float> bends, Samples& samples) {
  const std::int64_t looked_at = std::min(kLookedAt, part.all);
  const Around around{samples.positions.cview(), samples.normals.cview(), samples.splat_depths.cview()};
  const float cell_area = 1 / static_cast<float>(std::int64_t{1} << 2 * depth);
  samples.lonely = exec::make_buffer<std::uint64_t>(ex, kWords);
  copy_to_device(ex, look.words.data(), samples.lonely.view());
  auto found = exec::make_buffer<Cloudwide>(ex, 1);
  for_each(ex, kLabel, 1, Judge{samples.lonely.data(), part.all, looked_at, cell_area, found.view()});
  for_each(ex, kLabel, part.count,
           ExaminePart{{around, found.cview(), cell_area, static_cast<float>(coarsest), static_cast<float>(depth),
                        samples.areas.view(), bends.view(), own_side.view(), samples.lonely.data() + kLonelyOnes},
                       part.before});
  samples.splat_depths = std::move(own_side);
  samples.trust = std::move(bends);
}

PSK_INSTANTIATE(examine_samples);
PSK_INSTANTIATE(look_at_part);
PSK_INSTANTIATE(examine_part);

}  // namespace pointskin::poisson
