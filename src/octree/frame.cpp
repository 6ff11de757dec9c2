#include "exec/cpu_primitives.hpp"
#include "octree/frame_impl.hpp"

namespace pointskin::octree {

template Frame fit_frame(exec::Cpu&, ArrayView<const Vec3f>, double);

}  // namespace pointskin::octree
