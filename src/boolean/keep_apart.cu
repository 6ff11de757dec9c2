#include "boolean/keep_apart_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::boolean {

template void keep_apart(exec::Cuda&, const field::FieldView&, const field::FieldView&, double,
                         const octree::OctreeView&, ArrayView<float>);

}  // namespace pointskin::boolean
