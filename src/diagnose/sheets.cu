#include "diagnose/sheets_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::diagnose {

template double measure_noise(exec::Cuda&, const octree::OctreeView&, ArrayView<const Vec3f>, ArrayView<const Vec3f>);

}  // namespace pointskin::diagnose
