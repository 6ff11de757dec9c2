#include "exec/cuda_primitives.cuh"
#include "normals/estimate_normals_impl.hpp"

namespace pointskin::normals {

template NormalLines estimate_lines(exec::Cuda&, const octree::SearchView&, ArrayView<const std::int32_t>);

}  // namespace pointskin::normals
