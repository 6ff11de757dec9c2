#include <pointskin/suggest_device.hpp>

#include "exec/cpu.hpp"
#include "reconstruct/run_seconds.hpp"

namespace pointskin {

Device suggest_device(const Cloud& cloud, const Options& options, int threads) {
  validate(options);
  const Device cpu = Device::cpu(threads);
  if (!built_with_cuda() || cloud.size() == 0) return cpu;
  exec::Cpu ex(threads);
  const detail::RunWork work = detail::guess_work(ex, cloud, options);
  const bool cpu_is_first = detail::seconds_on_cpu(work, ex.threads()) <= detail::seconds_on_gpu(work);
  return cpu_is_first ? cpu : Device::automatic(threads);
}

}  // namespace pointskin
