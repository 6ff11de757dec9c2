#include "edit/points_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::detail {

template EditedPoints edit_points(exec::Cuda&, const EditInput&, const Operation&);
template DevicePoints copy_used(exec::Cuda&, const DevicePoints&);
template double mean_length(exec::Cuda&, ArrayView<const Vec3f>);

}  // namespace pointskin::detail
