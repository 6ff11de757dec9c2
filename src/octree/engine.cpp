#include <pointskin/error.hpp>

#include "exec/cpu_primitives.hpp"
#include "octree/engine_impl.hpp"

namespace pointskin::octree {

std::shared_ptr<const Octree::Impl> build_on_cpu(const std::vector<Vec3f>& positions, const OctreeOptions& options,
                                                 int threads) {
  return std::make_shared<OctreeOn<exec::Cpu>>(std::make_unique<exec::Cpu>(threads), positions, options);
}

#ifndef POINTSKIN_HAS_CUDA
std::shared_ptr<const Octree::Impl> build_on_cuda(const std::vector<Vec3f>& /*positions*/,
                                                  const OctreeOptions& /*options*/, int /*index*/) {
  throw Error(ErrorCode::device_unavailable, "this build has no GPU support; configure with -DPOINTSKIN_CUDA=ON");
}
#endif

}  // namespace pointskin::octree
