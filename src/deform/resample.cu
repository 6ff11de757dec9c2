#include "deform/resample_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::deform {

template Resampled resample(exec::Cuda&, const MapView&, const RestSamples&, const RestSurface&);
template void map_samples(exec::Cuda&, const MapView&, ArrayView<Vec3f>, ArrayView<Vec3f>);

}  // namespace pointskin::deform
