#include "exec/cpu_primitives.hpp"
#include "octree/search_impl.hpp"

namespace pointskin::octree {

template void find_nearest(exec::Cpu&, const SearchView&, ArrayView<const Vec3f>, int, ArrayView<std::int32_t>,
                           ArrayView<float>);
template void find_nearest_place(exec::Cpu&, const SearchView&, ArrayView<const Vec3f>, ArrayView<std::int32_t>);
template WithinRadius find_within(exec::Cpu&, const SearchView&, ArrayView<const Vec3f>, float);

}  // namespace pointskin::octree
