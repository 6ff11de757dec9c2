// Points of a block whose nearest sample may lie outside of the samples that the block has, and where it lies then. On the host.
#pragma once

#include <cstdint>
#include <vector>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "exec/cpu.hpp"
#include "scale/block_plan.hpp"
#include "scale/sample_runs.hpp"

namespace pointskin::scale {

/// Places of such points, ascending.
/// @param points   (m) in the unit cube
/// @param keys     (m) of the vertices that these are: those that are neither the block's own nor on an upper face of the cube are
///                 left out; (0): all count
/// @param squared  (m) distances to the nearest samples of the block and its ring
std::vector<std::int32_t> find_far_points(exec::Cpu& ex, const BlockPlan& plan, const BlockRange& own,
                                          ArrayView<const Vec3f> points, ArrayView<const std::uint64_t> keys,
                                          ArrayView<const float> squared);

/// The samples of the cells of level K among which the nearest one of each of these points is. Ascending. A byte a cell of scratch.
std::vector<SampleRun> samples_around(exec::Cpu& ex, const BlockPlan& plan, ArrayView<const Vec3f> points);

/// The same samples in parts of at most `most` each, in their order.
std::vector<std::vector<SampleRun>> cut_into_parts(const std::vector<SampleRun>& runs, std::int64_t most);

}  // namespace pointskin::scale
