#include "exec/cpu_primitives.hpp"
#include "field/surface_distance_impl.hpp"

namespace pointskin::field {

template void measure_distances(exec::Cpu&, const FieldView&, ArrayView<const Vec3f>, ArrayView<SurfaceDistance>);

}  // namespace pointskin::field
