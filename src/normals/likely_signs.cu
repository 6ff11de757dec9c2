#include "exec/cuda_primitives.cuh"
#include "normals/likely_signs_impl.hpp"

namespace pointskin::normals {

template LikelySigns spread_evidence(exec::Cuda&, const LinkedLines&, ArrayView<const std::int32_t>);

}  // namespace pointskin::normals
