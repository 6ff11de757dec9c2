#include "exec/cuda_primitives.cuh"
#include "step_impl.hpp"
#include "totals_impl.hpp"

namespace pointskin::simulation {

template void substep(exec::Cuda&, Particles&, const StepSettings&, const fluid::CellGrid&);
template Totals totals_of(exec::Cuda&, const Particles&, const Solids&);
template void to_world(exec::Cuda&, const Particles&, float, const WorldViews&);

}  // namespace pointskin::simulation
