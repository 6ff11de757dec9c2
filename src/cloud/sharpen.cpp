#include "cloud/sharpen_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::cloud {

template void sharpen(exec::Cpu&, const field::FieldView&, const field::FieldView&, BooleanOp, double,
                      const octree::OctreeView&, float, ArrayView<float>);

}  // namespace pointskin::cloud
