#include "exec/cuda_primitives.cuh"
#include "octree/search_impl.hpp"

namespace pointskin::octree {

template void find_nearest(exec::Cuda&, const SearchView&, ArrayView<const Vec3f>, int, ArrayView<std::int32_t>,
                           ArrayView<float>);
template void find_nearest_place(exec::Cuda&, const SearchView&, ArrayView<const Vec3f>, ArrayView<std::int32_t>);
template WithinRadius find_within(exec::Cuda&, const SearchView&, ArrayView<const Vec3f>, float);

}  // namespace pointskin::octree
