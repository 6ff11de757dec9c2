#include "exec/cuda_primitives.cuh"
#include "octree/strays_impl.hpp"

namespace pointskin::octree {

template StrayPoints find_strays(exec::Cuda&, ArrayView<const Vec3f>);
template exec::Buffer<std::int32_t> without_strays(exec::Cuda&, std::int64_t, const StrayPoints&);

}  // namespace pointskin::octree
