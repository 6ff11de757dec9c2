#include "exec/cuda_primitives.cuh"
#include "field/offset_impl.hpp"

namespace pointskin::field {

template OffsetField make_offset(exec::Cuda&, const SurfaceOfField&, const octree::Frame&, int, double);

}  // namespace pointskin::field
