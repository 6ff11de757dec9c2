#include "exec/cuda_primitives.cuh"
#include "poisson/relax_kernel.cuh"
#include "poisson/solve_impl.hpp"

namespace pointskin::poisson {

template Solution solve_poisson(exec::Cuda&, const octree::OctreeView&, ArrayView<const float>, const Screening&,
                                const SolveOptions&);
template double mean_at_samples(exec::Cuda&, const octree::OctreeData&, ArrayView<const float>, const SamplesView&);

}  // namespace pointskin::poisson
