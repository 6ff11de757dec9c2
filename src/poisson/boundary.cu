#include "exec/cuda_primitives.cuh"
#include "poisson/boundary_impl.hpp"

namespace pointskin::poisson {

template exec::Buffer<std::uint8_t> free_unknowns(exec::Cuda&, const octree::OctreeView&, bool);

}  // namespace pointskin::poisson
