// Looks at a cloud that is worked on in blocks: each block looks at what is its own, and the counts add up to those of the whole.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "diagnose/counts.hpp"
#include "exec/memory.hpp"
#include "exec/space.hpp"
#include "field/field_view.hpp"
#include "octree/view.hpp"
#include "poisson/density.hpp"
#include "poisson/samples.hpp"

namespace pointskin::diagnose {

/// Counts the density at samples, as look_at_samples() does where it does not look across the faces of cells.
/// @param positions  of the block's own among those samples
/// One launch, no wait. Defined in look.cpp.
template <exec::Space Exec>
void look_at_densities(Exec& ex, const octree::OctreeView& tree, const poisson::Density& density,
                       ArrayView<const Vec3f> positions, const exec::Buffer<Counts>& counts);

/// look_at_field() at points in cells of the finest level begin..end - 1, by key.
/// @param samples  positions and splat depths of those that are looked at in the block
/// One launch, no wait. Defined in look.cpp.
template <exec::Space Exec>
void look_at_field_of_block(Exec& ex, const field::FieldView& field, const poisson::SamplesView& samples,
                            std::uint64_t begin, std::uint64_t end, const exec::Buffer<Counts>& counts);

}  // namespace pointskin::diagnose
