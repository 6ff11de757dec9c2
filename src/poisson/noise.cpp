#include "poisson/noise.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include "exec/algorithms.hpp"
#include "exec/atomic.hpp"
#include "exec/this_space.hpp"

namespace pointskin::poisson {
namespace {

constexpr const char* kLabel = "density.noise";

/// Bins of noise^2, by exponent and two bits more: the same on every device, without a logarithm.
struct Bin {
  static constexpr int kCount = 96;
  static constexpr int kFirst = (127 - 20) * 4;  // 2^-20

  PSK_HD static int of(float value) {
    const int bin = static_cast<int>(std::bit_cast<std::uint32_t>(value) >> 21) - kFirst;
    return bin < 0 ? 0 : bin < kCount ? bin : kCount - 1;
  }
  /// The lower end of a bin.
  PSK_HD static float value(int bin) { return std::bit_cast<float>(static_cast<std::uint32_t>(bin + kFirst) << 21); }
};

/// Words that are counted in: pairs by their noise, and samples on lines.
constexpr int kOnLines = Bin::kCount;
constexpr int kWords = kOnLines + 1;

struct CountPairs {
  static constexpr int kFourth = 4;

  octree::OctreeView tree;
  DensityView density;
  ArrayView<const Vec3f> positions, normals;
  std::int64_t looked_at;
  std::uint64_t* words;

  PSK_HD void operator()(std::int64_t s) const {
    const std::int64_t i = s * positions.size / looked_at;
    if (i + kFourth >= positions.size) return;
    const Vec3f step = positions[i] - positions[i + 1];
    const float distance2 = squared_length(step);
    if (squared_length(positions[i] - positions[i + kFourth]) > kAlongLines * distance2) exec::add(words + kOnLines, 1);
    if (!(dot(normals[i], normals[i + 1]) > 0.9F)) return;
    const auto cells = static_cast<float>(std::int64_t{1} << tree.depth);
    const float per_area = density.samples_per_cell(tree, positions[i]) * cells * cells;
    const float across = 0.5F * dot(normals[i] + normals[i + 1], step);
    const float along2 = distance2 - across * across;
    if (along2 * per_area < kNear * kNear) exec::add(words + Bin::of(0.5F * (across * across) * per_area), 1);
  }
};

PSK_HD float ramp(float x, float from, float to) {
  const float t = (x - from) / (to - from);
  return t < 0 ? 0.0F : t > 1 ? 1.0F : t;
}

/// What the splat depths of a cloud may rise and do fall by.
struct Shift {
  float finer, coarser;
};

/// One thread.
struct FindShift {
  const std::uint64_t* words;
  float looked_at;
  ArrayView<Shift> shift;

  PSK_HD void operator()(std::int64_t /*i*/) const {
    const float lines = static_cast<float>(words[kOnLines]) / looked_at;
    const float noise = median_noise();
    shift[0] = {kFiner * (1 - ramp(noise, kClean, kSomeNoise)) * (1 - ramp(lines, kNoLines, kLines)),
                kCoarser * ramp(noise, kMuchNoise, kTooMuchNoise)};
  }

  /// That of a cloud that does not get finer or coarser, if no pair tells.
  [[nodiscard]] PSK_HD float median_noise() const {
    constexpr float kOfGaussian = 0.674F;  // the median of |x|
    std::uint64_t pairs = 0;
    for (int bin = 0; bin < Bin::kCount; ++bin) pairs += words[bin];
    if (pairs == 0) return kSomeNoise;
    const float half = 0.5F * static_cast<float>(pairs);
    float before = 0;
    int bin = 0;
    while (bin + 1 < Bin::kCount && before + static_cast<float>(words[bin]) < half)
      before += static_cast<float>(words[bin++]);
    const float within = (half - before) / static_cast<float>(words[bin] > 0 ? words[bin] : 1);
    const float lower = bin > 0 ? Bin::value(bin) : 0.0F;
    return std::sqrt(lower + within * (Bin::value(bin + 1) - lower)) / kOfGaussian;
  }
};

struct ShiftDepth {
  ArrayView<const Shift> shift;
  ArrayView<const Vec3f> positions, normals;
  ArrayView<const float> areas;
  float cell, coarsest;  // the finest cells' width; a depth
  ArrayView<float> splat_depths;

  PSK_HD void operator()(std::int64_t i) const {
    const float finer = shift[0].finer > 0 && is_bent(i) ? shift[0].finer : 0.0F;
    const float depth = splat_depths[i] + finer - shift[0].coarser;
    splat_depths[i] = depth > coarsest ? depth : coarsest;
  }

  [[nodiscard]] PSK_HD bool is_bent(std::int64_t i) const {
    const float near2 = kNear * kNear * areas[i] * cell * cell;
    for (std::int64_t j = i > kFollowers ? i - kFollowers : 0; j <= i + kFollowers && j < positions.size; ++j)
      if (dot(normals[i], normals[j]) < kBentCosine && squared_length(positions[i] - positions[j]) < near2) return true;
    return false;
  }
};

}  // namespace

template <exec::Space Exec>
void adapt_to_noise(Exec& ex, const octree::OctreeData& tree, const Density& density, int coarsest, Samples& samples) {
  const std::int64_t n = samples.positions.size();
  const std::int64_t looked_at = std::min(kNoiseSamples, n);
  auto words = exec::make_buffer<std::uint64_t>(ex, kWords);
  exec::fill(ex, words.view(), std::uint64_t{0});
  for_each(ex, kLabel, looked_at,
           CountPairs{tree.view(),
                      {density.depth, density.counts.data()},
                      samples.positions.cview(),
                      samples.normals.cview(),
                      looked_at,
                      words.data()});
  auto shift = exec::make_buffer<Shift>(ex, 1);
  for_each(ex, kLabel, 1, FindShift{words.data(), static_cast<float>(looked_at), shift.view()});
  for_each(ex, kLabel, n,
           ShiftDepth{shift.cview(), samples.positions.cview(), samples.normals.cview(), samples.areas.cview(),
                      1.0F / static_cast<float>(std::int64_t{1} << tree.depth), static_cast<float>(coarsest),
                      samples.splat_depths.view()});
}

PSK_INSTANTIATE(adapt_to_noise);

}  // namespace pointskin::poisson
