#include "cloud/estimate_normals_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::cloud {

template NormalLines estimate_lines(exec::Cpu&, const octree::SearchView&, ArrayView<const std::int32_t>);

}  // namespace pointskin::cloud
