#include "exec/cpu_primitives.hpp"
#include "field/attributes_impl.hpp"

namespace pointskin::field {

template Channel make_channel(exec::Cpu&, std::string, AttributeType, exec::Buffer<float>);
template void interpolate(exec::Cpu&, const octree::OctreeData&, const AttributeSamples&, ArrayView<const Vec3f>,
                          const TakeValues&);

}  // namespace pointskin::field
