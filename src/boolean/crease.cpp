#include "boolean/crease_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::boolean {

template Crease find_crease(exec::Cpu&, const field::FieldView&, const field::FieldView&);
template SheetSamples sample_sheets(exec::Cpu&, const field::FieldView&, const field::FieldView&, const Crease&,
                                    BooleanOp);
template double steepness_at(exec::Cpu&, const Crease&);

}  // namespace pointskin::boolean
