#include "edit/normals_around_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::edit {

template exec::Buffer<Vec3f> interpolate_normals(exec::Cpu&, const NormalSamples&, const octree::Frame&,
                                                 ArrayView<const Vec3f>);

}  // namespace pointskin::edit
