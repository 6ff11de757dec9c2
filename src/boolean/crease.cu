#include "boolean/crease_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::boolean {

template Crease find_crease(exec::Cuda&, const field::FieldView&, const field::FieldView&);
template SheetSamples sample_sheets(exec::Cuda&, const field::FieldView&, const field::FieldView&, const Crease&,
                                    BooleanOp);
template double steepness_at(exec::Cuda&, const Crease&);

}  // namespace pointskin::boolean
