#include "exec/cpu_primitives.hpp"
#include "poisson/divergence_impl.hpp"

namespace pointskin::poisson {

template exec::Buffer<float> splat_divergence(exec::Cpu&, const octree::OctreeData&, const SamplesView&,
                                              const Resolution&);

}  // namespace pointskin::poisson
