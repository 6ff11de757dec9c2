#include "diagnose/look_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::diagnose {

template exec::Buffer<Counts> make_counts(exec::Cpu&);
template void look_at_samples(exec::Cpu&, const octree::OctreeView&, const poisson::Density&,
                              const poisson::SamplesView&, exec::Buffer<Counts>&);
template void look_at_field(exec::Cpu&, const field::FieldView&, const poisson::SamplesView&, exec::Buffer<Counts>&);
template void look_at_surface(exec::Cpu&, const octree::OctreeView&, int, const surface::Surface&,
                              const exec::Buffer<Counts>&);
template Counts read_counts(exec::Cpu&, const exec::Buffer<Counts>&);

}  // namespace pointskin::diagnose
