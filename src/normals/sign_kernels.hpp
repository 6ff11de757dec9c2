// What is done at every sample while signs are decided.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/array_view.hpp"
#include "core/vec3.hpp"
#include "exec/atomic.hpp"
#include "normals/trial_field.hpp"

namespace pointskin::normals::signs {

/// Sums of fractions as integers, so that their order does not matter.
inline constexpr double kFraction = 65536;

PSK_HD inline std::uint64_t fixed_point(double value) {
  return static_cast<std::uint64_t>(static_cast<std::int64_t>(value * kFraction + (value < 0 ? -0.5 : 0.5)));
}
inline double from_fixed_point(std::uint64_t sum) {
  return static_cast<double>(static_cast<std::int64_t>(sum)) / kFraction;
}

/// sign[i] = that within its patch times that of the patch; 0 for patches of another set.
struct ComposeSigns {
  ArrayView<const std::int32_t> labels, within, patch_signs;
  ArrayView<std::int32_t> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = within[i] * patch_signs[labels[i]]; }
};

/// sums[set]: of votes for the signs within patches. @param votes  1, -1, or 0 for none
struct CountVotes {
  ArrayView<const std::int32_t> labels, within, votes;
  std::uint64_t* net;
  std::uint64_t* gross;
  PSK_HD void operator()(std::int64_t i) const {
    if (votes[i] == 0) return;
    exec::add(net + labels[i], static_cast<std::uint64_t>(std::int64_t{within[i] * votes[i]}));
    exec::add(gross + labels[i], 1);
  }
};

/// Of every set: area, area times field, area times normal times minus the gradient.
struct MeasureSets {
  static constexpr int kSums = 3;
  TrialView trial;
  ArrayView<const Vec3f> positions, lines;
  ArrayView<const float> areas;
  ArrayView<const std::int32_t> signs, labels, sets;  // sets: (patches) or -1
  std::uint64_t* sums;
  PSK_HD void operator()(std::int64_t i) const {
    const std::int32_t set = sets[labels[i]];
    if (set < 0) return;
    const AtSample at = trial(positions[i]);
    const double along = dot(to_double(lines[i]), to_double(at.outward)) * signs[i];
    const double area = areas[i];
    exec::add(sums + kSums * set, fixed_point(area));
    exec::add(sums + kSums * set + 1, fixed_point(area * static_cast<double>(at.value)));
    exec::add(sums + kSums * set + 2, fixed_point(area * along));
  }
};

/// Signs at random, from the place in the order of the tree.
struct RandomSigns {
  std::uint64_t seed;
  ArrayView<std::int32_t> signs;
  PSK_HD void operator()(std::int64_t i) const {
    std::uint64_t bits = (static_cast<std::uint64_t>(i) + seed * 0x632be59bd9b4e019ULL) * 0x9e3779b97f4a7c15ULL;
    bits = (bits ^ bits >> 30) * 0xbf58476d1ce4e5b9ULL;
    signs[i] = (bits >> 40 & 1) != 0 ? 1 : -1;
  }
};

/// Turns every sample to the side that the field says. @param changed  1 where that was the other one
struct FollowField {
  TrialView trial;
  ArrayView<const Vec3f> positions, lines;
  ArrayView<std::int32_t> signs;
  ArrayView<std::int32_t> changed;
  PSK_HD void operator()(std::int64_t i) const {
    const AtSample at = trial(positions[i]);
    const Vec3f n = lines[i];
    const float along = n.x * at.outward.x + n.y * at.outward.y + n.z * at.outward.z;
    const std::int32_t sign = along > 0 ? 1 : (along < 0 ? -1 : signs[i]);
    changed[i] = sign != signs[i] ? 1 : 0;
    signs[i] = sign;
  }
};

/// Turns samples that their neighbours contradict, or the field where neighbours are of two minds.
struct CleanUp {
  TrialView trial;
  ArrayView<const Vec3f> positions, lines;
  ArrayView<const float> agreement;
  ArrayView<std::int32_t> signs;
  ArrayView<std::int32_t> changed;
  PSK_HD void operator()(std::int64_t i) const {
    constexpr float kContradicted = 0.3F;
    constexpr float kUndecided = 0.65F;
    changed[i] = 0;
    if (agreement[i] >= kUndecided) return;
    const AtSample at = trial(positions[i]);
    const Vec3f n = lines[i];
    const float along = static_cast<float>(signs[i]) * (n.x * at.outward.x + n.y * at.outward.y + n.z * at.outward.z);
    if (along >= 0 && agreement[i] >= kContradicted) return;
    signs[i] = -signs[i];
    changed[i] = 1;
  }
};

/// How sure one may be of a sample: a plane around it, neighbours that agree, and a field that does.
struct Confidence {
  TrialView trial;
  ArrayView<const Vec3f> positions, lines;
  ArrayView<const float> agreement, flatness;
  ArrayView<const std::int32_t> signs;
  float sides;  // 1 unless inside and outside are a guess
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const {
    const AtSample at = trial(positions[i]);
    const Vec3f n = lines[i];
    const float length =
        std::sqrt(at.outward.x * at.outward.x + at.outward.y * at.outward.y + at.outward.z * at.outward.z);
    const float along = static_cast<float>(signs[i]) * (n.x * at.outward.x + n.y * at.outward.y + n.z * at.outward.z);
    const float field = length > 0 ? 0.5F + 0.5F * (along / length) : 0.5F;
    const float flat = flatness[i] < 0.5F ? 2 * flatness[i] : 1.0F;
    const float value = flat * agreement[i] * field * sides;
    out[i] = value < 0 ? 0.0F : (value > 1 ? 1.0F : value);
  }
};

}  // namespace pointskin::normals::signs
