#include "edit/guide_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::edit {

template GuidePoints guide_points(exec::Cuda&, const ViewFrame&, const GuideShape&, const KeepInside&, bool);
template exec::Buffer<std::int32_t> points_not_in(exec::Cuda&, const ViewFrame&, const Polygons&,
                                                  ArrayView<const Vec3f>, ArrayView<const std::uint8_t>);

}  // namespace pointskin::edit
