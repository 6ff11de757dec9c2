// One side of a comparison, a mesh or a cloud: samples of it, and what of it is nearest to a place.
#pragma once

#include <pointskin/mesh.hpp>

#include <cstdint>
#include <memory>
#include <string>

#include "exec/cpu_primitives.hpp"
#include "mesh/nearest.hpp"
#include "mesh/surface_samples.hpp"

namespace pointskin::mesh_detail {

/// A surface prepared for both directions.
class ComparedSide {
 public:
  ComparedSide() = default;
  virtual ~ComparedSide() = default;
  ComparedSide(const ComparedSide&) = delete;
  ComparedSide& operator=(const ComparedSide&) = delete;

  /// How many samples there are where `wanted` are asked for, > 0.
  [[nodiscard]] virtual std::int64_t samples(std::int64_t wanted) const = 0;
  /// Sample i of n, n = samples(wanted). A function of its arguments alone; neighbours are near each other.
  [[nodiscard]] virtual SurfaceSample sample(std::int64_t i, std::int64_t n) const = 0;

  /// What is nearest to `p`. @param hint  slot that may be near, or -1; changes the time taken, not the answer
  [[nodiscard]] virtual Nearest nearest(const Vec3d& p, std::int32_t hint) const = 0;
  /// The normal of what a search found: unit length, or zero where there is none.
  [[nodiscard]] virtual Vec3d normal(std::int32_t slot) const = 0;
};

/// A mesh: area-uniform samples, and its triangles with their normals. A cloud: its points, all of them or every k-th
/// in the order of a tree, which is even over space and does not depend on the order of the points, and their normals.
/// @param surface  checked (see box_of); must live as long as what is returned
/// @param offset   added to every position
/// O(n log n). Deterministic for any number of threads.
std::unique_ptr<ComparedSide> prepare(exec::Cpu& ex, const ComparedSurface& surface, const Vec3d& offset);

/// Diagonal of the bounding box, of a mesh that of the vertices that triangles use.
/// @param role  of the surface, for errors
/// @throws Error invalid_input if there are no triangles or points, a triangle names a vertex that does not exist, or a
///         position that counts is not finite; over_limit for more than 2^31 - 1 triangles or points
double checked_diagonal(exec::Cpu& ex, const ComparedSurface& surface, const std::string& role);

}  // namespace pointskin::mesh_detail
