#include "exec/cpu_primitives.hpp"
#include "normals/neighbours_impl.hpp"

namespace pointskin::normals {

template exec::Buffer<std::int32_t> find_neighbours(exec::Cpu&, const octree::SearchView&);

}  // namespace pointskin::normals
