// A look at what a run works on, cheap enough for every run: a few thousand samples, points and triangles, counted on
// the device. diagnose/verdict.hpp says what the counts mean.
#pragma once

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "diagnose/counts.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"
#include "octree/view.hpp"
#include "poisson/density.hpp"
#include "poisson/samples.hpp"
#include "surface/extract.hpp"

namespace pointskin::diagnose {

/// Counts in the memory of a space, zero at first.
template <exec::Space Exec>
exec::Buffer<Counts> make_counts(Exec& ex);

/// Counts pairs of samples that follow each other in Morton order by how their normals agree, how they scatter across
/// the surface, the density around them, and what of a solid they enclose.
/// @param samples  in key order, with areas; unit normals
/// @param density  of weigh_samples
/// One launch over kSamples samples, no wait.
template <exec::Space Exec>
void look_at_samples(Exec& ex, const octree::OctreeView& tree, const poisson::Density& density,
                     const poisson::SamplesView& samples, exec::Buffer<Counts>& counts);

/// Counts where the faces of the cube are inside, and which samples lie away from the level set.
/// @param samples  positions and splat depths
/// One launch, no wait.
template <exec::Space Exec>
void look_at_field(Exec& ex, const field::FieldView& field, const poisson::SamplesView& samples,
                   exec::Buffer<Counts>& counts);

/// Adds up the areas of a few triangles: all, those far from all samples, and those that close the surface on the faces
/// of the cube.
/// @param far_depth  the surface is far where no cell of this level around holds a sample
/// One launch, no wait.
template <exec::Space Exec>
void look_at_surface(Exec& ex, const octree::OctreeView& tree, int far_depth, const surface::Surface& surface,
                     const exec::Buffer<Counts>& counts);

/// The counts on the host. Waits.
template <exec::Space Exec>
Counts read_counts(Exec& ex, const exec::Buffer<Counts>& counts);

}  // namespace pointskin::diagnose
