#include "exec/cuda_primitives.cuh"
#include "reconstruct/fit_field_impl.hpp"

namespace pointskin::detail {

template FieldData fit_field(exec::Cuda&, DevicePoints&, const FitSetup&, const Options&, RunReport&);
template surface::Surface extract(exec::Cuda&, const FieldData&, const Options&, RunReport&);
template void look_at_surface(exec::Cuda&, const surface::Surface&, FieldData&);
template surface::Surface extract_some(exec::Cuda&, const FieldData&, const Options&, RunReport&);
template void download_mesh(exec::Cuda&, const FieldData&, surface::Surface, const Options&, const Vec3d&, Mesh&);
template std::shared_ptr<FieldImpl> make_field(std::shared_ptr<exec::Cuda>, FieldData, const Options&, const Vec3d&);

}  // namespace pointskin::detail
