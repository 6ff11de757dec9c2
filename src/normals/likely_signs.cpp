#include "exec/cpu_primitives.hpp"
#include "normals/likely_signs_impl.hpp"

namespace pointskin::normals {

template LikelySigns spread_evidence(exec::Cpu&, const LinkedLines&, ArrayView<const std::int32_t>);

}  // namespace pointskin::normals
