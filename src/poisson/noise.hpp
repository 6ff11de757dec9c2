// How noisy the samples are, against the distance between them, and so how coarse a level has to carry their normals.
// Clean samples say where the surface is by themselves: averaged over as many as noisy ones need, sparse clouds lose
// their shape. Where noise is half as wide as the distance between samples, it takes more of them.
#pragma once

#include <pointskin/vector.hpp>

#include <bit>
#include <cmath>
#include <cstdint>

#include "core/array_view.hpp"
#include "core/host_device.hpp"

namespace pointskin::poisson {

/// Noise is the standard deviation of a sample across the surface over the distance between samples. Up to kClean the
/// splat depths are kFiner levels finer, so that a third of the samples carries a normal; from kSomeNoise to kMuchNoise
/// they stay; from kTooMuchNoise on they are kCoarser levels coarser, with twice the samples. In between linear.
inline constexpr float kClean = 0.03F, kSomeNoise = 0.12F, kMuchNoise = 0.4F, kTooMuchNoise = 0.6F;
inline constexpr float kFiner = 0.79F, kCoarser = 0.5F;

/// On scan lines the fourth sample after one is often more than sqrt(kAlongLines) = 3.5 times as far away as the next:
/// for half of the samples, but for one in three where they are spread over the surface. Density then says nothing of
/// the distance between lines, and the depths do not get finer. Shares in between: linear.
inline constexpr float kAlongLines = 12;
inline constexpr float kNoLines = 0.38F, kLines = 0.46F;

/// Depths get finer only where the shape asks for it, along bends and across edges: for samples with a normal more than
/// 10 degrees apart among those up to kFollowers places before and after and nearer than kNear distances between samples.
inline constexpr float kBentCosine = 0.985F;
inline constexpr std::int64_t kFollowers = 4;
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

/// What the splat depths of a cloud may rise and do fall by.
struct Shift {
  float finer, coarser;
};

/// The shift that the noise of the whole cloud asks for. Over the pairs (p, n), (q, m) of a sample and the next one, if the
/// normals agree and the two are near each other along the surface,
///   noise^2 = median of ((n + m) / 2 . (p - q))^2 / (2 area_p) / 0.674^2,   area_p = 1 / density, 0.674^2 of a Gaussian;
/// an evenly bent surface adds nothing to it (trust.hpp), and sharp edges are too few to move a median. If no pair tells,
/// depths do not change.
/// @param pairs  shape (NoiseBin::kCount), numbers of pairs
/// @param lines  share of the samples that lie on lines
PSK_HD inline Shift shift_for(const std::uint64_t* pairs, float lines) {
  constexpr float kOfGaussian = 0.674F;    // the median of |x|
  std::uint32_t counts[NoiseBin::kCount];  // in registers: a read that waits for the one before takes longer
  std::uint32_t all = 0;
  PSK_UNROLL
  for (int bin = 0; bin < NoiseBin::kCount; ++bin) {
    counts[bin] = static_cast<std::uint32_t>(pairs[bin]);
    all += counts[bin];
  }
  if (all == 0) return {0, 0};
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
  return {kFiner * (1 - ramp(noise, kClean, kSomeNoise)) * (1 - ramp(lines, kNoLines, kLines)),
          kCoarser * ramp(noise, kMuchNoise, kTooMuchNoise)};
}

/// Whether the surface bends around sample i.
/// @param area  that the sample stands for, of the unit cube; 0: it does not
PSK_HD inline bool is_bent(ArrayView<const Vec3f> positions, ArrayView<const Vec3f> normals, std::int64_t i,
                           float area) {
  const float near2 = kNear * kNear * area;
  for (std::int64_t j = i > kFollowers ? i - kFollowers : 0; j <= i + kFollowers && j < positions.size; ++j)
    if (dot(normals[i], normals[j]) < kBentCosine && squared_length(positions[i] - positions[j]) < near2) return true;
  return false;
}

}  // namespace pointskin::poisson
