#include "cloud/neighbours_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::cloud {

template exec::Buffer<std::int32_t> find_neighbours(exec::Cpu&, const octree::SearchView&);

}  // namespace pointskin::cloud
