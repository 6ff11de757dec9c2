#include "exec/cpu_primitives.hpp"
#include "poisson/previous_impl.hpp"

namespace pointskin::poisson {

template exec::Buffer<std::int32_t> match_bricks(exec::Cpu&, const octree::OctreeView&, const octree::OctreeView&);

}  // namespace pointskin::poisson
