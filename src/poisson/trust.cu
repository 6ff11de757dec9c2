#include "exec/cuda_primitives.cuh"
#include "poisson/trust_impl.hpp"
#include "poisson/trust_kernel.cuh"

namespace pointskin::poisson {

template void weigh_trust(exec::Cuda&, const octree::OctreeData&, Samples&);

}  // namespace pointskin::poisson
