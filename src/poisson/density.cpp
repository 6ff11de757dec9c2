#include "exec/cpu_primitives.hpp"
#include "poisson/density_impl.hpp"

namespace pointskin::poisson {

template Density splat_density(exec::Cpu&, const octree::OctreeData&, ArrayView<const Vec3f>);
template void weigh_samples(exec::Cpu&, const octree::OctreeData&, const Density&, const WeighOptions&, Samples&);
template exec::Buffer<float> confidence_weights(exec::Cpu&, ArrayView<const Vec3f>);
template void evaluate_density(exec::Cpu&, const octree::OctreeData&, const Density&, ArrayView<const Vec3f>,
                               ArrayView<float>);

}  // namespace pointskin::poisson
