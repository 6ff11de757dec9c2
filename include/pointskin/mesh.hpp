// Triangle meshes on the host: the result type, its checker and its comparison.
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/export.hpp>
#include <pointskin/vector.hpp>

namespace pointskin PSK_EXPORT {

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
/// one plane or touch.
/// O(t log t + pairs with overlapping boxes), of which a surface has about 7 t: 1 us a triangle and core, 3 to 5 us
/// where triangles lie in one plane. Memory: 40 bytes a triangle, however many pairs there are. Deterministic for any
/// `threads`.
/// @throws Error invalid_input if a triangle names a vertex that does not exist, or one that is not finite; usage if an
///         option is out of range
SelfIntersections find_self_intersections(const Mesh& mesh, const SelfIntersectionOptions& options = {});

/// What is compared: a mesh, or a cloud that samples a surface. Refers to it, and must not outlive it.
class ComparedSurface {
 public:
  ComparedSurface(const Mesh& mesh) : mesh_(&mesh) {}      // NOLINT(google-explicit-constructor)
  ComparedSurface(const Cloud& cloud) : cloud_(&cloud) {}  // NOLINT(google-explicit-constructor)

  [[nodiscard]] const Mesh* mesh() const noexcept { return mesh_; }     ///< null for a cloud
  [[nodiscard]] const Cloud* cloud() const noexcept { return cloud_; }  ///< null for a mesh
  [[nodiscard]] const Vec3d& origin() const noexcept { return mesh_ != nullptr ? mesh_->origin : cloud_->origin; }

 private:
  const Mesh* mesh_ = nullptr;
  const Cloud* cloud_ = nullptr;
};

struct CompareOptions {
  std::int64_t samples = 500'000;  ///< samples of each surface, > 0: area-uniform ones of a mesh, points of a cloud
  double tau = 0.01;               ///< F-score threshold as a fraction of the reference's bounding box diagonal, > 0
  int threads = 0;                 ///< CPU threads, 0: all
};

/// Distances from samples of one surface to the nearest point of the other, in world units.
struct DistanceStatistics {
  double mean = 0, rms = 0, p95 = 0, max = 0;
};

struct MeshComparison {
  double reference_diagonal = 0;  ///< world units
  std::int64_t samples = 0;       ///< taken of the surface; fewer than asked for if it is a cloud with fewer points
  std::int64_t reference_samples = 0;  ///< taken of the reference, alike
  DistanceStatistics to_reference;     ///< samples of the surface to the reference (accuracy)
  DistanceStatistics from_reference;   ///< samples of the reference to the surface (completeness)
  DistanceStatistics
      two_sided;             ///< mean of the two means, root of the mean of the two squared rms, larger p95, larger max
  bool has_normals = false;  ///< both have normals; only a cloud may lack them
  double normal_consistency = 0;  ///< mean over both directions of |n . n'| of the nearest faces or points, in [0, 1];
                                  ///< 0 without normals
  double precision = 0, recall = 0, f_score = 0;  ///< shares within tau, in [0, 1]
};

/// Compares two surfaces by samples of each and their distances from the other, exact in double.
///
/// The samples of a mesh are area-uniform, and what is nearest is a point of a triangle. Those of a cloud are its
/// points, all of them or, if there are more than `samples`, an even choice that does not depend on their order; what
/// is nearest is a point of the cloud, so distances to a cloud are not below about half of its spacing, however right
/// the other surface is. Positions are taken in world coordinates: origins may differ. O((samples + n) log n), n
/// triangles or points. Deterministic for any `threads`.
/// @throws Error invalid_input if either has no triangle or point, a bad index or a position that is not finite, or if
///         the reference has no extent; usage if an option is out of range; over_limit for more than 2^31 - 1 triangles
///         or points
MeshComparison compare(const ComparedSurface& surface, const ComparedSurface& reference,
                       const CompareOptions& options = {});

struct DistanceOptions {
  bool with_sign = false;  ///< positive outside of the reference, negative inside; the reference must be watertight
  int threads = 0;         ///< CPU threads, 0: all
};

/// Distances of the vertices of a mesh, or of the points of a cloud, from a reference, in world units: of all of them,
/// in their order, exact in double up to rounding.
///
/// The sign, where asked for, is that of the angle-weighted pseudonormal (Baerentzen & Aanaes 2005), which is right
/// everywhere around a closed mesh that does not run through itself.
/// @returns shape (v) or (n); NaN for a vertex that is not finite, which no triangle may use
/// O((v + n) log n). Deterministic for any `threads`.
/// @throws Error as compare(), but the extent of the reference does not matter; invalid_input if a sign is asked for
/// and
///         the reference is a cloud, or a mesh that is not watertight
std::vector<double> distances(const ComparedSurface& surface, const ComparedSurface& reference,
                              const DistanceOptions& options = {});

}  // namespace pointskin
