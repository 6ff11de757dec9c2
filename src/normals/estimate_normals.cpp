#include "exec/cpu_primitives.hpp"
#include "normals/estimate_normals_impl.hpp"

namespace pointskin::normals {

template NormalLines estimate_lines(exec::Cpu&, const octree::SearchView&, ArrayView<const std::int32_t>);

}  // namespace pointskin::normals
