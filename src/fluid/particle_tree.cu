#include "exec/cuda_primitives.cuh"
#include "fluid/particle_tree_impl.hpp"

namespace pointskin::fluid {

template ParticleTree build_particle_tree(exec::Cuda&, ArrayView<const Vec3f>, const CellGrid&);

}  // namespace pointskin::fluid
