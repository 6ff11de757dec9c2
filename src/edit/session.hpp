// What an EditSession delegates to: the states of a session on one space, behind an interface that names no backend.
#pragma once

#include <pointskin/edit.hpp>

#include <cstdint>
#include <memory>
#include <vector>

namespace pointskin {

class EditSession::Impl {
 public:
  virtual ~Impl() = default;
  virtual const StepReport& apply(const Operation& operation) = 0;
  virtual bool undo() = 0;
  virtual bool redo() = 0;
  [[nodiscard]] virtual std::vector<Operation> operations() const = 0;
  [[nodiscard]] virtual std::vector<StepReport> steps() const = 0;
  [[nodiscard]] virtual const Mesh& mesh() const = 0;
  [[nodiscard]] virtual Cloud cloud() const = 0;
};

namespace detail {

/// Components, genus and Euler number. O(t log t), on the host.
Topology topology_of(const Mesh& mesh, int threads);

std::unique_ptr<EditSession::Impl> make_cpu_session(const Cloud& base, const EditOptions& options, int threads);
/// @throws Error device_unavailable without a GPU; in builds without CUDA always
std::unique_ptr<EditSession::Impl> make_cuda_session(const Cloud& base, const EditOptions& options, int index);

}  // namespace detail
}  // namespace pointskin
