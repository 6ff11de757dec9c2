#include "exec/cuda_primitives.cuh"
#include "field/labels_impl.hpp"

namespace pointskin::field {

template void find_labels(exec::Cuda&, const octree::OctreeData&, const AttributeSamples&, ArrayView<const Vec3f>,
                          const TakeValues&);

}  // namespace pointskin::field
