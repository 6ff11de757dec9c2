#include "reconstruct/run_seconds.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <vector>

#include "exec/cpu_primitives.hpp"
#include "octree/frame.hpp"
#include "octree/keys.hpp"
#include "octree/strays.hpp"

namespace pointskin::detail {
namespace {

constexpr std::int64_t kSample = std::int64_t{1} << 18;

struct PointKey {
  octree::Frame frame;
  ArrayView<const Vec3f> positions;
  ArrayView<std::uint64_t> keys;
  void operator()(std::int64_t i) const {
    const Vec3f p = frame.to_unit(positions[i]);
    keys[i] = octree::point_key(p.x, p.y, p.z);
  }
};

/// Every n-th point, all of a small cloud, but those that are not finite.
std::vector<Vec3f> sample_of(const Cloud& cloud) {
  const std::int64_t step = (cloud.size() + kSample - 1) / kSample;
  std::vector<Vec3f> sample;
  sample.reserve(static_cast<std::size_t>(cloud.size() / step + 1));
  for (std::int64_t i = 0; i < cloud.size(); i += step) {
    const Vec3f& p = cloud.positions[static_cast<std::size_t>(i)];
    if (std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z)) sample.push_back(p);
  }
  return sample;
}

octree::Frame frame_of(exec::Cpu& ex, ArrayView<const Vec3f> positions, const Options& options) {
  if (options.keep_strays) return octree::fit_frame(ex, positions, options.scale);
  return octree::frame_around(octree::find_strays(ex, positions).core, options.scale);
}

/// Cells of every level with a point in them; the level is the index.
std::array<std::int64_t, octree::kPointBits + 1> count_cells(ArrayView<const std::uint64_t> sorted) {
  std::array<std::int64_t, octree::kPointBits + 1> cells{};
  cells[0] = 1;
  for (std::int64_t i = 1; i < sorted.size; ++i)
    if (const std::uint64_t differ = sorted[i] ^ sorted[i - 1]; differ != 0)
      ++cells[static_cast<std::size_t>(octree::kPointBits - (std::bit_width(differ) - 1) / 3)];
  for (std::size_t level = 1; level < cells.size(); ++level) cells[level] += cells[level - 1];
  return cells;
}

/// Cells of every level that the surface passes, if it were sampled without end.
class SurfaceCells {
 public:
  SurfaceCells(exec::Cpu& ex, const Cloud& cloud, const Options& options) {
    constexpr std::int64_t kFilled = 8;  // points a cell by which hardly any cell of the surface is missed
    const std::vector<Vec3f> sample = sample_of(cloud);
    const ArrayView<const Vec3f> positions{sample.data(), static_cast<std::int64_t>(sample.size())};
    if (positions.empty()) throw Error(ErrorCode::empty_result, "no point is finite");
    auto keys = exec::make_buffer<std::uint64_t>(ex, positions.size);
    const octree::Frame frame = frame_of(ex, positions, options);
    for_each(ex, "suggest.keys", keys.size(), PointKey{frame, positions, keys.view()});
    sort_keys(ex, "suggest.sort", keys, 3 * octree::kPointBits);
    const auto cells = count_cells(keys.cview());
    while (level_ + 1 < static_cast<int>(cells.size()) &&
           cells[static_cast<std::size_t>(level_) + 1] * kFilled <= positions.size)
      ++level_;
    cells_ = static_cast<double>(cells[static_cast<std::size_t>(level_)]);
  }
  [[nodiscard]] double of(int level) const { return cells_ * std::pow(4.0, level - level_); }

 private:
  int level_ = 0;
  double cells_ = 0;
};

/// The depth that suggest_depth would take of dense clean points: about one a cell.
int supported_depth(const SurfaceCells& surface, double points) {
  int depth = 4;
  while (depth < 16 && surface.of(depth) < points) ++depth;
  return depth;
}

/// Nodes of a level, which lie around cells with points: (3 cells)^3, in bricks of 8.
double nodes_of(const SurfaceCells& surface, double points, int level) {
  constexpr double kNodesPerCell = 4.35;  // of a surface whose every cell has points
  constexpr double kNodesPerPoint = 111;  // of a point that is alone
  const double all = kNodesPerCell * surface.of(level);
  return std::min(all / (1 + all / (kNodesPerPoint * points)), std::pow(8.0, level));
}

struct Times {
  double start;      ///< s
  double per_point;  ///< s
  double per_node;   ///< s
};

/// The mean over 61 and 120 runs from file to file on two machines (docs/decisions/0053): five generated shapes of 10^4 to 10^7 points
/// and a scan, depths 6 to 11. The CPU is that of an H200's host.
constexpr Times kCpu{0.0235, 0.07e-6, 0.051e-6};
constexpr double kCpuThreads = 16;
constexpr double kCpuGain = 0.86;  ///< twice the threads are 2^0.86 as fast
constexpr Times kGpu{0.36, 0.017e-6, 0.009e-6};

}  // namespace

RunWork guess_work(exec::Cpu& ex, const Cloud& cloud, const Options& options) {
  const auto points = static_cast<double>(cloud.size());
  const SurfaceCells surface(ex, cloud, options);
  const int depth = options.depth == Options::kAutomaticDepth ? supported_depth(surface, points) : options.depth;
  double nodes = 0;
  for (int level = 0; level <= depth; ++level)
    nodes += level <= octree::kCompleteDepth ? std::pow(8.0, level) : nodes_of(surface, points, level);
  return {points, nodes};
}

double seconds_on_cpu(const RunWork& work, int threads) {
  const double slower = std::pow(kCpuThreads / threads, kCpuGain);
  return kCpu.start + slower * (kCpu.per_point * work.points + kCpu.per_node * work.nodes);
}

double seconds_on_gpu(const RunWork& work) {
  return kGpu.start + kGpu.per_point * work.points + kGpu.per_node * work.nodes;
}

}  // namespace pointskin::detail
