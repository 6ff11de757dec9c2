#include "exec/cuda_primitives.cuh"
#include "normals/neighbours_impl.hpp"

namespace pointskin::normals {

template exec::Buffer<std::int32_t> find_neighbours(exec::Cuda&, const octree::SearchView&);

}  // namespace pointskin::normals
