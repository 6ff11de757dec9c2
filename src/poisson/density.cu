#include "exec/cuda_primitives.cuh"
#include "poisson/density_impl.hpp"

namespace pointskin::poisson {

template Density splat_density(exec::Cuda&, const octree::OctreeData&, ArrayView<const Vec3f>);
template void weigh_samples(exec::Cuda&, const octree::OctreeData&, const Density&, const WeighOptions&, Samples&);
template exec::Buffer<float> confidence_weights(exec::Cuda&, ArrayView<const Vec3f>);
template void evaluate_density(exec::Cuda&, const octree::OctreeData&, const Density&, ArrayView<const Vec3f>,
                               ArrayView<float>);

}  // namespace pointskin::poisson
