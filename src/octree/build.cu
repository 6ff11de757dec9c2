#include "exec/cuda_primitives.cuh"
#include "octree/build_impl.hpp"

namespace pointskin::octree {

template SortedPoints sort_points(exec::Cuda&, ArrayView<const Vec3f>, ArrayView<const std::uint64_t>);
template OctreeData build_octree(exec::Cuda&, ArrayView<const std::uint64_t>, int);

}  // namespace pointskin::octree
