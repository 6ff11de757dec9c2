#include "exec/cpu_primitives.hpp"
#include "field/distance_impl.hpp"

namespace pointskin::field {

template void normalise(exec::Cpu&, ArrayView<Vec3f>);
template exec::Buffer<float> distance_to_planes(exec::Cpu&, const octree::OctreeData&, const TangentPlanes&);

}  // namespace pointskin::field
