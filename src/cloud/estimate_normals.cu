#include "cloud/estimate_normals_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::cloud {

template NormalLines estimate_lines(exec::Cuda&, const octree::SearchView&, ArrayView<const std::int32_t>);

}  // namespace pointskin::cloud
