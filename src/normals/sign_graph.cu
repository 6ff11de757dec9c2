#include "exec/cuda_primitives.cuh"
#include "normals/sign_graph_impl.hpp"

namespace pointskin::normals {

template SignPatches start_patches(exec::Cuda&, const LinkedLines&, bool);
template void merge_patches(exec::Cuda&, const MergeRule&, SignPatches&);
template void measure_agreement(exec::Cuda&, const LinkedLines&, ArrayView<const std::int32_t>, ArrayView<float>);

}  // namespace pointskin::normals
