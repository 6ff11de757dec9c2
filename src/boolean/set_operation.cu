#include "boolean/set_operation_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::boolean {

template void find_places(exec::Cuda&, ArrayView<const field::SurfaceDistance>, ArrayView<const field::SurfaceDistance>,
                          float, ArrayView<Place>);
template FateCounts count_fates(exec::Cuda&, ArrayView<const Place>, BooleanOp, bool);
template void gather_kept(exec::Cuda&, const OrientedPoints&, ArrayView<const Place>, BooleanOp, bool, ArrayView<Vec3f>,
                          ArrayView<Vec3f>);

}  // namespace pointskin::boolean
