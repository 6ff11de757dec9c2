#include "poisson/examine.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <utility>

#include "exec/atomic.hpp"
#include "exec/this_space.hpp"
#include "poisson/bend.hpp"
#include "poisson/noise.hpp"
#include "poisson/outliers.hpp"

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

struct LookAt {
  Around around;
  std::int64_t looked_at;
  float cell_area;  // of a finest cell's face
  ArrayView<const float> own_side, areas;
  std::uint64_t* words;

  PSK_HD void operator()(std::int64_t s) const {
    const std::int64_t n = around.positions.size;
    const std::int64_t i = s * n / looked_at;
    const float density = 1 / (std::abs(own_side[i]) * cell_area * static_cast<float>(n));
    exec::add(words + kDensity, static_cast<std::uint64_t>(kFixed * (density < kDensest ? density : kDensest)));
    const Seen seen = around.seen_from(i);
    Tally tally{seen.can_tell(), seen.can_tell() && seen.faces_like_others(), 0};
    if (i + Followed::kFourth < n) {
      const Followed followed(around.positions, around.normals, i, areas[i] * cell_area);
      if (followed.on_line) tally.on_lines = 1;
      if (followed.is_pair) exec::add(words + kPairs + NoiseBin::of(followed.noise2), 1);
    }
    exec::add(words + kTallies, tally.word());
  }
};

/// What a look at the whole cloud says.
struct Cloudwide {
  Averaging averaging{};
  float largest_usual_area = 0;  ///< finest cells^2
  bool is_alike = false;         ///< neighbours mostly face the same way, as far as can be told
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

struct Examine {
  Around around;
  ArrayView<const Cloudwide> found;
  float cell_area, coarsest, finest;
  ArrayView<float> areas;
  ArrayView<float> bends_to_urges;
  ArrayView<float> own_side_to_depths;  // read, then written: others still look at the depths that were
  std::uint64_t* lonely;

  PSK_HD void operator()(std::int64_t i) const {
    const Cloudwide cloud = found[0];
    const bool disagrees = own_side_to_depths[i] < 0;
    const float own = std::abs(own_side_to_depths[i]);
    const float largest = cloud.largest_usual_area;
    const bool is_usual = !(own > largest);
    if (own > kLonely * largest) exec::add(lonely, 1);
    Seen seen;
    BendAmongNeighbours bend;
    const float per_sample = 1 / (own * cell_area);
    around(i, [&](std::int64_t /*j*/, const Vec3f& normal, const Vec3f& step) {
      const float cosine = dot(around.normals[i], normal);
      seen.add(cosine, normal, step);
      bend.add(cosine, squared_length(step) * per_sample);
    });
    float area = own;
    if ((!is_usual && !Around::is_confirmed(around, i)) || is_outlier_near_others(i, seen, disagrees, cloud.is_alike)) {
      area = 0;
    } else if (!is_usual) {
      area = areas[i] < largest ? largest : areas[i];
    }
    areas[i] = area;
    float depth = around.splat_depths[i];
    float urge = 1;
    if (area > 0) {
      const float near = bend.value();
      const float samples = cloud.averaging.samples(near > bends_to_urges[i] ? near : bends_to_urges[i]);
      depth += Averaging::levels_finer(samples);
      urge = Averaging::urge(samples, depth - finest);
    }
    bends_to_urges[i] = urge;
    own_side_to_depths[i] = depth > coarsest ? depth : coarsest;
  }

  [[nodiscard]] PSK_HD bool faces_like_others(std::int64_t i, const Seen& seen) const {
    return seen.faces_like_others() && (seen.surely_does() || Around::is_among_such(around, i));
  }

  [[nodiscard]] PSK_HD bool is_outlier_near_others(std::int64_t i, const Seen& seen, bool disagrees,
                                                   bool is_alike) const {
    if (seen.stands_off(areas[i] * cell_area)) return true;
    return is_alike && ((seen.can_tell() && !faces_like_others(i, seen)) || (disagrees && seen.none_faces_it()));
  }
};

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
  for_each(ex, kLabel, looked_at,
           LookAt{around, looked_at, cell_area, own_side.cview(), samples.areas.cview(), samples.lonely.data()});
  auto found = exec::make_buffer<Cloudwide>(ex, 1);
  for_each(ex, kLabel, 1, Judge{samples.lonely.data(), n, looked_at, cell_area, found.view()});
  for_each(ex, kLabel, n,
           Examine{around, found.cview(), cell_area, static_cast<float>(coarsest), static_cast<float>(depth),
                   samples.areas.view(), bends.view(), own_side.view(), samples.lonely.data() + kLonelyOnes});
  samples.splat_depths = std::move(own_side);
  samples.trust = std::move(bends);
}

PSK_INSTANTIATE(examine_samples);

}  // namespace pointskin::poisson
