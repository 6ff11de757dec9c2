#include "exec/cancel.hpp"

#include <pointskin/cancel.hpp>
#include <pointskin/error.hpp>

#include <utility>

namespace pointskin {
namespace {

thread_local const std::atomic<bool>* flag_of_thread = nullptr;

}  // namespace

CancelScope::CancelScope(const std::atomic<bool>& flag) noexcept : before_(std::exchange(flag_of_thread, &flag)) {}
CancelScope::~CancelScope() { flag_of_thread = before_; }

namespace exec {

const std::atomic<bool>* cancel_flag() noexcept { return flag_of_thread; }
void throw_cancelled() { throw Error(ErrorCode::interrupted, "cancelled by the caller"); }

}  // namespace exec
}  // namespace pointskin
