#include "exec/cpu_primitives.hpp"
#include "normals/sign_graph_impl.hpp"

namespace pointskin::normals {

template SignPatches start_patches(exec::Cpu&, const LinkedLines&, bool);
template void merge_patches(exec::Cpu&, const MergeRule&, SignPatches&);
template void measure_agreement(exec::Cpu&, const LinkedLines&, ArrayView<const std::int32_t>, ArrayView<float>);

}  // namespace pointskin::normals
