#include "exec/cpu_primitives.hpp"
#include "poisson/resolution_impl.hpp"

namespace pointskin::poisson {

template Resolution find_resolution(exec::Cpu&, const octree::OctreeData&, Samples&);

}  // namespace pointskin::poisson
