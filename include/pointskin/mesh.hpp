// Triangle meshes on the host: the result type, its checker and its comparison.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/vector.hpp>

namespace pointskin {

/// Indexed triangle mesh. World position of vertex i = origin + vertices[i].
struct Mesh {
  Vec3d origin{0, 0, 0};              ///< world units
  std::vector<Vec3f> vertices;        ///< shape (v), relative to origin, world units
  std::vector<Vec3f> normals;         ///< shape (v) or (0), unit length, outward
  std::vector<Attribute> attributes;  ///< each of shape (v)
  std::vector<Triangle> triangles;    ///< shape (t), ids in [0, v), counter-clockwise seen from outside
};

/// Topology and measures of a mesh. `watertight()` is what `pointskin check` decides on.
struct MeshReport {
  std::int64_t vertices = 0;       ///< vertices of the file, used or not
  std::int64_t used_vertices = 0;  ///< vertices that some triangle uses
  std::int64_t triangles = 0;
  std::int64_t edges = 0;                  ///< undirected edges
  std::int64_t boundary_edges = 0;         ///< edges with exactly one triangle
  std::int64_t non_manifold_edges = 0;     ///< edges with more than two triangles
  std::int64_t misoriented_edges = 0;      ///< edges whose two triangles run through it in the same direction
  std::int64_t non_manifold_vertices = 0;  ///< used vertices whose triangles form more than one fan
  std::int64_t degenerate_triangles = 0;   ///< triangles that name a vertex twice
  std::int64_t components = 0;             ///< connected by shared vertices
  std::int64_t euler = 0;                  ///< used_vertices - edges + triangles
  double volume = 0;                       ///< signed, positive when outward; meaningful when closed; world units^3
  double area = 0;                         ///< world units^2

  /// Every edge has exactly two triangles.
  [[nodiscard]] bool closed() const noexcept { return triangles > 0 && boundary_edges == 0 && non_manifold_edges == 0; }
  /// Every edge has at most two triangles, every vertex one fan, no degenerate triangle.
  [[nodiscard]] bool manifold() const noexcept {
    return non_manifold_edges == 0 && non_manifold_vertices == 0 && degenerate_triangles == 0;
  }
  [[nodiscard]] bool oriented() const noexcept { return misoriented_edges == 0; }
  [[nodiscard]] bool watertight() const noexcept { return closed() && manifold() && oriented() && volume > 0; }
};

/// Counts and measures `mesh`. O(t log t) time, about 40 bytes a triangle of scratch. Deterministic for any `threads`.
/// @param threads  CPU threads, 0: all
/// @throws Error invalid_input if a triangle names a vertex that does not exist
MeshReport measure(const Mesh& mesh, int threads = 0);

struct SelfIntersectionOptions {
  std::int64_t listed = 10;  ///< pairs to name, at most; >= 0
  int threads = 0;           ///< CPU threads, 0: all
};

/// Two triangles that meet elsewhere than in what they share.
struct IntersectingPair {
  std::array<std::int32_t, 2> triangles{};  ///< ids, the smaller first
  bool touching = false;                    ///< their insides do not meet: they have points of their borders in common
  Vec3d place_world{};                      ///< a point of both, up to rounding
};

struct SelfIntersections {
  std::int64_t pairs = 0;                ///< of triangles that meet, touching ones included
  std::int64_t touching = 0;             ///< of these, those whose insides do not meet
  std::int64_t triangles = 0;            ///< that are part of some pair
  std::vector<IntersectingPair> listed;  ///< the pairs with the smallest ids, ascending
};

/// Finds the pairs of triangles of `mesh` that have more in common than the corners and edges that they share.
///
/// Triangles are closed sets: a corner of one that lies on the other counts, as `touching`. What two triangles share
/// follows from the ids of their vertices: vertices at one place with different ids are not shared. Two triangles with
/// the same three vertices are a pair. Triangles without area are segments or points, and count like all others; they
/// have no inside, so they only touch.
///
/// Exact: every decision is the sign of a determinant of the floats in Mesh::vertices, computed without error
/// (Shewchuk 1997). The origin does not matter. No pair is missed, and none is invented, also where triangles lie in
/// one plane or touch. About O(t log t + candidates), candidates being pairs with overlapping boxes, in a mesh of a
/// surface some 7 t: 0.4 us a triangle on two cores. Memory: 40 bytes a triangle of scratch at its peak, however many
/// pairs there are. Deterministic for any `threads`.
/// @throws Error invalid_input if a triangle names a vertex that does not exist, or one that is not finite; usage if an
///         option is out of range
SelfIntersections find_self_intersections(const Mesh& mesh, const SelfIntersectionOptions& options = {});

struct CompareOptions {
  std::int64_t samples = 500'000;  ///< area-uniform samples drawn on each mesh, > 0
  double tau = 0.01;               ///< F-score threshold as a fraction of the reference's bounding box diagonal, > 0
  int threads = 0;                 ///< CPU threads, 0: all
};

/// Distances from samples of one mesh to the nearest point on the other, in world units.
struct DistanceStatistics {
  double mean = 0, rms = 0, p95 = 0, max = 0;
};

struct MeshComparison {
  double reference_diagonal = 0;      ///< world units
  DistanceStatistics to_reference;    ///< samples on the mesh to the reference (accuracy)
  DistanceStatistics from_reference;  ///< samples on the reference to the mesh (completeness)
  DistanceStatistics
      two_sided;  ///< mean of the two means, root of the mean of the two squared rms, larger p95, larger max
  double normal_consistency = 0;  ///< mean over both directions of |n . n'| of the nearest faces, in [0, 1]
  double precision = 0, recall = 0, f_score = 0;  ///< shares within tau, in [0, 1]
};

/// Compares two meshes with exact point-to-triangle distances from deterministic area-uniform samples.
/// O((samples + t) log t). Deterministic for any `threads`.
/// @throws Error invalid_input if either mesh has no triangle or a bad index; usage if an option is out of range
MeshComparison compare(const Mesh& mesh, const Mesh& reference, const CompareOptions& options = {});

}  // namespace pointskin
