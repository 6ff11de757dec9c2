#include <pointskin/error.hpp>

#include "edit/session_impl.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::detail {

std::unique_ptr<EditSession::Impl> make_cpu_session(const Cloud& base, const EditOptions& options, int threads) {
  return std::make_unique<SessionOn<exec::Cpu>>(std::make_shared<exec::Cpu>(threads), base, options);
}

#ifndef POINTSKIN_HAS_CUDA
std::unique_ptr<EditSession::Impl> make_cuda_session(const Cloud& /*base*/, const EditOptions& /*options*/,
                                                     int /*index*/) {
  throw Error(ErrorCode::device_unavailable, "this build has no GPU support; configure with -DPOINTSKIN_CUDA=ON");
}
#endif

}  // namespace pointskin::detail
