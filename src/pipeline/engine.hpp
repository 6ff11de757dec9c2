// What a Reconstructor and a Field delegate to: the pipeline on one space, behind an interface that names no backend.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <pointskin/field.hpp>
#include <pointskin/reconstruct.hpp>

namespace pointskin::detail {

/// A solved field with the resources of its space.
class FieldImpl {
 public:
  virtual ~FieldImpl() = default;
  [[nodiscard]] virtual double isovalue() const = 0;
  [[nodiscard]] virtual double cube_size_world() const = 0;
  [[nodiscard]] virtual Vec3d cube_lower_world() const = 0;
  [[nodiscard]] virtual std::vector<float> values(const std::vector<Vec3d>& points_world) const = 0;
  /// @param mesh  receives the mesh; its memory is used again
  virtual void extract(Mesh& mesh) const = 0;
  /// The same, for the last time: all else is freed before the mesh is copied.
  /// @param report  receives extract_ms, download_ms and the peak memory
  virtual void extract_and_release(Mesh& mesh, RunReport& report) = 0;
};

/// The pipeline on one space.
class Engine {
 public:
  virtual ~Engine() = default;
  virtual std::shared_ptr<FieldImpl> solve(const Cloud& cloud, const Options& options, RunReport& report) = 0;
  virtual std::vector<RunTimes> repeat(const Cloud& cloud, const Options& options, int times) = 0;
};

std::unique_ptr<Engine> make_cpu_engine(int threads);

/// @throws Error device_unavailable without a GPU; in builds without CUDA always
std::unique_ptr<Engine> make_cuda_engine(int index);

}  // namespace pointskin::detail
