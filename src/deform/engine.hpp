// What a Deformer delegates to, one implementation a space.
#pragma once

#include <memory>

#include <pointskin/deform.hpp>

namespace pointskin::detail {

class DeformEngine {
 public:
  virtual ~DeformEngine() = default;
  /// @param deformation  valid
  virtual void deform(const Deformation& deformation, DeformReport& report) = 0;
  virtual void reconstruct(Mesh& mesh, DeformReport& report) = 0;
  [[nodiscard]] virtual Cloud cloud() const = 0;
  [[nodiscard]] virtual SpacingRatios spacing() const = 0;
};

/// @param options  valid
std::unique_ptr<DeformEngine> make_cpu_deform_engine(int threads, const Cloud& rest, const Options& options,
                                                     DeformReport& report);

/// @throws Error device_unavailable without a GPU; in builds without CUDA always
std::unique_ptr<DeformEngine> make_cuda_deform_engine(int index, const Cloud& rest, const Options& options,
                                                      DeformReport& report);

}  // namespace pointskin::detail
