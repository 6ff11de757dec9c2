#include "exec/cuda_primitives.cuh"
#include "poisson/divergence_impl.hpp"
#include "poisson/divergence_kernel.cuh"
#include "poisson/splat_kernel.cuh"

namespace pointskin::poisson {

template exec::Buffer<float> splat_divergence(exec::Cuda&, const octree::OctreeData&, const SamplesView&,
                                              const Resolution&);

}  // namespace pointskin::poisson
