#include "cloud/set_operation_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::cloud {

template void find_places(exec::Cuda&, ArrayView<const field::SurfaceDistance>, ArrayView<const field::SurfaceDistance>,
                          float, ArrayView<Place>);
template FateCounts count_fates(exec::Cuda&, ArrayView<const Place>, BooleanOp, bool);
template void gather_kept(exec::Cuda&, const OrientedPoints&, ArrayView<const Place>, BooleanOp, bool, ArrayView<Vec3f>,
                          ArrayView<Vec3f>);

}  // namespace pointskin::cloud
