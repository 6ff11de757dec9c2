#include "cloud/sharpen_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::cloud {

template void sharpen(exec::Cuda&, const field::FieldView&, const field::FieldView&, BooleanOp, double,
                      const octree::OctreeView&, float, ArrayView<float>);

}  // namespace pointskin::cloud
