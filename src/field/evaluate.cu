#include "exec/cuda_primitives.cuh"
#include "field/evaluate_impl.hpp"

namespace pointskin::field {

template void evaluate(exec::Cuda&, const FieldView&, ArrayView<const Vec3f>, ArrayView<float>);

}  // namespace pointskin::field
