// A closed mesh that the surface must stay inside of: which corners and samples lie outside, and where the surface has
// to stop. On the host and in double for every device, so that these decisions are the same.
// Source: Kazhdan, Chuang, Rusinkiewicz & Hoppe, "Poisson Surface Reconstruction with Envelope Constraints", SGP 2020.
// Differs: the octree is not refined along the envelope; vertices outside are moved instead
// (docs/decisions/0019-boundary-and-envelope.md).
#pragma once

#include <pointskin/mesh.hpp>
#include <pointskin/vector.hpp>

#include <cstdint>
#include <memory>

#include "core/array_view.hpp"
#include "exec/cpu.hpp"
#include "mesh/signed_distance.hpp"
#include "octree/frame.hpp"
#include "octree/view.hpp"

namespace pointskin::envelope {

/// Share of the cube's side by which a vertex may lie outside: what rounding to floats of the unit cube takes.
inline constexpr double kTolerance = 0x1p-23;

/// Corners nearer to the envelope than this, in cells of their level, count as outside: as far as vertices keep from
/// corners (surface::kCrossingMargin), so that no two are moved onto the same corner.
inline constexpr double kCornerMargin = 0x1p-10;

/// Vertices that were moved, and how far, in world units.
struct Moved {
  std::int64_t vertices = 0;
  double farthest = 0;
};

/// All arrays are on the host; positions are in the unit cube of the frame.
/// Work is cut into blocks that depend on the arrays' lengths alone: the same for any number of threads.
class Envelope {
 public:
  /// @param mesh     watertight, see MeshReport
  /// @param origin   of the cloud: frames are relative to it
  /// @param threads  CPU threads, 0: all
  /// @throws Error invalid_input if the mesh is empty, not finite, not closed, not manifold or turned inside out
  Envelope(std::shared_ptr<const Mesh> mesh, const Vec3d& origin, int threads);
  ~Envelope();
  Envelope(const Envelope&) = delete;
  Envelope& operator=(const Envelope&) = delete;

  /// Sets the areas of samples outside to 0.
  /// @param positions, areas  shape (n), fastest if positions that follow each other are near
  /// @returns how many lie outside
  std::int64_t drop_outside(const octree::Frame& frame, ArrayView<const Vec3f> positions, ArrayView<float> areas) const;

  /// Clears the bits of corners outside in the masks of a level's bricks.
  /// @param level  depth and number of bricks; `brick_key` on the host; other arrays are not read
  /// @param free   shape (bricks), bit s: the corner of node s
  void hold_outside(const octree::Frame& frame, const octree::LevelView& level, std::uint8_t* free) const;

  /// Moves vertices outside along their edges, towards the inside ends, onto the envelope. Those whose ends lie
  /// outside, too, stay.
  /// @param vertices, inside_ends  shape (v)
  Moved clip(const octree::Frame& frame, ArrayView<Vec3f> vertices, ArrayView<const Vec3f> inside_ends) const;

  /// Moves vertices outside to the nearest points of the envelope.
  Moved project(const octree::Frame& frame, ArrayView<Vec3f> vertices) const;

 private:
  std::shared_ptr<const Mesh> mesh_;
  std::unique_ptr<exec::Cpu> ex_;  // works for const members, too
  std::unique_ptr<mesh_detail::SignedDistance> distance_;
};

}  // namespace pointskin::envelope
