#include "exec/cuda_primitives.cuh"

#include "edit/session_impl.hpp"

namespace pointskin::detail {

std::unique_ptr<EditSession::Impl> make_cuda_session(const Cloud& base, const EditOptions& options, int index) {
  return std::make_unique<SessionOn<exec::Cuda>>(std::make_shared<exec::Cuda>(index), base, options);
}

}  // namespace pointskin::detail
