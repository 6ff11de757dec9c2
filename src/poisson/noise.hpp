// How many samples a normal is averaged over, and so how coarse a level carries it. Averaged over few, noise stays; averaged over
// many, the shape goes where it bends. Both are measured: noise for the whole cloud, here, and bends at every sample
// (bend.hpp).
#pragma once

#include <pointskin/vector.hpp>

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/array_view.hpp"
#include "core/host_device.hpp"

namespace pointskin::poisson {

/// Noise is the standard deviation of a sample across the surface over the distance between samples. A normal is averaged over
///   kSmoothing sqrt(noise^2 / bend)   samples, but not over less than
///   kUsual min(1, kSharp / bend)      of clean ones, and in all over kFinest + kPerNoise (noise - kClean) to kMost
/// (docs/decisions/0048-averaging-by-noise-and-bend.md).
inline constexpr float kSmoothing = 1.4F, kSharp = 0.036F, kClean = 0.03F;
inline constexpr float kUsual = 1.5F, kFinest = 0.22F, kPerNoise = 4, kMost = 8;

/// Where few samples are averaged, the shape bends more than noise hides; where many are, noise hides the shape. Positions are
/// trusted by kUrgent over the number of samples, at most kMostUrge times (trust.hpp).
inline constexpr float kUrgent = 2, kMostUrge = 3, kSurelyBeyond = 0.25F;

/// On scan lines the fourth sample after one is often more than sqrt(kAlongLines) = 3.5 times as far away as the next:
/// for half of the samples, but for one in three where they are spread over the surface. Density then says nothing of
/// the distance between lines, and a normal is averaged over kUsual samples at least. Shares in between: linear.
inline constexpr float kAlongLines = 12;
inline constexpr float kNoLines = 0.38F, kLines = 0.46F;

/// A pair of samples tells of the noise if they are nearer along the surface than kNear distances between samples.
inline constexpr float kNear = 2;

/// Bins of noise^2, by exponent and two bits more: the same on every device, without a logarithm.
struct NoiseBin {
  static constexpr int kCount = 96;
  static constexpr int kFirst = (127 - 20) * 4;  // 2^-20

  PSK_HD static int of(float value) {
    const int bin = static_cast<int>(std::bit_cast<std::uint32_t>(value) >> 21) - kFirst;
    return bin < 0 ? 0 : bin < kCount ? bin : kCount - 1;
  }
  /// The lower end of a bin.
  PSK_HD static float value(int bin) { return std::bit_cast<float>(static_cast<std::uint32_t>(bin + kFirst) << 21); }
};

/// What a sample and those that follow it say of the noise.
struct Followed {
  static constexpr std::int64_t kFourth = 4;

  bool on_line = false;
  bool is_pair = false;  ///< the normals agree, and the next sample is near along the surface
  float noise2 = 0;      ///< of the pair: ((n + m) / 2 . (p - q))^2 / 2 over the area of a sample

  /// @param i     such that kFourth samples follow
  /// @param area  that the samples around stand for, of the unit cube
  PSK_HD Followed(ArrayView<const Vec3f> positions, ArrayView<const Vec3f> normals, std::int64_t i, float area) {
    const Vec3f step = positions[i] - positions[i + 1];
    const float distance2 = squared_length(step);
    on_line = squared_length(positions[i] - positions[i + kFourth]) > kAlongLines * distance2;
    if (!(dot(normals[i], normals[i + 1]) > 0.9F)) return;
    const float across = 0.5F * dot(normals[i] + normals[i + 1], step);
    is_pair = distance2 - across * across < kNear * kNear * area;
    noise2 = 0.5F * (across * across) / area;
  }
};

PSK_HD inline float ramp(float x, float from, float to) {
  const float t = (x - from) / (to - from);
  return t < 0 ? 0.0F : t > 1 ? 1.0F : t;
}

/// The logarithm to the base of 2 of a positive float, linear between powers of 2 and so up to 0.09 too small: the same on every
/// device.
PSK_HD inline float rough_log2(float x) { return static_cast<float>(std::bit_cast<std::int32_t>(x)) * 0x1p-23F - 127; }

/// How a cloud is averaged.
struct Averaging {
  float noise2 = 0;       ///< squared noise
  float fewest = kUsual;  ///< samples

  /// Samples that a normal is averaged over, in [kFinest, kMost]. For Options::samples_per_node of kUsual.
  /// @param bend  bend.hpp
  [[nodiscard]] PSK_HD float samples(float bend) const {
    constexpr float kFlat = 1e-4F;
    const float least_bend = bend > kFlat ? bend : kFlat;
    const float by_noise = kSmoothing * std::sqrt(noise2 / least_bend);
    const float if_clean = least_bend > kSharp ? kUsual * kSharp / least_bend : kUsual;
    const float most = by_noise > if_clean ? by_noise : if_clean;
    return most < fewest ? fewest : most > kMost ? kMost : most;
  }

  /// Levels that a normal is splatted finer at for that: four times the samples are under the kernel of the next coarser one.
  PSK_HD static float levels_finer(float samples) { return 0.5F * rough_log2(kUsual / samples); }

  /// @param beyond  levels that the normal would be splatted beyond the finest one, which averages over more samples: nothing is
  ///                left to noise then
  PSK_HD static float urge(float samples, float beyond) {
    const float urge = kUrgent / samples;
    if (urge < 1) return urge + ramp(beyond, 0, kSurelyBeyond) * (1 - urge);
    return urge > kMostUrge ? kMostUrge : urge;
  }
};

/// How the whole cloud is averaged. Over the pairs (p, n), (q, m) of a sample and the next one, if the
/// normals agree and the two are near each other along the surface,
///   noise^2 = median of ((n + m) / 2 . (p - q))^2 / (2 area_p) / 0.674^2,   area_p = 1 / density, 0.674^2 of a Gaussian;
/// an evenly bent surface adds nothing to it (trust.hpp), and sharp edges are too few to move a median. If no pair tells,
/// it is as if there were some noise.
/// @param pairs  shape (NoiseBin::kCount), numbers of pairs
/// @param lines  share of the samples that lie on lines
PSK_HD inline Averaging averaging_for(const std::uint64_t* pairs, float lines) {
  constexpr float kOfGaussian = 0.674F;    // the median of |x|
  std::uint32_t counts[NoiseBin::kCount];  // in registers: a read that waits for the one before takes longer
  std::uint32_t all = 0;
  PSK_UNROLL
  for (int bin = 0; bin < NoiseBin::kCount; ++bin) {
    counts[bin] = static_cast<std::uint32_t>(pairs[bin]);
    all += counts[bin];
  }
  if (all == 0) return {};
  int median = 0;  // the bin that half of the pairs end in
  std::uint32_t in_it = 0;
  std::uint32_t before = 0;
  std::uint32_t sum = 0;
  PSK_UNROLL
  for (int bin = 0; bin < NoiseBin::kCount; ++bin) {
    if (2 * sum < all && counts[bin] > 0) {
      median = bin;
      in_it = counts[bin];
      before = sum;
    }
    sum += counts[bin];
  }
  const float within = (0.5F * static_cast<float>(all) - static_cast<float>(before)) / static_cast<float>(in_it);
  const float lower = median > 0 ? NoiseBin::value(median) : 0.0F;
  const float noise = std::sqrt(lower + within * (NoiseBin::value(median + 1) - lower)) / kOfGaussian;
  const float fewest = kFinest + kPerNoise * (noise > kClean ? noise - kClean : 0.0F);
  const float on_lines = ramp(lines, kNoLines, kLines);
  return {noise * noise, fewest < kUsual ? fewest + on_lines * (kUsual - fewest) : fewest};
}

}  // namespace pointskin::poisson
