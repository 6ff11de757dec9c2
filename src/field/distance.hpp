// Signed distance to the samples' tangent planes at the corners of the octree (P10).
// Source: Hoppe, DeRose, Duchamp, McDonald & Stuetzle, "Surface reconstruction from unorganized points", SIGGRAPH 1992,
// section 3.3; Zhou et al. 2010, section 5. Differs: the normals are given; the planes of kNearestSamples samples are
// averaged, in the way of Shen, O'Brien & Shewchuk, "Interpolating and approximating implicit surfaces from polygon
// soup", SIGGRAPH 2004, with weights that fall to 0 at the last of them, so the function is continuous and one plane
// that runs on beyond an edge decides nothing; and the side of a corner is that of a solved field, as far from all
// samples a plane says nothing of it (docs/decisions/0020-signed-distance-and-offset.md, 0047-sides-of-the-distance.md).
#pragma once

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "octree/octree_data.hpp"

namespace pointskin::field {

/// Samples whose tangent planes are averaged.
inline constexpr int kNearestSamples = 16;

/// Samples in the order of the octree; shape (n) each.
struct TangentPlanes {
  ArrayView<const Vec3f> positions;  ///< in the unit cube
  ArrayView<const Vec3f> normals;    ///< unit length, or zero for a sample without a plane
  ArrayView<const float> weights;    ///< at least 0; empty: all weigh alike
};

/// A field that says on which side corners are, where it is more than kSureSide away from its isovalue.
struct Sides {
  const float* values = nullptr;  ///< over the nodes of all levels, level-major; null: the planes say it everywhere
  float isovalue = 0;             ///< inside is above
};

/// Of 1, the step of a solved field at the surface.
inline constexpr float kSureSide = 0.01F;

/// Takes the planes of samples away that have no area: their normals become 0.
/// @param areas    shape (n), finest cells^2
/// @param normals  shape (n)
/// O(n), deterministic; does not wait.
template <exec::Space Exec>
void drop_planes_of_outliers(Exec& ex, ArrayView<const float> areas, ArrayView<Vec3f> normals);

/// Scales normals to unit length; those of zero length stay. O(n).
template <exec::Space Exec>
void normalise(Exec& ex, ArrayView<Vec3f> normals);

/// Minus the signed distance at the corners of all levels, level-major, in finest cells: positive inside. With the
/// samples p_i that have a plane, nearest first, w_i their weights and K = kNearestSamples of them:
///   value(x) = - 2^D sum a_i (x - p_i) . n_i / sum a_i,   a_i = w_i (1 - |x - p_i|^2 / |x - p_K|^2)^2
/// (a_i = w_i if that sums to 0, or if there are fewer than K samples), with the sign of `sides` where these are sure.
/// Corners that are no unknowns of their level hold the interpolation of the level above. Nearest samples are exact; of
/// two at one distance the first in the octree's order is nearer.
/// @throws Error over_limit if memory runs out
/// Near samples O(64 cells) a corner, else a walk from the root; one or two launches a level. Waits once, and takes 8 bytes a
/// sample besides the result, which are given back at once where few have no plane. Deterministic: the same bits on every device.
template <exec::Space Exec>
exec::Buffer<float> distance_to_planes(Exec& ex, const octree::OctreeData& tree, const TangentPlanes& planes,
                                       const Sides& sides = {});

}  // namespace pointskin::field
