#include "exec/cpu_primitives.hpp"
#include "poisson/spacing_impl.hpp"

namespace pointskin::poisson {

template void evaluate_spacing(exec::Cpu&, const octree::OctreeData&, const Density&, ArrayView<const Vec3f>,
                               ArrayView<const Vec3f>, ArrayView<float>);
template float spacing_of_sparsest(exec::Cpu&, const octree::OctreeData&, const Density&, ArrayView<const Vec3f>,
                                   ArrayView<const Vec3f>, double);

}  // namespace pointskin::poisson
