#include "edit/placement_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::edit {

template void place(exec::Cuda&, const Placement&, ArrayView<Vec3f>, ArrayView<Vec3f>);
template std::optional<Placement> find_snap(exec::Cuda&, const SnapTarget&, ArrayView<const Vec3f>,
                                            ArrayView<const Vec3f>);

}  // namespace pointskin::edit
