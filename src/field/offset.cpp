#include "exec/cpu_primitives.hpp"
#include "field/offset_impl.hpp"

namespace pointskin::field {

template OffsetField make_offset(exec::Cpu&, const SurfaceOfField&, const octree::Frame&, int, double);

}  // namespace pointskin::field
