#include "exec/cpu_primitives.hpp"
#include "reconstruct/points_impl.hpp"

namespace pointskin::detail {

template DevicePoints upload_some(exec::Cpu&, const Cloud&);
template DevicePoints upload(exec::Cpu&, const Cloud&);
template void turn_normals(exec::Cpu&, ArrayView<Vec3f>);
template std::vector<DeviceAttribute> upload_attributes(exec::Cpu&, const Cloud&, const Options&);
template void leave_out(exec::Cpu&, const octree::StrayPoints&, DevicePoints&);
template SortedSamples sort_into_cube(exec::Cpu&, const DevicePoints&, const octree::Frame&);
template void download(exec::Cpu&, surface::Surface, const octree::Frame&, const Vec3d&, Mesh&);

}  // namespace pointskin::detail
