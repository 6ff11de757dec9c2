// Outliers: samples far from all others that no neighbour confirms, and clusters of samples that face all ways. What a
// sample adds to the field is in proportion to the area it stands for, and far from all others that is a large one: an
// outlier would act like hundreds of samples of the surface, and blow a bubble. So may a sample of a part that was seen
// sparsely; there the neighbours confirm it.
#pragma once

#include <pointskin/vector.hpp>

#include <cstdint>

#include "core/array_view.hpp"
#include "core/host_device.hpp"

namespace pointskin::poisson {

/// A sample that stands for more than so many times the usual area needs neighbours that confirm it.
inline constexpr float kUnusualArea = 4;

/// Neighbours are the samples up to kWindow places before and after in key order that are nearer than kNearCells cells
/// of the splat depth.
inline constexpr std::int64_t kWindow = 8;
inline constexpr float kNearCells = 3;

/// A neighbour confirms a sample if the two could lie on one surface: the cosine between the normals is above
/// kLeastCosine, and the squared cosine between the mean normal and the line from one to the other at most kMostBend.
inline constexpr float kLeastCosine = 0.3F;
inline constexpr float kMostBend = 0.0625F;

/// Below this cosine a neighbour is on the other side of a thin wall, and says nothing.
inline constexpr float kOtherSideCosine = -0.8F;

/// So many neighbours must confirm a sample, and this share of all: of random normals, one in ten does
/// (docs/decisions/0041-rough-data.md).
inline constexpr int kFewestConfirming = 2;
inline constexpr float kLeastConfirming = 0.34F;

/// Such a share of its neighbours must be confirmed, too (docs/decisions/0049-cube-of-the-inliers.md).
inline constexpr float kLeastConfirmed = 0.2F;

/// Samples with so many times the largest usual area are lonely, confirmed or not: a cloud that has some has outliers, or
/// ends so thinly that pieces of its surface may hang on one sample.
inline constexpr float kLonely = 8;

/// A sample among at least kManyNeighbours is in a cluster of outliers if fewer than kFewestAlike of them have a normal
/// with a cosine above kAlikeCosine: in any direction, of random normals one in ten has; along an edge every second,
/// at a corner every third. Normals are only asked of clouds that can be told by them: of the samples that are looked at
/// (examine.hpp), at least the share kTelling is among so many, and of those the share kMostlyAlike passes. The normals of
/// other clouds are too noisy, or their surfaces bend too fast.
/// Of outliers in a cluster one in five has three alike by chance: where they are less than kSurelyAlike of the neighbours,
/// and the mean cosine of all but those on the other side of a thin wall is below kMeanCosine, kFewestSuch of the alike ones
/// must have three themselves.
inline constexpr int kManyNeighbours = 12;
inline constexpr int kFewestAlike = 3;
inline constexpr float kSurelyAlike = 0.26F;
inline constexpr float kMeanCosine = 0.3F;
inline constexpr int kFewestSuch = 2;
inline constexpr float kAlikeCosine = 0.8F;
inline constexpr float kTelling = 0.25F;
inline constexpr float kMostlyAlike = 0.75F;

/// Near the surface an outlier is told by its neighbours. One that disagrees with all samples around (own_side.hpp) is one
/// if none of its neighbours faces it, with a cosine above kFacingCosine, and they are not all on the other side of a thin
/// wall. So is one that stands off: kFewestFacing neighbours face it, and its heights above their tangent planes have a
/// mean of more than kOffSurface spacings that is more than kSurelyOff times their standard deviation. Noise gives one
/// sample in some hundred such heights, and the surface loses nothing by it.
inline constexpr float kFacingCosine = 0.5F;
inline constexpr int kFewestFacing = 3;
inline constexpr float kOffSurface = 0.7F;
inline constexpr float kSurelyOff = 5;

/// What the neighbours of a sample say of it.
struct Seen {
  int neighbours = 0, alike = 0, facing = 0, opposite = 0;
  float cosines = 0;                       ///< sum over those that are not opposite
  float heights = 0, squared_heights = 0;  ///< sums over the facing ones, of the unit cube

  /// A neighbour with its normal.
  /// @param cosine  between the normals
  /// @param step    the way to it
  PSK_HD void add(float cosine, const Vec3f& normal, const Vec3f& step) {
    ++neighbours;
    if (cosine > kAlikeCosine) ++alike;
    if (cosine < kOtherSideCosine)
      ++opposite;
    else
      cosines += cosine;
    if (!(cosine > kFacingCosine)) return;
    const float height = dot(normal, step);
    ++facing;
    heights += height;
    squared_heights += height * height;
  }

  [[nodiscard]] PSK_HD bool can_tell() const { return neighbours >= kManyNeighbours; }
  [[nodiscard]] PSK_HD bool faces_like_others() const { return alike >= kFewestAlike; }
  [[nodiscard]] PSK_HD bool surely_does() const {
    return static_cast<float>(alike) >= kSurelyAlike * static_cast<float>(neighbours) ||
           cosines >= kMeanCosine * static_cast<float>(neighbours - opposite);
  }

  [[nodiscard]] PSK_HD bool none_faces_it() const { return facing == 0 && (neighbours == 0 || neighbours > opposite); }

  /// @param spacing2  squared mean distance of the samples around, of the unit cube
  [[nodiscard]] PSK_HD bool stands_off(float spacing2) const {
    constexpr float kSure = 1 + 1 / (kSurelyOff * kSurelyOff);
    if (facing < kFewestFacing) return false;
    const auto count = static_cast<float>(facing);
    const float squared = heights * heights;
    return kSure * squared > count * squared_heights &&
           squared > kOffSurface * kOffSurface * spacing2 * (count * count);
  }
};

/// The neighbours of a sample.
struct Around {
  ArrayView<const Vec3f> positions, normals;
  ArrayView<const float> splat_depths;

  /// Calls visit(neighbour, normal, step) for every neighbour, with its normal and the way to it. Both are read before it is known
  /// whether it is near: reads that wait for others take longer.
  template <class Visit>
  PSK_HD void operator()(std::int64_t i, const Visit& visit) const {
    const float near = reach(i);
    const std::int64_t first = i > kWindow ? i - kWindow : 0;
    const std::int64_t end = i + kWindow < positions.size ? i + kWindow + 1 : positions.size;
    const Vec3f here = positions[i];
    PSK_UNROLL_BY_4 for (std::int64_t j = first; j < end; ++j) {
      const Vec3f step = positions[j] - here;
      const Vec3f normal = normals[j];
      if (j != i && squared_length(step) < near * near) visit(j, normal, step);
    }
  }

  /// How near neighbours of sample i are.
  [[nodiscard]] PSK_HD float reach(std::int64_t i) const {
    return kNearCells / static_cast<float>(std::int64_t{1} << static_cast<int>(splat_depths[i]));
  }

  /// Whether the neighbours confirm a sample, and kLeastConfirmed of them are confirmed by their own: of outliers far from
  /// the surface some confirm a third by chance, but seldom each other.
  [[nodiscard]] PSK_HD PSK_SELDOM static bool is_confirmed(Around around, std::int64_t i) {
    if (!around.do_neighbours_confirm(i)) return false;
    const Vec3f own = around.normals[i];
    Confirming counted;
    around(i, [&](std::int64_t j, const Vec3f& normal, const Vec3f& /*step*/) {
      if (is_asked(own, normal)) counted.add(around.do_neighbours_confirm(j));
    });
    return counted.are_enough_confirmed();
  }

  [[nodiscard]] PSK_HD bool do_neighbours_confirm(std::int64_t i) const {
    const Vec3f own = normals[i];
    Confirming counted;
    (*this)(i, [&](std::int64_t /*j*/, const Vec3f& normal, const Vec3f& step) {
      if (is_asked(own, normal)) counted.add(does_confirm(own, normal, step));
    });
    return counted.are_enough();
  }

  /// Neighbours that are asked, and those that say yes.
  struct Confirming {
    int asked = 0, confirming = 0;

    PSK_HD void add(bool confirms) {
      ++asked;
      if (confirms) ++confirming;
    }
    [[nodiscard]] PSK_HD bool are_enough() const {
      return confirming >= kFewestConfirming &&
             static_cast<float>(confirming) >= kLeastConfirming * static_cast<float>(asked);
    }
    [[nodiscard]] PSK_HD bool are_enough_confirmed() const {
      return confirming > 0 && static_cast<float>(confirming) >= kLeastConfirmed * static_cast<float>(asked);
    }
  };

  /// Whether a neighbour with this normal is not on the other side of a thin wall.
  PSK_HD static bool is_asked(const Vec3f& own, const Vec3f& normal) { return !(dot(own, normal) < kOtherSideCosine); }

  PSK_HD static bool does_confirm(const Vec3f& own, const Vec3f& normal, const Vec3f& step) {
    const float across = 0.5F * dot(own + normal, step);
    return dot(own, normal) > kLeastCosine && across * across <= kMostBend * squared_length(step);
  }

  /// Whether kFewestSuch of those that face like sample i face like others themselves.
  [[nodiscard]] PSK_HD PSK_SELDOM static bool is_among_such(Around around, std::int64_t i) {
    const Vec3f own = around.normals[i];
    int such = 0;
    around(i, [&](std::int64_t j, const Vec3f& normal, const Vec3f& /*step*/) {
      if (around.is_such(own, j, normal)) ++such;
    });
    return such >= kFewestSuch;
  }

  /// Whether neighbour j, with this normal, faces like a sample and like others.
  [[nodiscard]] PSK_HD bool is_such(const Vec3f& own, std::int64_t j, const Vec3f& normal) const {
    return dot(own, normal) > kAlikeCosine && seen_from(j).faces_like_others();
  }

  [[nodiscard]] PSK_HD Seen seen_from(std::int64_t i) const {
    const Vec3f own = normals[i];
    Seen seen;
    (*this)(i, [&](std::int64_t /*j*/, const Vec3f& normal, const Vec3f& step) {
      seen.add(dot(own, normal), normal, step);
    });
    return seen;
  }
};

}  // namespace pointskin::poisson
