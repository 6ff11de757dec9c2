#include "exec/cpu_primitives.hpp"
#include "surface/extract_impl.hpp"

namespace pointskin::surface {

template Surface extract_surface(exec::Cpu&, const field::FieldView&, const ExtractOptions&);

}  // namespace pointskin::surface
