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
#include <string>
#include <vector>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::field {

/// Samples that the value of the level above counts for. Too few show the noise of single samples, too many blur; the
/// error has a flat minimum here (docs/decisions/0015-attributes.md).
inline constexpr float kSamplesAbove = 0.125F;

/// Attributes that share one pass: three, such as the channels of a colour, and their weight are 16 bytes.
inline constexpr std::size_t kAttributesAtOnce = 3;

/// One attribute of the samples.
struct Channel {
  std::string name;
  AttributeType type = AttributeType::float32;
  exec::Buffer<float> values;  ///< (n) shares of the range, in [0, 1]; NaN: the sample does not count
  float lowest = 0;            ///< of the finite values
  float highest = 0;
  std::int64_t counted = 0;  ///< samples that count
};

/// Everything that is known of the samples' attributes.
struct AttributeSamples {
  exec::Buffer<Vec3f> positions;  ///< (n) in the unit cube, in the octree's order
  exec::Buffer<float> weights;    ///< (n) at least 0; (0): all count the same
  std::vector<Channel> channels;
};

/// Makes a channel of `values` (n > 0), which it takes over; those that are not finite do not count.
/// O(n), one read-back.
template <exec::Space Exec>
Channel make_channel(Exec& ex, std::string name, AttributeType type, exec::Buffer<float> values);

/// Receives a channel and its (points) values, which it may keep.
using TakeValues = std::function<void(const Channel&, exec::Buffer<float>)>;

/// Interpolates every attribute at `points` of the unit cube and hands it on, in the order of the channels.
///
/// With hats phi_c of level d, weights w_p and values a_p of the samples:
///   N_D[c] = sum_p w_p phi_c(p),             m_D[c] = sum_p w_p phi_c(p) a_p / N_D[c]
///   N_d = R min(1, N_(d+1)),                 m_d = R (min(1, N_(d+1)) m_(d+1)) / N_d           (pull)
///   f_d = (N_d m_d + k P f_(d-1)) / (N_d + k),   k = kSamplesAbove                             (push)
/// f_D at a point is one trilinear interpolation in its leaf: next to a coarser leaf no sample has a hat, so f_d is
/// P f_(d-1) there and f is continuous. Every value is a mean of the samples' values with weights of at least 0: values
/// stay in the range of the input, and an attribute that is the same everywhere comes back exactly. Values of uint8
/// attributes are whole numbers in 0..255. An attribute without samples that count is NaN everywhere, or 0 if it is
/// uint8.
/// Up to kAttributesAtOnce neighbouring attributes that miss the same samples share a pass, of 8 to 16 bytes a node and
/// 4 a point and attribute. O(8 n + 27 nodes + points depth) a pass. Gathers in a fixed order: the same bits on every
/// device.
template <exec::Space Exec>
void interpolate(Exec& ex, const octree::OctreeData& tree, const AttributeSamples& samples,
                 ArrayView<const Vec3f> points, const TakeValues& take);

}  // namespace pointskin::field
