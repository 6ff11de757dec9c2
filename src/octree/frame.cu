#include "exec/cuda_primitives.cuh"
#include "octree/frame_impl.hpp"

namespace pointskin::octree {

template Bounds box_around(exec::Cuda&, ArrayView<const Vec3f>);
template Frame fit_frame(exec::Cuda&, ArrayView<const Vec3f>, double);

}  // namespace pointskin::octree
