#include "exec/cpu_primitives.hpp"
#include "poisson/boundary_impl.hpp"

namespace pointskin::poisson {

template exec::Buffer<std::uint8_t> free_unknowns(exec::Cpu&, const octree::OctreeView&, bool);

}  // namespace pointskin::poisson
