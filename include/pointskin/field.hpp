// The implicit function on its octree.
#pragma once

#include <memory>
#include <span>
#include <vector>

#include <pointskin/device_data.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/vector.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

struct ExtractOptions;

namespace detail {
class FieldImpl;
}

/// The function u of docs/algorithm.md: about 1 inside, 0 outside, continuous, trilinear in every leaf; with
/// FieldKind::distance or SolveOptions::offset minus a signed distance, in finest cells, positive inside. A cheap
/// handle; copies share the same data. Fields work in their Reconstructor's workspace: all belong to one thread at a
/// time.
class Field {
 public:
  explicit Field(std::shared_ptr<detail::FieldImpl> impl);

  /// Weighted mean of u over the samples; 0 for FieldKind::distance, minus the offset in finest cells with
  /// SolveOptions::offset.
  [[nodiscard]] double isovalue() const;

  /// Side of the working cube in world units, and its lower corner in world coordinates.
  [[nodiscard]] double cube_size_world() const;
  [[nodiscard]] Vec3d cube_lower_world() const;

  /// u at `points_world`; points outside of the cube get the value at the nearest point of the cube.
  /// O(n depth). Deterministic.
  [[nodiscard]] std::vector<float> values(std::span<const Vec3d> points_world) const;

  /// The level set u = ExtractOptions::isovalue, by default isovalue(), as a 2-manifold, outward-oriented mesh with
  /// vertices in Morton order, closed unless ExtractOptions::domain_faces is open or ExtractOptions::trim cuts it: new
  /// vertices at the cut then come last. May be called again and again, with other options: the same bytes as
  /// Reconstructor::reconstruct with the same ones.
  /// @throws Error usage (an option out of range, or one that the solve excludes), empty_result if nothing crosses the
  ///         isovalue, nothing is left after ExtractOptions::trim, or an envelope within one cell presses the surface
  ///         flat
  [[nodiscard]] Mesh extract(const ExtractOptions& options) const;
  [[nodiscard]] Mesh extract() const;

  /// The same into a mesh of the caller, whose memory is used again.
  void extract(const ExtractOptions& options, Mesh& mesh) const;

  /// The same into the memory of the workspace's device, without a copy.
  [[nodiscard]] DeviceMesh extract_on_device(const ExtractOptions& options) const;

  [[nodiscard]] const Workspace& workspace() const;

 private:
  std::shared_ptr<detail::FieldImpl> impl_;
};

}  // namespace pointskin
