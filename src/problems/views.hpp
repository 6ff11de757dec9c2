// From where a region of a mesh is seen well.
#pragma once

#include <pointskin/mesh.hpp>
#include <pointskin/problems.hpp>

#include <optional>
#include <vector>

#include "exec/cpu.hpp"
#include "mesh/triangle_tree.hpp"

namespace pointskin::problems {

/// A triangle of a region, relative to the mesh's origin.
struct Patch {
  Vec3d centre{}, area_vector{};
  double score = 0;  ///< area times weakness
};

/// A region that is to be looked at.
struct Place {
  Vec3d centre{};     ///< what the views look at, relative to the mesh's origin
  Vec3d towards{};    ///< unit vector: the direction to look from if nothing is in the way
  double radius = 0;  ///< of the sphere about the centre that holds it
  std::vector<Patch> patches;
};

/// Chooses views among directions around a place by how much of it they see.
class ViewFinder {
 public:
  /// @param mesh  ids in range; must outlive it. O(t log t)
  ViewFinder(exec::Cpu& ex, const Mesh& mesh, UpAxis up);

  /// ProblemRegion::views. Some thousand lines of sight.
  [[nodiscard]] std::vector<ProblemView> views_of(exec::Cpu& ex, const Place& place) const;

 private:
  const Mesh& mesh_;
  UpAxis up_;
  std::optional<mesh_detail::TriangleTree> tree_;  // none: nothing is known to be in the way
};

}  // namespace pointskin::problems
