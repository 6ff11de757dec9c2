#include "exec/cuda_primitives.cuh"
#include "octree/engine_impl.hpp"

namespace pointskin::octree {

std::shared_ptr<const Octree::Impl> build_on_cuda(const std::vector<Vec3f>& positions, const OctreeOptions& options,
                                                  int index) {
  return std::make_shared<OctreeOn<exec::Cuda>>(std::make_unique<exec::Cuda>(index), positions, options);
}

}  // namespace pointskin::octree
