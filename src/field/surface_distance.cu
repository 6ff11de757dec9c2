#include "exec/cuda_primitives.cuh"
#include "field/surface_distance_impl.hpp"

namespace pointskin::field {

template void measure_distances(exec::Cuda&, const FieldView&, ArrayView<const Vec3f>, ArrayView<SurfaceDistance>);

}  // namespace pointskin::field
