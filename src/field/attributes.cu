#include "exec/cuda_primitives.cuh"
#include "field/attributes_impl.hpp"

namespace pointskin::field {

template Channel make_channel(exec::Cuda&, std::string, AttributeType, exec::Buffer<float>);
template void interpolate(exec::Cuda&, const octree::OctreeData&, const AttributeSamples&, ArrayView<const Vec3f>,
                          const TakeValues&);

}  // namespace pointskin::field
