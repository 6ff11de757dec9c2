#include "scale/far_points.hpp"

#include <algorithm>
#include <atomic>
#include <cmath>
#include <cstddef>

#include "exec/cpu_primitives.hpp"
#include "octree/keys.hpp"
#include "scale/near_cells.hpp"

namespace pointskin::scale {

std::vector<std::int32_t> find_far_points(exec::Cpu& ex, const BlockPlan& plan, const BlockRange& own,
                                          ArrayView<const Vec3f> points, ArrayView<const std::uint64_t> keys,
                                          ArrayView<const float> squared) {
  constexpr double kSure = 1 - 1e-4;  // distances are rounded
  const double reach = kSure * std::ldexp(plan.ring(), -plan.level());
  const std::uint64_t beyond = std::uint64_t{1} << 3 * plan.depth();  // vertices on upper faces
  const auto is_far = [&](std::int64_t i) {
    if (!keys.empty() && keys[i] < beyond && (keys[i] < own.begin || keys[i] >= own.end)) return false;
    if (!(static_cast<double>(squared[i]) < reach * reach)) return true;
    const Vec3f& p = points[i];
    return !plan.has_all_around(own, octree::cell_key(octree::point_key(p.x, p.y, p.z), plan.level()));
  };
  const exec::Buffer<std::int32_t> far = select(ex, "scale.far_points", points.size, is_far);
  return {far.data(), far.data() + far.size()};
}

std::vector<SampleRun> samples_around(exec::Cpu& ex, const BlockPlan& plan, ArrayView<const Vec3f> points) {
  const NearCells cells(plan.level(), plan.cells());
  std::vector<std::atomic<bool>> is_near(plan.cells().size());  // in the middle of a dome, all of its cells are
  for_each_long(ex, "scale.far_points", points.size, [&](std::int64_t i) {
    for (const std::int64_t cell : cells.around(points[i]))
      is_near[static_cast<std::size_t>(cell)].store(true, std::memory_order_relaxed);
  });
  std::vector<SampleRun> runs;
  for (std::size_t cell = 0; cell < is_near.size(); ++cell) {
    if (!is_near[cell]) continue;
    if (!runs.empty() && runs.back().end == plan.first()[cell])
      runs.back().end = plan.first()[cell + 1];
    else
      runs.push_back({plan.first()[cell], plan.first()[cell + 1]});
  }
  return runs;
}

std::vector<std::vector<SampleRun>> cut_into_parts(const std::vector<SampleRun>& runs, std::int64_t most) {
  std::vector<std::vector<SampleRun>> parts;
  std::int64_t room = 0;
  for (SampleRun run : runs)
    while (run.begin < run.end) {
      if (room == 0) {
        parts.emplace_back();
        room = most;
      }
      const std::int64_t end = std::min(run.end, run.begin + room);
      parts.back().push_back({run.begin, end});
      room -= end - run.begin;
      run.begin = end;
    }
  return parts;
}

}  // namespace pointskin::scale
