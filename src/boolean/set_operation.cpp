#include "boolean/set_operation_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::boolean {

template void find_places(exec::Cpu&, ArrayView<const field::SurfaceDistance>, ArrayView<const field::SurfaceDistance>,
                          float, ArrayView<Place>);
template FateCounts count_fates(exec::Cpu&, ArrayView<const Place>, BooleanOp, bool);
template void gather_kept(exec::Cpu&, const OrientedPoints&, ArrayView<const Place>, BooleanOp, bool, ArrayView<Vec3f>,
                          ArrayView<Vec3f>);

}  // namespace pointskin::boolean
