// The one seam between what a library's object holds and the steps that are compiled for every space: a space of some
// kind, shared by all that works in it.
#pragma once

#include <memory>
#include <utility>
#include <variant>

#include <pointskin/device.hpp>

#include "exec/cpu.hpp"
#include "exec/memory.hpp"
#ifdef POINTSKIN_HAS_CUDA
#include "exec/cuda.hpp"
#endif

namespace pointskin::exec {

/// A handle: copies stand for the same space, which lives as long as one of them.
class AnySpace {
 public:
  /// A new space on `device`. Nothing else asks which kind a device is.
  /// @throws Error device_unavailable if it does not answer, or the library was built without it; usage for a negative
  ///         number of threads
  explicit AnySpace(const Device& device);
  /// On a stream of somebody else's. @throws Error usage unless `device` has streams
  AnySpace(const Device& device, void* stream);

  [[nodiscard]] const std::shared_ptr<MemoryPool>& pool() const {
    return std::visit(
        [](const auto& space) -> const auto& { return space->pool(); }, space_);
  }

 private:
  template <class F>
  friend decltype(auto) visit(const AnySpace& space, F&& f);

  std::variant<
#ifdef POINTSKIN_HAS_CUDA
      std::shared_ptr<Cuda>,
#endif
      std::shared_ptr<Cpu>>
      space_;
};

/// Whether the GPUs of a device can be one space: each reaches the others' memory. True for one, and for the CPU.
[[nodiscard]] bool can_work_together(const Device& device);

/// Lets the stream of several GPUs, at the end of a call, wait for all that they were given: programs enqueue work of their own there.
template <class Exec>
class JoinedAtTheEnd {
 public:
  explicit JoinedAtTheEnd(const Exec& ex) : ex_(ex) {}
  ~JoinedAtTheEnd() {
    if constexpr (requires { ex_.join(); }) try {
        ex_.join();
      } catch (...) {  // NOLINT(bugprone-empty-catch): whoever waits for the stream is told
      }
  }
  JoinedAtTheEnd(const JoinedAtTheEnd&) = delete;
  JoinedAtTheEnd& operator=(const JoinedAtTheEnd&) = delete;

 private:
  const Exec& ex_;
};

/// f(space), with the space as what it is, made the calling thread's own: how an object calls a step.
template <class F>
decltype(auto) visit(const AnySpace& space, F&& f) {
  return std::visit(
      [&f](const auto& ex) -> decltype(auto) {
        ex->activate();
        const JoinedAtTheEnd joined(*ex);
        return std::forward<F>(f)(*ex);
      },
      space.space_);
}

}  // namespace pointskin::exec

namespace pointskin::detail {

/// What a Workspace stands for.
struct PSK_HIDDEN WorkspaceData {
  Device device;
  exec::AnySpace space;
};

}  // namespace pointskin::detail
