#include "exec/cpu_primitives.hpp"
#include "reconstruct/fit_field_impl.hpp"

namespace pointskin::detail {

template FieldData fit_field(exec::Cpu&, DevicePoints&, const FitSetup&, const Options&, RunReport&);
template surface::Surface extract(exec::Cpu&, const FieldData&, const Options&, RunReport&);
template void look_at_surface(exec::Cpu&, const surface::Surface&, FieldData&);
template surface::Surface extract_some(exec::Cpu&, const FieldData&, const Options&, RunReport&);
template void download_mesh(exec::Cpu&, const FieldData&, surface::Surface, const Options&, const Vec3d&, Mesh&);
template std::shared_ptr<FieldImpl> make_field(std::shared_ptr<exec::Cpu>, FieldData, const Options&, const Vec3d&);

}  // namespace pointskin::detail
