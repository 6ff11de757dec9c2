#include "exec/cpu_primitives.hpp"
#include "octree/search_impl.hpp"

namespace pointskin::octree {

template void find_nearest(exec::Cpu&, const SearchView&, ArrayView<const Vec3f>, int, ArrayView<std::int32_t>,
                           ArrayView<float>);
template WithinRadius find_within(exec::Cpu&, const SearchView&, ArrayView<const Vec3f>, float);

}  // namespace pointskin::octree
