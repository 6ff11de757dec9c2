#include <pointskin/error.hpp>
#include <pointskin/processors.hpp>
#include <pointskin/suggest_device.hpp>

#include <algorithm>

#include "exec/any_space.hpp"
#include "exec/cpu.hpp"
#include "reconstruct/run_seconds.hpp"

namespace pointskin {
namespace {

/// Peaks of runs are 61 to 66 bytes a node.
constexpr double kMostBytesPerNode = 80;

/// One GPU; or all as one where it has not enough memory, and they have.
Device gpu_for(const detail::RunWork& work, int threads) {
  const Device one = Device::automatic(threads);
  if (one.kind == DeviceKind::cpu) return one;
  const double needed = kMostBytesPerNode * work.nodes;
  const auto holds = [&](const Device& device) { return needed <= static_cast<double>(device.available_bytes()); };
  if (holds(one)) return one;
  Device all = Device::parse("cuda:all");
  all.threads = threads;
  return exec::can_work_together(all) && holds(all) ? all : one;
}

}  // namespace

Device suggest_device(const Cloud& cloud, const Options& options, int threads) {
  validate(options);
  const Device cpu = Device::cpu(threads);
  if (!built_with_cuda() || cloud.size() == 0) return cpu;
  exec::Cpu ex(threads);
  try {
    const detail::RunWork work = detail::guess_work(ex, cloud, options);
    const double on_cpu = detail::seconds_on_cpu(work, std::min(ex.threads(), usable_processors()));
    return on_cpu <= detail::seconds_on_gpu(work) ? cpu : gpu_for(work, threads);
  } catch (const Error& error) {
    if (error.code() == ErrorCode::interrupted) throw;
    return cpu;  // the run will tell what is wrong with the points
  }
}

}  // namespace pointskin
