#include "exec/cpu_primitives.hpp"
#include "poisson/trust_impl.hpp"

namespace pointskin::poisson {

template void weigh_trust(exec::Cpu&, const octree::OctreeData&, Samples&);

}  // namespace pointskin::poisson
