// Looks at a cloud and a mesh that lie on a disk: what diagnose/look.hpp counts of them in memory.
#pragma once

#include "diagnose/counts.hpp"
#include "exec/cpu.hpp"
#include "scale/block_meshes.hpp"
#include "scale/key_index.hpp"
#include "scale/sample_values.hpp"
#include "scale/sorted_cloud.hpp"

namespace pointskin::scale {

/// What diagnose::look_at_samples() counts of pairs of samples; its densities are for the blocks to count.
/// @param values  with areas
/// @param depth   of the octree
/// @throws Error as SortedCloud::read
/// Reads some ten samples for each of diagnose::kSamples, and looks for the cells beside half of them.
void look_at_pairs(exec::Cpu& ex, const SortedCloud& cloud, const SampleValues& values, const KeyIndex& index,
                   int depth, diagnose::Counts& counts);

/// What diagnose::look_at_surface() counts.
/// @param meshes  with positions in the unit cube as the first column
/// @throws Error as BlockMeshes::read_triangles and SortedCloud::read
/// Reads diagnose::kTriangles triangles, and looks for the cells around each.
void look_at_triangles(const BlockMeshes& meshes, const KeyIndex& index, int far_depth, diagnose::Counts& counts);

}  // namespace pointskin::scale
