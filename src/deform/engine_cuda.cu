#include "deform/engine_impl.hpp"
#include "exec/cuda_primitives.cuh"

namespace pointskin::detail {

std::unique_ptr<DeformEngine> make_cuda_deform_engine(int index, const Cloud& rest, const Options& options,
                                                      DeformReport& report) {
  return std::make_unique<DeformOn<exec::Cuda>>(std::make_shared<exec::Cuda>(index), rest, options, report);
}

}  // namespace pointskin::detail
