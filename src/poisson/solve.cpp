#include "exec/cpu_primitives.hpp"
#include "poisson/solve_impl.hpp"

namespace pointskin::poisson {

template Solution solve_poisson(exec::Cpu&, const octree::OctreeView&, ArrayView<const float>, const Screening&,
                                const SolveOptions&);
template double mean_at_samples(exec::Cpu&, const octree::OctreeData&, ArrayView<const float>, const SamplesView&);

}  // namespace pointskin::poisson
