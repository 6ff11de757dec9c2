// How much the surface bends from one sample to the next: the squared angle, in radians, that normals turn by over the distance
// between samples. What averages over a few samples takes that much of the shape away.
#pragma once

#include <pointskin/vector.hpp>

#include "core/host_device.hpp"
#include "core/vec3.hpp"

namespace pointskin::poisson {

/// From the normals that are summed up around a sample, on two levels. Over a disc of radius r normals that turn by b from sample
/// to sample have a mean shorter than 1: its squared length falls from a level to the next coarser one by b times the samples
/// on a face of a cell, however noisy the single normals are.
class BendAcrossLevels {
 public:
  [[nodiscard]] PSK_HD bool is_known() const { return levels_ == 2; }

  /// Takes a level, the finest first; levels without enough samples are passed over.
  /// @param normal   sum of the normals, by hats
  /// @param count    sum of the hats, > 0
  /// @param samples  on a face of a cell
  PSK_HD void add(const Vec3f& normal, float count, float samples) {
    if (is_known() || (levels_ == 0 && samples < kFewest)) return;
    const float squared = squared_length(normal) / (count * count);
    const float without_chance = squared - kChance * (1 - squared) / samples;
    if (levels_ == 0) {
      finer_ = without_chance;
      samples_ = samples;
    } else {
      const float two_sheets = without_chance < kOneSheet ? kOneSheet - without_chance : 0.0F;
      const float turned = finer_ - without_chance + two_sheets;
      bend_ = turned > 0 ? turned / samples_ : 0.0F;
    }
    ++levels_;
  }

  /// Zero where it is not known.
  [[nodiscard]] PSK_HD float value() const { return bend_; }

 private:
  /// Samples on a face of a cell of the finer level.
  static constexpr float kFewest = 2;
  /// A mean of few normals is longer by chance, by this over their number: the hats of about 4 times as many count.
  static constexpr float kChance = 0.27F;
  /// Squared length below which the normals are those of an edge, or of both sides of a thin wall.
  static constexpr float kOneSheet = 0.75F;

  int levels_ = 0;
  float finer_ = 0, samples_ = 0, bend_ = 0;
};

/// From single neighbours, so that it also sees what is finer than the cells that are summed over: the line through
/// 1 - n_p . n_q over the squared distances, in units of the distance between samples. Noise of the normals is the same at any
/// distance, and moves the line, but does not tilt it.
class BendAmongNeighbours {
 public:
  /// @param cosine    between the two normals
  /// @param distance2 squared, in samples
  PSK_HD void add(float cosine, float distance2) {
    if (distance2 > kFarthest) return;
    const float off = 1 - cosine;
    number_ += 1;
    distance_ += distance2;
    off_ += off;
    squares_ += distance2 * distance2;
    products_ += distance2 * off;
  }

  [[nodiscard]] PSK_HD float value() const {
    const float spread = number_ * squares_ - distance_ * distance_;
    const float rise = number_ * products_ - distance_ * off_;
    return number_ >= kFewest && spread > 0 && rise > 0 ? kSquaredAngle * rise / spread : 0.0F;
  }

 private:
  static constexpr float kFewest = 4;
  static constexpr float kFarthest = 16;
  /// 1 - cos is half of the squared angle; and neighbours lie in all directions, so that of a bend along one of two axes they
  /// show a part.
  static constexpr float kSquaredAngle = 2.8F;

  float number_ = 0, distance_ = 0, off_ = 0, squares_ = 0, products_ = 0;
};

}  // namespace pointskin::poisson
