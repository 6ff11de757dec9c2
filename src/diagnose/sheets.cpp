#include "diagnose/sheets_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::diagnose {

template double measure_noise(exec::Cpu&, const octree::OctreeView&, ArrayView<const Vec3f>, ArrayView<const Vec3f>);

}  // namespace pointskin::diagnose
