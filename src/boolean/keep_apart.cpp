#include "boolean/keep_apart_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::boolean {

template void keep_apart(exec::Cpu&, const field::FieldView&, const field::FieldView&, double,
                         const octree::OctreeView&, ArrayView<float>);

}  // namespace pointskin::boolean
