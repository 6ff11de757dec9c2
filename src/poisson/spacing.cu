#include "exec/cuda_primitives.cuh"
#include "poisson/spacing_impl.hpp"

namespace pointskin::poisson {

template void evaluate_spacing(exec::Cuda&, const octree::OctreeData&, const Density&, ArrayView<const Vec3f>,
                               ArrayView<const Vec3f>, ArrayView<float>);
template float spacing_of_sparsest(exec::Cuda&, const octree::OctreeData&, const Density&, ArrayView<const Vec3f>,
                                   ArrayView<const Vec3f>, double);

}  // namespace pointskin::poisson
