#include "exec/cpu_primitives.hpp"
#include "step_impl.hpp"
#include "totals_impl.hpp"

namespace pointskin::simulation {

template void substep(exec::Cpu&, Particles&, const StepSettings&, const fluid::CellGrid&);
template Totals totals_of(exec::Cpu&, const Particles&, const Solids&);
template void to_world(exec::Cpu&, const Particles&, float, const WorldViews&);

}  // namespace pointskin::simulation
