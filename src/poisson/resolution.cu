#include "exec/cuda_primitives.cuh"
#include "poisson/resolution_impl.hpp"

namespace pointskin::poisson {

template Resolution find_resolution(exec::Cuda&, const octree::OctreeData&, Samples&);

}  // namespace pointskin::poisson
