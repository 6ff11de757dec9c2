// What a Reconstructor and a Field delegate to: the pipeline on one space, behind an interface that names no backend.
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include <pointskin/field.hpp>
#include <pointskin/reconstruct.hpp>

#include "diagnose/counts.hpp"

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
  /// What was counted of the samples and the field and, after extract_and_release, of the surface.
  [[nodiscard]] virtual const diagnose::Counts& seen() const = 0;
};

/// How much detail points hold, in world units.
struct Detail {
  double cube = 0;     ///< side of the working cube
  double spacing = 0;  ///< between samples of the surface, median: the side of the square that holds one
  double noise = 0;    ///< standard deviation of samples across the surface (diagnose/sheets.hpp)
};

/// The points of a run.
struct Input {
  const Cloud& cloud;
  bool turned = false;  ///< all normals the other way round
};

/// The pipeline on one space.
class Engine {
 public:
  virtual ~Engine() = default;
  /// What all arrays may take together from now on, in bytes; 0: no limit. Fields of the engine are held to it, too.
  virtual void limit_memory(std::int64_t bytes) = 0;
  /// Gives memory that is kept for the next run back to the system.
  virtual void release_memory() = 0;
  virtual std::shared_ptr<FieldImpl> solve(const Input& input, const Options& options, RunReport& report) = 0;
  /// Up to `count` of the points that a run uses, evenly spread over their Morton order, with their normals.
  virtual Cloud thin(const Cloud& cloud, const Options& options, std::int64_t count) = 0;
  /// @throws Error as measure_detail (reconstruct/detail.hpp)
  virtual Detail measure_detail(const Cloud& cloud, const Options& options) = 0;
  virtual std::vector<RunTimes> repeat(const Input& input, const Options& options, int times) = 0;
};

/// @throws Error device_unavailable if the device does not answer
std::unique_ptr<Engine> make_engine(const Device& device);

/// validate(), for what does not choose a depth or a trim by itself.
/// @throws Error usage
void validate_settled(const Options& options);

std::unique_ptr<Engine> make_cpu_engine(int threads);

/// @throws Error device_unavailable without a GPU; in builds without CUDA always
std::unique_ptr<Engine> make_cuda_engine(int index);

}  // namespace pointskin::detail
