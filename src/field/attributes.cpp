#include "exec/cpu_primitives.hpp"
#include "field/attributes_impl.hpp"

namespace pointskin::field {

template ValueRange find_range(exec::Cpu&, const TypedView&, ArrayView<const std::int32_t>);
template Channel make_channel(exec::Cpu&, std::size_t, const TypedView&, const ValueRange&,
                              ArrayView<const std::int32_t>);
template void interpolate(exec::Cpu&, const octree::OctreeData&, const AttributeSamples&, ArrayView<const Vec3f>,
                          const TakeValues&);

}  // namespace pointskin::field
