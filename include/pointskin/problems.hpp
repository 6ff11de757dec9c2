// Where a reconstruction needs a look: connected regions of a mesh whose topology is doubtful, the worst first.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/render.hpp>
#include <pointskin/vector.hpp>

namespace pointskin PSK_EXPORT {

struct ProblemOptions {
  double threshold = 0.25;   ///< weakness at which a vertex belongs to a region, in (0, 1]
  double least_area = 1e-4;  ///< share of the mesh's area below which a region is left out, in [0, 1]
  UpAxis up = UpAxis::y;     ///< of the suggested views
  int threads = 0;           ///< CPU threads, 0: all
};

/// A camera that sees a region, for RenderOptions and for others.
struct ProblemView {
  double azimuth_degrees = 0, elevation_degrees = 0;  ///< as in RenderOptions, with ProblemOptions::up
  Vec3d target_world{};                               ///< the point looked at
  /// World to camera, row-major: x to the right, y up, z towards the viewer, the target at (0, 0, -distance). A
  /// vertical field of view of 28 degrees holds the region's bounding sphere.
  std::array<double, 16> matrix{};
  double zoom = 1;     ///< for RenderOptions, with Fit::sphere: the region is half as wide as the picture or less
  double visible = 0;  ///< share of the region, weighted by the weakness, that this picture shows, in [0, 1]
};

struct ProblemRegion {
  double score = 0;  ///< integral of the weakness over the region, world units^2: ranks
  double peak = 0;   ///< largest weakness of a vertex, in [0, 1]
  double area = 0;   ///< world units^2
  std::int64_t triangles = 0;
  Vec3d centroid_world{};              ///< weighted by the weakness
  Vec3d lower_world{}, upper_world{};  ///< bounding box
  Vec3d mean_normal{};  ///< weighted by area and weakness; shorter than 1 where sides face away from each other
  /// One to three, the best first: along the mean normal, unless something is in the way there, and from other sides,
  /// at least 40 degrees apart. All but the first see some of the region; there are fewer than three where it lies
  /// deep.
  std::vector<ProblemView> views;
};

/// Regions of `mesh` above the threshold, the largest score first. A triangle belongs to a region if the mean weakness
/// of its corners reaches the threshold; triangles of a region are connected through common vertices. Source: Sharf,
/// Lewiner, Shklarski, Toledo & Cohen-Or, "Interactive topology-aware surface reconstruction", SIGGRAPH 2007, which
/// leads the user through such regions.
/// @param mesh  with the attribute "weakness" (Options::weakness), of any topology
/// @throws Error usage if an option is out of range or the mesh has no such attribute, invalid_input if a triangle
/// names
///         a vertex that does not exist
/// O(v + t log t), and some thousand lines of sight a region, on the host. Deterministic for any number of threads.
std::vector<ProblemRegion> find_problems(const Mesh& mesh, const ProblemOptions& options = {});

/// Draws one of the views of a region: the surface is clay, and orange to magenta where it is weak; a ring is around
/// the region, in the middle of the picture.
/// @param region   of find_problems() for the same mesh; `view` is one of its views, counted from 0
/// @param options  size, ProblemOptions::up, smooth, back_faces, shadows and threads count; the rest is the view's
/// @param caption  lines of text for the lower left corner; may be empty
/// @throws Error usage if there is no such view or no attribute "weakness", and as render()
Image render_problem(const Mesh& mesh, const ProblemRegion& region, std::size_t view, const RenderOptions& options = {},
                     const std::string& caption = {});

}  // namespace pointskin
