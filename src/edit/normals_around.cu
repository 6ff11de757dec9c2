#include "edit/normals_around_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::edit {

template exec::Buffer<Vec3f> interpolate_normals(exec::Cuda&, const NormalSamples&, const octree::Frame&,
                                                 ArrayView<const Vec3f>);

}  // namespace pointskin::edit
