// What a run counts about its samples, its field and its surface, to know whether something is wrong with them.
#pragma once

#include <bit>
#include <cstdint>

#include "core/host_device.hpp"
#include "exec/atomic.hpp"

namespace pointskin::diagnose {

/// Samples that are looked at, evenly spread over their Morton order.
inline constexpr std::int64_t kSamples = 8192;

/// Where a look costs a walk through the octree, one in so many of those is looked at.
inline constexpr std::int64_t kSparse = 2;

/// Samples that follow a sample in Morton order and are compared with it. Across the planes of coarse cells none
/// follows: so it is compared with samples of cells around its own, too.
inline constexpr int kFollowers = 2;

/// Distances in Morton order over which scatter is measured: 1, 4, 16.
inline constexpr int kScatterSteps = 3;

/// Points on each face of the cube where the field is looked at, along an axis.
inline constexpr int kFacePoints = 16;
inline constexpr std::int64_t kAllFacePoints = 6 * kFacePoints * kFacePoints;

/// Triangles that are looked at.
inline constexpr std::int64_t kTriangles = 8192;

/// What is added up. Fractions are counted in units of 2^-40.
enum Sum : int {
  // Pairs of samples near each other whose distance runs along the surface, by their normals.
  kAlike,    ///< within 60 degrees
  kApart,    ///< opposed, each behind the other: the sides of a thin wall, or one of them flipped
  kFacing,   ///< opposed, each before the other: the sides of a slit, or one of them flipped
  kAbreast,  ///< opposed, at the same height
  // Of what the samples stand for, fractions of a face of the cube.
  kArea,
  kVectorX,  ///< area times normal, signed: nothing for a closed surface
  kVectorY,
  kVectorZ,
  kFlux,     ///< area times normal times place, signed: three times the volume
  kScatter,  ///< half the squared distances across the surface, finest cells^2, fractions; one for each step
  kScatterPairs = kScatter + kScatterSteps,
  kLonely = kScatterPairs + kScatterSteps,  ///< all samples that are far from all others
  // Of the field.
  kFacesInside,  ///< of the points on the cube's faces
  kSamplesSeen,  ///< samples at which the field was looked at
  kSamplesOff,   ///< of them, away from the surface
  // Of triangles, fractions of a face of the cube.
  kSurface,
  kFarSurface,  ///< of it, far from all samples
  kCaps,        ///< of it, on the faces of the cube
  kSums
};

/// Bins for the density of samples, four an octave.
inline constexpr int kDensityBins = 256;

/// Bins of positive floats by exponent and two bits more: the same on every device, without a logarithm.
struct DensityBin {
  static constexpr int kFirst = (127 - 44) * 4;  // 2^-44

  PSK_HD static int of(float density) {
    const int bin = static_cast<int>(std::bit_cast<std::uint32_t>(density) >> 21) - kFirst;
    return bin < 0 ? 0 : bin < kDensityBins ? bin : kDensityBins - 1;
  }
  /// The lower end of a bin.
  static float value(int bin) { return std::bit_cast<float>(static_cast<std::uint32_t>(bin + kFirst) << 21); }
};

/// Sums over a few of the samples and triangles. Integers, so that their order does not matter.
struct Counts {
  std::uint64_t sums[kSums];
  std::uint64_t densities[kDensityBins];  ///< samples by the samples around them on a finest cell's face
};

/// Sums of either.
inline void add(Counts& to, const Counts& more) {
  for (int i = 0; i < kSums; ++i) to.sums[i] += more.sums[i];
  for (int i = 0; i < kDensityBins; ++i) to.densities[i] += more.densities[i];
}

inline constexpr double kFraction = 0x1p40;

inline double fraction(std::uint64_t sum) { return static_cast<double>(static_cast<std::int64_t>(sum)) / kFraction; }

/// What one look adds to Counts: the sums from kFirst to before kEnd, as exec::for_each_by_lanes adds them up.
template <int kFirst, int kEnd>
class Tally {
 public:
  PSK_HD void add(int which, std::uint64_t value) { set(which - kFirst, word(which - kFirst) + value); }
  PSK_HD void count(int which, bool happened) { add(which, happened ? 1 : 0); }
  /// @param value  sums stay in (-2^23, 2^23)
  PSK_HD void add_fraction(int which, double value) {
    add(which, static_cast<std::uint64_t>(static_cast<std::int64_t>(value * kFraction)));
  }
  PSK_HD Tally operator+(const Tally& other) const {
    Tally sum;
    PSK_UNROLL
    for (int i = 0; i < kEnd - kFirst; ++i) sum.set(i, word(i) + other.word(i));
    return sum;
  }
  PSK_HD void flush(Counts* counts) const {
    PSK_UNROLL
    for (int i = 0; i < kEnd - kFirst; ++i)
      if (word(i) != 0) exec::add(counts->sums + kFirst + i, word(i));
  }

 private:
  [[nodiscard]] PSK_HD std::uint64_t word(int i) const { return std::uint64_t{high_[i]} << 32 | low_[i]; }
  PSK_HD void set(int i, std::uint64_t value) {
    low_[i] = static_cast<std::uint32_t>(value);
    high_[i] = static_cast<std::uint32_t>(value >> 32);
  }

  std::uint32_t low_[kEnd - kFirst] = {};
  std::uint32_t high_[kEnd - kFirst] = {};
};

}  // namespace pointskin::diagnose
