#include "exec/cpu_primitives.hpp"
#include "poisson/screening_impl.hpp"

namespace pointskin::poisson {

template Screening collapse_samples(exec::Cpu&, const octree::OctreeData&, const SamplesView&);

}  // namespace pointskin::poisson
