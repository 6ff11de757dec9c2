#include "exec/cpu_primitives.hpp"
#include "surface/trim_impl.hpp"

namespace pointskin::surface {

template Surface trim_surface(exec::Cpu&, Surface, ArrayView<const float>, const TrimOptions&, TrimCounts&);

}  // namespace pointskin::surface
