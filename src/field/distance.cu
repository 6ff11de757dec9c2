#include "exec/cuda_primitives.cuh"
#include "field/distance_impl.hpp"

namespace pointskin::field {

template void normalise(exec::Cuda&, ArrayView<Vec3f>);
template exec::Buffer<float> distance_to_planes(exec::Cuda&, const octree::OctreeData&, const TangentPlanes&);

}  // namespace pointskin::field
