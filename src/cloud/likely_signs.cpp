#include "cloud/likely_signs_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::cloud {

template LikelySigns spread_evidence(exec::Cpu&, const LinkedLines&, ArrayView<const std::int32_t>);

}  // namespace pointskin::cloud
