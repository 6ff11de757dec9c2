#include "exec/cuda_primitives.cuh"
#include "surface/extract_impl.hpp"

namespace pointskin::surface {

template Surface extract_surface(exec::Cuda&, const field::FieldView&, const ExtractOptions&);

}  // namespace pointskin::surface
