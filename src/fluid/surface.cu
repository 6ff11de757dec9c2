#include "exec/cuda_primitives.cuh"
#include "fluid/surface_impl.hpp"

namespace pointskin::fluid {

template FluidSurface make_surface(exec::Cuda&, const Particles&, const FluidOptions&, FluidReport&);

}  // namespace pointskin::fluid
