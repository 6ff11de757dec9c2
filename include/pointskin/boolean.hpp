// Set operations on solids that are given by oriented points or by closed meshes.
#pragma once

#include <cstdint>
#include <memory>

#include <pointskin/cloud.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

/// What is made of two solids A and B.
enum class BooleanOp {
  unite,                 ///< what is in A or in B
  intersect,             ///< what is in both
  subtract,              ///< what is in A and not in B
  symmetric_difference,  ///< what is in exactly one of them
};

/// What happens where the two surfaces cross.
enum class Creases {
  none,     ///< nothing (the paper's way): the sparser the points, the more the reconstruction rounds the crease
  sampled,  ///< samples of both surfaces are added along the curve in which they cross, and the two halves of a
            ///< symmetric difference, which touch there, are kept apart by about a cell
};

struct BooleanOptions {
  /// Of all three reconstructions. They share one working cube, around the points of both A and B that are no strays.
  /// `trim` counts for the result alone; the field must be poisson; `offset`, `attributes`, `envelope` and
  /// `max_memory_bytes` must be unset.
  Options reconstruction{};
  Creases creases = Creases::sampled;
  /// A point this much farther from the other surface than from its own, where both run alike, lies on both;
  /// in finest cells, in [0, 100]. Raise it for two scans of one surface that do not agree to half a cell.
  double coincidence_cells = 0.5;
};

/// One solid: the points of a cloud with their normals, or a closed mesh. Refers to it, and must not outlive it.
class BooleanOperand {
 public:
  BooleanOperand(const Cloud& cloud) : cloud_(&cloud) {}  // NOLINT(google-explicit-constructor)
  BooleanOperand(const Mesh& mesh) : mesh_(&mesh) {}      // NOLINT(google-explicit-constructor)

  [[nodiscard]] const Cloud* cloud() const noexcept { return cloud_; }  ///< null for a mesh
  [[nodiscard]] const Mesh* mesh() const noexcept { return mesh_; }     ///< null for a cloud
  [[nodiscard]] const Vec3d& origin() const noexcept { return cloud_ != nullptr ? cloud_->origin : mesh_->origin; }

 private:
  const Cloud* cloud_ = nullptr;
  const Mesh* mesh_ = nullptr;
};

/// What became of the points of A or of B.
struct BooleanPart {
  std::int64_t points = 0;      ///< used; of a mesh, the samples drawn from it
  std::int64_t strays = 0;      ///< left out before
  std::int64_t kept = 0;        ///< part of the result
  std::int64_t flipped = 0;     ///< of the kept ones, those whose normals were turned round
  std::int64_t dropped = 0;     ///< points - kept
  std::int64_t coincident = 0;  ///< on the other surface, too
  RunReport fit;                ///< of the reconstruction
};

struct BooleanReport {
  BooleanPart a, b;
  std::int64_t added = 0;   ///< samples along the creases
  double curve_length = 0;  ///< of the curve in which both surfaces cross, world units; 0 with Creases::none
  RunReport result;         ///< of the reconstruction of the kept and added points, extraction and download; its
                            ///< warnings are those of the whole
  double classify_ms = 0, crease_ms = 0, gather_ms = 0, apart_ms = 0;
  double total_ms = 0;  ///< with all reconstructions and copies, on the host's clock
  std::int64_t device_peak_bytes = 0;
};

struct BooleanResult {
  Cloud cloud;  ///< kept points of A, those of B, both in the order that they came in, then those added; unit normals
                ///< where added, else as they came or turned round. Relative to the origin of A
  Mesh mesh;    ///< closed and 2-manifold, as that of Reconstructor. Relative to the origin of A
  BooleanReport report;
};

/// Combines solids. Owns a device's stream and memory pool. Not safe for two threads at once.
/// Source: Zhou et al. 2010, section 5 (P13): both are reconstructed, every point is classified by the other's implicit
/// function, and what is kept is reconstructed again. Creases and coincident surfaces: docs/algorithm.md, "Boolean
/// operations".
class Booleans {
 public:
  /// @throws Error device_unavailable if the device does not answer, usage for a negative number of threads
  explicit Booleans(Workspace workspace = {});
  ~Booleans();
  Booleans(Booleans&&) noexcept;
  Booleans& operator=(Booleans&&) noexcept;

  /// Coincident surfaces: those that agree count once (A united with A is A), those that face each other enclose
  /// nothing, so A minus A and A symmetric-difference A are empty.
  /// A mesh is sampled, twice a finest cell along each axis.
  /// Three reconstructions, of about 1, 1 and at most 2 times their common cost, plus O(n depth). The mesh is the same,
  /// byte for byte, for any thread count, any order of the points, on CPU and GPU.
  /// @throws Error usage (an option out of range or not allowed), no_normals, invalid_input (points that are not
  /// finite;
  ///         a mesh that is not closed, or turned inside out), empty_result (nothing is left), over_limit, interrupted
  BooleanResult combine(BooleanOperand a, BooleanOperand b, BooleanOp op, const BooleanOptions& options = {});

  class Impl;

 private:
  std::unique_ptr<Impl> impl_;
};

}  // namespace pointskin
