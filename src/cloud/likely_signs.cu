#include "cloud/likely_signs_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::cloud {

template LikelySigns spread_evidence(exec::Cuda&, const LinkedLines&, ArrayView<const std::int32_t>);

}  // namespace pointskin::cloud
