// Where a reconstruction needs a look: connected regions of a mesh whose topology is doubtful, the worst first.
#pragma once

#include <array>
#include <cstdint>
#include <vector>

#include <pointskin/mesh.hpp>
#include <pointskin/render.hpp>
#include <pointskin/vector.hpp>

namespace pointskin {

struct ProblemOptions {
  double threshold = 0.25;   ///< weakness at which a vertex belongs to a region, in (0, 1]
  double least_area = 1e-4;  ///< share of the mesh's area below which a region is left out, in [0, 1]
  UpAxis up = UpAxis::y;     ///< of the suggested views
};

/// A camera that sees a region, for RenderOptions and for others.
struct ProblemView {
  double azimuth_degrees = 0, elevation_degrees = 0;  ///< as in RenderOptions, with ProblemOptions::up
  Vec3d target_world{};                               ///< the point looked at
  /// World to camera, row-major: x to the right, y up, z towards the viewer, the target at (0, 0, -distance). A
  /// vertical field of view of 28 degrees holds the region's bounding sphere.
  std::array<double, 16> matrix{};
};

struct ProblemRegion {
  double score = 0;  ///< integral of the weakness over the region, world units^2: ranks
  double peak = 0;   ///< largest weakness of a vertex, in [0, 1]
  double area = 0;   ///< world units^2
  std::int64_t triangles = 0;
  Vec3d centroid_world{};              ///< weighted by the weakness
  Vec3d lower_world{}, upper_world{};  ///< bounding box
  Vec3d mean_normal{};  ///< weighted by area and weakness; shorter than 1 where sides face away from each other
  std::vector<ProblemView> views;  ///< the best first: along the mean normal, then from both sides of it
};

/// Regions of `mesh` above the threshold, the largest score first. A triangle belongs to a region if the mean weakness
/// of its corners reaches the threshold; triangles of a region are connected through common vertices. Source: Sharf,
/// Lewiner, Shklarski, Toledo & Cohen-Or, "Interactive topology-aware surface reconstruction", SIGGRAPH 2007, which
/// leads the user through such regions.
/// @param mesh  with the attribute "weakness" (Options::weakness), of any topology
/// @throws Error usage if an option is out of range or the mesh has no such attribute, invalid_input if a triangle
/// names
///         a vertex that does not exist
/// O(v + t log t), on the host. Deterministic.
std::vector<ProblemRegion> find_problems(const Mesh& mesh, const ProblemOptions& options = {});

}  // namespace pointskin
