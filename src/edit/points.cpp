#include "edit/points_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::detail {

template EditedPoints edit_points(exec::Cpu&, const EditInput&, const Operation&);
template DevicePoints copy_used(exec::Cpu&, const DevicePoints&);
template double mean_length(exec::Cpu&, ArrayView<const Vec3f>);

}  // namespace pointskin::detail
