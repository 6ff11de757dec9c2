#include "exec/cpu_primitives.hpp"
#include "field/labels_impl.hpp"

namespace pointskin::field {

template void find_labels(exec::Cpu&, const octree::OctreeData&, const AttributeSamples&, ArrayView<const Vec3f>,
                          const TakeValues&);

}  // namespace pointskin::field
