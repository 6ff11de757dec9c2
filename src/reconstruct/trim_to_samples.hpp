// The surface cut where the samples are too far apart, once for every space: between field and surface.
#pragma once

#include <pointskin/error.hpp>
#include <pointskin/reconstruct.hpp>

#include <utility>

#include "diagnose/verdict.hpp"
#include "octree/frame.hpp"
#include "octree/octree_data.hpp"
#include "poisson/spacing.hpp"
#include "surface/trim.hpp"

namespace pointskin::detail {

/// The surface ends where samples lie this many times farther apart than at the sparsest of the samples that count.
/// Just outside of a border of even samples the distance rises from 1.2 to twice what it is inside within two samples;
/// farther out the octree's coarser levels make it uneven (docs/decisions/0014-trim.md).
inline constexpr float kTrimSpacing = 1.75F;

/// A trim that was to be chosen leaves a surface as it is of which less is far from samples.
inline constexpr double kLittleFar = 0.005;

/// Of such a trim: the surface runs into the faces of the cube, and does not wrap all of it.
inline bool is_cut_by_faces(const diagnose::Findings& findings) {
  return diagnose::runs_into_faces(findings) && findings.faces_inside < 1;
}

/// Largest spacing of samples, in finest cells, that the surface keeps.
/// @param normals  of the samples, of unit length
template <exec::Space Exec>
float trim_limit(Exec& ex, const octree::OctreeData& tree, const poisson::Density& density,
                 ArrayView<const Vec3f> positions, ArrayView<const Vec3f> normals, double trim) {
  return kTrimSpacing * poisson::spacing_of_sparsest(ex, tree, density, positions, normals, trim);
}

/// Cuts `surface`, which must have normals, where the spacing of samples exceeds `limit_cells`.
/// @param report  receives what was cut
template <exec::Space Exec>
surface::Surface trim_to_samples(Exec& ex, const octree::OctreeData& tree, const poisson::Density& density,
                                 surface::Surface surface, const surface::TrimOptions& options,
                                 surface::TrimCounts& counts) {
  auto spacing = exec::make_buffer<float>(ex, surface.positions.size());
  poisson::evaluate_spacing(ex, tree, density, surface.positions.cview(), surface.normals.cview(), spacing.view());
  return surface::trim_surface(ex, std::move(surface), spacing.cview(), options, counts);
}

/// In world units.
inline TrimReport trim_report(const surface::TrimCounts& counts, const octree::Frame& frame, int depth,
                              float limit_cells) {
  const double cell = frame.size / static_cast<double>(std::int64_t{1} << depth);
  const double spacing = static_cast<double>(limit_cells) * cell;
  TrimReport report;
  report.density = 1 / (spacing * spacing);
  report.area_before = counts.area_before * frame.size * frame.size;
  report.area_removed = (counts.area_before - counts.area_kept) * frame.size * frame.size;
  report.triangles_before = counts.triangles_before;
  report.triangles_removed = counts.triangles_removed;
  report.triangles_split = counts.triangles_split;
  report.islands_removed = counts.islands_removed;
  report.holes_filled = counts.holes_filled;
  return report;
}

}  // namespace pointskin::detail
