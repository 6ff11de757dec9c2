#include "diagnose/look_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::diagnose {

template exec::Buffer<Counts> make_counts(exec::Cuda&);
template void look_at_samples(exec::Cuda&, const octree::OctreeView&, const poisson::Density&,
                              const poisson::SamplesView&, exec::Buffer<Counts>&);
template void look_at_field(exec::Cuda&, const field::FieldView&, const poisson::SamplesView&, exec::Buffer<Counts>&);
template void look_at_surface(exec::Cuda&, const octree::OctreeView&, int, const surface::Surface&,
                              const exec::Buffer<Counts>&);
template Counts read_counts(exec::Cuda&, const exec::Buffer<Counts>&);

}  // namespace pointskin::diagnose
