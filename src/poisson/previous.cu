#include "exec/cuda_primitives.cuh"
#include "poisson/previous_impl.hpp"

namespace pointskin::poisson {

template exec::Buffer<std::int32_t> match_bricks(exec::Cuda&, const octree::OctreeView&, const octree::OctreeView&);

}  // namespace pointskin::poisson
