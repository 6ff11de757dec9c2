#include "deform/resample_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::deform {

template Resampled resample(exec::Cpu&, const MapView&, const RestSamples&, const RestSurface&);
template void map_samples(exec::Cpu&, const MapView&, ArrayView<Vec3f>, ArrayView<Vec3f>);

}  // namespace pointskin::deform
