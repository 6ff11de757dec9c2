// Attributes of the samples, such as colours, at any point: pull-push over the corner hats of all levels.
// Source: Gortler, Grzeszczuk, Szeliski & Cohen, "The lumigraph", SIGGRAPH 1996 (pull-push of scattered data, weights
// capped at one on the way up); Kazhdan's PoissonRecon mixes the levels of a colour field in the same spirit ("data
// pull factor"). Differs: in the hats of an octree around a surface instead of on an image grid, and a level leans on
// the one above as on a fixed number of samples.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

#include <cstddef>
#include <functional>
#include <limits>
#include <string>
#include <vector>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "core/typed_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "exec/typed_buffer.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::field {

/// Samples that the value of the level above counts for. Too few show the noise of single samples, too many blur; the
/// error has a flat minimum here (docs/decisions/0015-attributes.md).
inline constexpr float kSamplesAbove = 0.125F;

/// Attributes that share one pass: three, such as the channels of a colour, and their weight are 16 bytes.
inline constexpr std::size_t kAttributesAtOnce = 3;

/// The finite ones of an attribute's values.
struct ValueRange {
  double lowest = std::numeric_limits<double>::infinity();
  double highest = -std::numeric_limits<double>::infinity();
  std::int64_t counted = 0;

  /// That of both.
  [[nodiscard]] PSK_HD ValueRange united(const ValueRange& other) const {
    return {lowest < other.lowest ? lowest : other.lowest, highest > other.highest ? highest : other.highest,
            counted + other.counted};
  }
};

/// From values to their shares of a range, in double: neither large nor close values lose their differences.
class ToShare {
 public:
  ToShare() = default;
  explicit ToShare(const ValueRange& range)
      : lowest_(range.lowest), half_extent_(range.highest / 2 - range.lowest / 2) {}

  /// In [0, 1]; NaN of what is not finite.
  PSK_HD float operator()(double value) const {
    if (!(0 * value == 0)) return std::numeric_limits<float>::quiet_NaN();
    return half_extent_ > 0 ? static_cast<float>((value / 2 - lowest_ / 2) / half_extent_) : 0.0F;
  }

 private:
  double lowest_ = 0, half_extent_ = 0;
};

/// A continuous attribute of the samples, whose values are averaged.
struct Channel {
  std::size_t place = 0;  ///< in AttributeSamples::names
  AttributeType type = AttributeType::float32;
  exec::Buffer<float> shares;  ///< (n) values as shares of the range, in [0, 1]; NaN: the sample does not count
  ValueRange range;
};

/// From shares of a range back to values: in double, and by halves, so that not even the largest range overflows.
struct FromShares {
  double lowest = 0, highest = 0;
  TypedOutput out;

  /// Stores the value of `share`, which stays in the range.
  PSK_HD void store(std::int64_t i, float share) const {
    const double value = 2 * (lowest / 2 + share * (highest / 2 - lowest / 2));
    const bool is_double = out.type == AttributeType::float64;
    const double v = is_double ? value : static_cast<double>(static_cast<float>(value));
    out.store(i, v < lowest ? lowest : v > highest ? highest : v);
  }
};

/// A label of the samples (is_label), of which points get that of the nearest sample.
struct Label {
  std::size_t place = 0;     ///< in AttributeSamples::names
  exec::TypedBuffer values;  ///< (n)
};

/// Everything that is known of the samples' attributes.
struct AttributeSamples {
  std::vector<std::string> names;           ///< on the mesh
  std::vector<std::string> without_values;  ///< of no sample; they are neither channels nor labels
  exec::Buffer<Vec3f> positions;            ///< (n) in the unit cube, in the octree's order
  exec::Buffer<float> weights;              ///< (n) at least 0; (0): all count the same
  std::vector<Channel> channels;
  std::vector<Label> labels;
};

/// The range of the values used, in double. O(n), one read-back.
/// @param used  indices of values; empty: all
template <exec::Space Exec>
ValueRange find_range(Exec& ex, const TypedView& values, ArrayView<const std::int32_t> used);

/// Makes a channel of values[order[i]], i in [0, n); those that are not finite do not count. Shares are taken in
/// double: they tell values apart that are 2^-24 of the range from each other, however large they are. O(n).
/// @param place  see Channel
template <exec::Space Exec>
Channel make_channel(Exec& ex, std::size_t place, const TypedView& values, const ValueRange& range,
                     ArrayView<const std::int32_t> order);

/// Receives the place of an attribute and its (points) values, which it may keep.
using TakeValues = std::function<void(std::size_t, exec::TypedBuffer)>;

/// Interpolates every channel at `points` of the unit cube and hands it on, in the order of the channels. Of each channel
/// a sample counts.
///
/// With hats phi_c of level d, weights w_p and values a_p of the samples:
///   N_D[c] = sum_p w_p phi_c(p),             m_D[c] = sum_p w_p phi_c(p) a_p / N_D[c]
///   N_d = R min(1, N_(d+1)),                 m_d = R (min(1, N_(d+1)) m_(d+1)) / N_d           (pull)
///   f_d = (N_d m_d + k P f_(d-1)) / (N_d + k),   k = kSamplesAbove                             (push)
/// f_D at a point is one trilinear interpolation in its leaf: next to a coarser leaf no sample has a hat, so f_d is
/// P f_(d-1) there and f is continuous. Every value is a mean of the samples' values with weights of at least 0: values
/// stay in the range of the input, and an attribute that is the same everywhere comes back exactly. Values keep their
/// type; integers are rounded.
/// Up to kAttributesAtOnce neighbouring channels that miss the same samples share a pass, of 8 to 16 bytes a node and
/// one value a point and channel. O(8 n + 27 nodes + points depth) a pass. Gathers in a fixed order: the same bits on
/// every device.
template <exec::Space Exec>
void interpolate(Exec& ex, const octree::OctreeData& tree, const AttributeSamples& samples,
                 ArrayView<const Vec3f> points, const TakeValues& take);

/// Hands on every label at `points` of the unit cube: that of the nearest sample which has one; of several as near, of
/// the first in the octree's order. Missing where no sample has one. The search is made once for all labels that miss
/// no sample, and again for others. 4 bytes a point, and up to 20 a sample where some miss it. O(points log n). The
/// same bits on every device.
template <exec::Space Exec>
void find_labels(Exec& ex, const octree::OctreeData& tree, const AttributeSamples& samples,
                 ArrayView<const Vec3f> points, const TakeValues& take);

}  // namespace pointskin::field
