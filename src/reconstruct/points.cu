#include "exec/cuda_primitives.cuh"
#include "reconstruct/points_impl.hpp"

namespace pointskin::detail {

template DevicePoints upload_some(exec::Cuda&, const Cloud&);
template DevicePoints upload(exec::Cuda&, const Cloud&);
template void turn_normals(exec::Cuda&, ArrayView<Vec3f>);
template std::vector<DeviceAttribute> upload_attributes(exec::Cuda&, const Cloud&, const Options&);
template void leave_out(exec::Cuda&, const octree::StrayPoints&, DevicePoints&);
template SortedSamples sort_into_cube(exec::Cuda&, const DevicePoints&, const octree::Frame&);
template void download(exec::Cuda&, surface::Surface, const octree::Frame&, const Vec3d&, Mesh&);

}  // namespace pointskin::detail
