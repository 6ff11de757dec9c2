#include "cloud/neighbours_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::cloud {

template exec::Buffer<std::int32_t> find_neighbours(exec::Cuda&, const octree::SearchView&);

}  // namespace pointskin::cloud
