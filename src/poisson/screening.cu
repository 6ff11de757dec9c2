#include "exec/cuda_primitives.cuh"
#include "poisson/screening_impl.hpp"

namespace pointskin::poisson {

template Screening collapse_samples(exec::Cuda&, const octree::OctreeData&, const SamplesView&);

}  // namespace pointskin::poisson
