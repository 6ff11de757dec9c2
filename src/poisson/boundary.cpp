#include "exec/cpu_primitives.hpp"
#include "poisson/boundary_impl.hpp"

namespace pointskin::poisson {

template exec::Buffer<std::uint8_t> free_unknowns(exec::Cpu&, const octree::OctreeData&, bool);

}  // namespace pointskin::poisson
