// What a Reconstructor and a Field delegate to: the steps of a run, in whatever space it works.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <pointskin/device_data.hpp>
#include <pointskin/field.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/workspace.hpp>

#include "diagnose/counts.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/input.hpp"
#include "reconstruct/measure_detail.hpp"
#include "reconstruct/mesh_of_field.hpp"

namespace pointskin::detail {

/// A solved field and where it is.
class PSK_HIDDEN FieldImpl {
 public:
  /// @param options  of the solve; of a field that is to be extracted once, of that, too
  /// @param origin   of the cloud: what places in `data` are relative to
  FieldImpl(Workspace workspace, FieldData data, Options options, const Vec3d& origin);

  [[nodiscard]] double isovalue() const { return data_.isovalue; }
  [[nodiscard]] double cube_size_world() const { return data_.frame.size; }
  [[nodiscard]] const octree::Frame& frame() const { return data_.frame; }
  [[nodiscard]] Vec3d cube_lower_world() const;
  [[nodiscard]] const Workspace& workspace() const { return workspace_; }

  [[nodiscard]] std::vector<float> values(std::span<const Vec3d> points_world) const;

  /// @param mesh  receives the mesh; its memory is used again
  void extract(const ExtractOptions& options, Mesh& mesh) const;
  [[nodiscard]] DeviceMesh extract_on_device(const ExtractOptions& options) const;

  /// The mesh that the field was solved for, for the last time: all else is freed before the mesh is copied.
  /// @param report  receives extract_ms, download_ms and the peak memory
  void extract_and_release(Mesh& mesh, RunReport& report);
  /// The same, where the field is.
  DeviceMesh extract_and_release(RunReport& report);

  /// What was counted of the samples and the field and, after extract_and_release, of the surface.
  [[nodiscard]] const diagnose::Counts& seen() const { return data_.seen; }

  /// field::AttributeSamples::without_values.
  [[nodiscard]] const std::vector<std::string>& attributes_without_values() const {
    return data_.attributes.without_values;
  }

  /// FieldData::core.
  [[nodiscard]] const std::optional<Bounds>& core() const { return data_.core; }

 private:
  [[nodiscard]] Options with(const ExtractOptions& options) const;

  Workspace workspace_;
  FieldData data_;
  Options options_;
  Vec3d origin_;
};

/// The steps of a run.
class Engine {
 public:
  explicit Engine(Workspace workspace) : workspace_(std::move(workspace)) {}

  [[nodiscard]] const Workspace& workspace() const { return workspace_; }
  /// What all arrays may take together from now on, in bytes; 0: no limit. Fields of the engine are held to it, too.
  void limit_memory(std::int64_t bytes) const;
  /// Whether Workspace::limit_memory has set one.
  [[nodiscard]] bool has_lasting_limit() const;
  /// Gives memory that is kept for the next run back to the system.
  void release_memory() const { workspace_.release_memory(); }
  /// @param keep_all  FitSetup::keep_all
  /// @param core      FitSetup::core
  [[nodiscard]] std::shared_ptr<FieldImpl> solve(const Input& input, const Options& options, bool keep_all,
                                                 RunReport& report, const std::optional<Bounds>& core = {}) const;
  /// Up to `count` of the points that a run uses, evenly spread over their Morton order, with their normals.
  [[nodiscard]] Cloud thin(const Input& input, const Options& options, std::int64_t count) const;
  /// @throws Error as measure_detail
  [[nodiscard]] Detail measure_detail(const Input& input, const Options& options) const;
  /// The points on the host.
  [[nodiscard]] Cloud copy(const Input& input) const;

 private:
  Workspace workspace_;
};

/// Arrays of a mesh as what a caller holds.
DeviceMesh handle_of(const Workspace& workspace, MeshBuffers mesh, const Vec3d& origin);

/// estimate_device_bytes, of points wherever they are.
std::int64_t bytes_of_run(const Engine& engine, const Input& input, const Options& options);

/// validate(), for what does not choose a depth or a trim by itself.
/// @throws Error usage
void validate_settled(const Options& options);

}  // namespace pointskin::detail
