// Stopping work from outside, within a step.
#pragma once

#include <atomic>

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

/// While it lives, whatever the thread that made it asks of the library ends soon after `flag` has become true, with Error
/// interrupted: of a run, of reading and of writing alike. The `progress` of options is asked between steps, this flag
/// within them, every few hundred elements; on a GPU between launches. What a call would have changed is as after any
/// other error. The flag may be set by any thread and by a signal handler; it is never written here.
///
///     std::atomic<bool> stop{false};  // set to true elsewhere
///     const CancelScope scope(stop);
///     Mesh mesh = reconstructor.reconstruct(cloud, options);
///
/// Scopes may be nested: the inner one counts.
class CancelScope {
 public:
  /// @param flag  must outlive this
  explicit CancelScope(const std::atomic<bool>& flag) noexcept;
  ~CancelScope();
  CancelScope(const CancelScope&) = delete;
  CancelScope& operator=(const CancelScope&) = delete;

 private:
  const std::atomic<bool>* before_;
};

}  // namespace pointskin
