#include "exec/cuda_primitives.cuh"
#include "field/attributes_impl.hpp"

namespace pointskin::field {

template ValueRange find_range(exec::Cuda&, const TypedView&, ArrayView<const std::int32_t>);
template Channel make_channel(exec::Cuda&, std::size_t, const TypedView&, const ValueRange&,
                              ArrayView<const std::int32_t>);
template void interpolate(exec::Cuda&, const octree::OctreeData&, const AttributeSamples&, ArrayView<const Vec3f>,
                          const TakeValues&);

}  // namespace pointskin::field
