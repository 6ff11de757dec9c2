#include "exec/cpu_primitives.hpp"
#include "field/evaluate_impl.hpp"

namespace pointskin::field {

template void evaluate(exec::Cpu&, const FieldView&, ArrayView<const Vec3f>, ArrayView<float>);

}  // namespace pointskin::field
