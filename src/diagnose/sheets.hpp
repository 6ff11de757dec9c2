// How thick the sheet is that the samples around a sample form: noise, seen at the scale where it no longer looks like
// a volume. Source: Mitra & Nguyen, "Estimating surface normals in noisy point cloud data", SoCG 2003 (the
// neighbourhood must be wider than the noise, and narrower than the shape).
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/space.hpp"
#include "octree/view.hpp"

namespace pointskin::diagnose {

/// Samples around which thickness is measured.
inline constexpr std::int64_t kSheetSamples = 1024;

/// Noise of `positions`, in finest cells: the standard deviation of the samples in the 27 cells around a sample, across
/// the surface, median over a few samples, on the finest level whose cells are at least twice as wide as that; 0 where
/// none is. Across the surface is along the normals of samples that face alike; without normals, across
/// the plane through the samples, to which what the surface bends adds, and samples on two sheets say nothing.
/// @param positions  in the unit cube and key order, shape (n)
/// @param normals    unit length or zero, shape (n) or (0)
/// O(kSheetSamples) walks over up to 512 samples each on up to five levels; waits. Deterministic, does not depend on
/// the order of the points.
template <exec::Space Exec>
double measure_noise(Exec& ex, const octree::OctreeView& tree, ArrayView<const Vec3f> positions,
                     ArrayView<const Vec3f> normals);

}  // namespace pointskin::diagnose
