#include "exec/cuda_primitives.cuh"
#include "surface/trim_impl.hpp"

namespace pointskin::surface {

template Surface trim_surface(exec::Cuda&, Surface, ArrayView<const float>, const TrimOptions&, TrimCounts&);

}  // namespace pointskin::surface
