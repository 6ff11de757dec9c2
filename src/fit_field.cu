#include "exec/cuda_primitives.cuh"
#include "fit_field_impl.hpp"

namespace pointskin::detail {

template FieldData fit_field(exec::Cuda&, DevicePoints&, const FitSetup&, const Options&, RunReport&);
template surface::Surface extract(exec::Cuda&, const FieldData&, const Options&, RunReport&);
template void extract_mesh(exec::Cuda&, const FieldData&, const Options&, const Vec3d&, Mesh&, RunReport&);
template std::shared_ptr<FieldImpl> make_field(std::shared_ptr<exec::Cuda>, FieldData, const Options&, const Vec3d&);

}  // namespace pointskin::detail
