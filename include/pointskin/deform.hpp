// Free-form deformation of a cloud: handles and lattices bend it, samples follow the stretch, every frame has a mesh.
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <variant>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/export.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>
#include <pointskin/vector.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin PSK_EXPORT {

// ---- Regions: where a handle holds the cloud, in world coordinates of the rest pose. Points have a distance to them,
// 0 inside.

/// All points x with (x - point) . normal >= 0.
struct HalfSpace {
  Vec3d point{};
  Vec3d normal{0, 0, 1};  ///< into the region, any length but 0
};
struct Ball {
  Vec3d centre{};
  double radius = 1;  ///< >= 0
};
struct AxisBox {
  Vec3d lower{}, upper{};  ///< lower <= upper along every axis
};
/// All points at most `radius` away from a segment.
struct Capsule {
  Vec3d from{}, to{};
  double radius = 1;  ///< >= 0
};
/// Single points; the distance is that to the nearest one, found through an octree.
struct PointSet {
  std::vector<std::int64_t> points;  ///< indices in the rest cloud, at least one
};
using HandleRegion = std::variant<HalfSpace, Ball, AxisBox, Capsule, PointSet>;

// ---- Transforms.

/// Rotation about an axis through a point, then a translation. Half of it is half of the angle and half of the way.
/// As it begins, the identity.
struct RigidMotion {
  Vec3d axis{0, 0, 1};  ///< any length but 0 unless the angle is 0
  Vec3d point{};        ///< on the axis, world coordinates
  double angle = 0;     ///< radians, counter-clockwise seen against the axis; at most 1000 either way, turns count
  Vec3d translation{};  ///< world units
};

/// x becomes M (x, 1). Split at the pivot c by polar decomposition: x = c + v becomes c + R S v + d. Half of it turns
/// by half the angle of R (at most 180 degrees), with the stretch (I + S) / 2 and d / 2. The pivot decides on the way
/// there only.
struct AffineMap {
  std::array<double, 12> matrix{1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0};  ///< (3, 4), row by row; world coordinates.
                                                                      ///< The determinant of the left 3x3 is positive
  Vec3d pivot{};                                                      ///< c, world coordinates
};
using HandleTransform = std::variant<RigidMotion, AffineMap>;

/// A region that is moved as a whole. With the identity (the default) it holds the cloud where it is.
struct Handle {
  HandleRegion region;
  HandleTransform transform{};
};

/// A block of control points around (a part of) the cloud, after Sederberg & Parry 1986. A point at
/// origin + s axes[0] + t axes[1] + u axes[2] is moved by the sum of what the control points were moved, with weights
/// B_i(s) B_j(t) B_k(u), the Bernstein polynomials of degrees spans.
struct Lattice {
  enum class Outside {
    extend,  ///< polynomials go on along their tangents at the faces: smooth, affine moves stay affine. Where the two
             ///< outer layers of control points are not moved, nothing moves outside
    stay,    ///< points outside stay: the cloud tears unless the outer layer is not moved
  };
  Vec3d origin{};                                                ///< a corner of the block, world coordinates
  std::array<Vec3d, 3> axes{{{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};  ///< its edges there, linearly independent
  std::array<int, 3> spans{1, 1, 1};                             ///< l, m, n, each in [1, 15]
  std::vector<Vec3d> control;  ///< shape ((l+1)(m+1)(n+1)), world coordinates, the last axis fastest
  Outside outside = Outside::extend;

  /// Where control point (i, j, k) is while nothing is moved.
  [[nodiscard]] Vec3d rest_point(int i, int j, int k) const;
  /// Place of control point (i, j, k) in `control`.
  [[nodiscard]] std::size_t index(int i, int j, int k) const;
  /// Puts all control points where they are while nothing is moved.
  void reset();
};

/// A map of space: first the handles, then the lattices in their order, each on what came out before.
///
/// Handles: with distances d_k of a point to the regions, shares t_k = (1/d_k) / sum_j (1/d_j); with two handles that
/// is Pauly et al.'s t = d0 / (d0 + d1). Weights w_k = b(t_k) / sum_j b(t_j) with b(t) = t^2 (3 - 2t): 1 in region k, 0
/// in the others, sum 1, slope 0 at the borders of the regions. Where regions overlap their handles have equal shares.
/// The point gets the rotation vector, stretch and translation that are the means of the handles', about the mean
/// pivot, weighted also by how much a handle turns and stretches. So one handle alone, or many with one transform,
/// moves everything rigidly; to hold something, give it a handle with the identity.
struct Deformation {
  std::vector<Handle> handles;    ///< at most 16
  std::vector<Lattice> lattices;  ///< at most 8
};

/// The deformation with all transforms scaled: 0 is the rest pose, 1 the deformation itself. Angles, stretches,
/// translations and moves of control points are linear in `share`.
/// @throws Error usage as validate()
Deformation scaled(const Deformation& deformation, double share);

/// @param points  of the rest cloud, for the indices of PointSet
/// @throws Error usage, in one line that names the handle or lattice, if something is out of range
void validate(const Deformation& deformation, std::int64_t points);

/// Mean distance of a deformed sample to its 6 nearest neighbours over that of its origin in the rest cloud.
struct SpacingRatios {
  double p05 = 1, median = 1, p95 = 1;  ///< percentiles over all samples
};

/// What the last deformation did and what it cost. Times are milliseconds on the device's clock.
struct DeformReport {
  std::int64_t rest_points = 0;  ///< used, without strays
  std::int64_t points = 0;       ///< of the deformed cloud: rest_points + inserted - thinned
  std::int64_t inserted = 0;
  std::int64_t thinned = 0;
  double upload_ms = 0;  ///< once: the rest cloud, on the host's clock
  double rest_ms = 0;    ///< once: its field and sampling density, on the host's clock
  double sample_ms = 0;  ///< stretch, and samples inserted and thinned
  double map_ms = 0;     ///< the samples' places and normals
  double mesh_ms = 0;    ///< all of reconstruct(), on the host's clock, with the copy of the mesh
  RunReport run;         ///< of the last reconstruct()
};

/// A cloud that stays on its device and is deformed frame after frame (P12). Every deform() starts from the rest pose:
/// the same deformation gives the same bytes, whatever came before, on CPU and GPU, for any number of threads and any
/// order of the points.
///
/// Where the surface's area is stretched or squeezed by more than a third, samples are inserted (on the rest surface,
/// around a sample, along its principal stretch, then moved by the same map) or thinned, so that they lie as far apart
/// as before. Normals follow the inverse transpose of the Jacobian and keep their length; attributes travel along. Not
/// safe for two threads at once.
class Deformer {
 public:
  /// Uploads `rest` and fits its field once; strays are left out unless Options::keep_strays. `options` hold for every
  /// frame. Costs a reconstruction.
  /// @throws Error as Reconstructor::solve; max_memory_bytes is compared with the estimate for two fields
  explicit Deformer(const Cloud& rest, const Options& options = {}, Workspace workspace = {});
  ~Deformer();
  Deformer(Deformer&&) noexcept;
  Deformer& operator=(Deformer&&) noexcept;

  /// Moves the rest cloud; until the first call it is where it was. O(n (handles + control points)); two host round
  /// trips for counts. The identity costs copies only and leaves every bit as it was.
  /// @throws Error as validate(); over_limit if the samples become too many, empty_result if none is left
  void deform(const Deformation& deformation);

  /// The mesh of the deformed cloud: the bytes that Reconstructor gives for cloud(), with strays kept.
  /// @throws Error as Reconstructor::reconstruct
  Mesh reconstruct();
  /// The same into a mesh of the caller, whose memory is used again.
  void reconstruct(Mesh& mesh);

  /// Copies the deformed cloud to the host, in the Morton order of the rest samples. With the origin, attributes and
  /// their names of the rest cloud.
  [[nodiscard]] Cloud cloud() const;

  /// Measures how far apart the samples are now. Two searches for 6 neighbours a sample, the first one once: as costly
  /// as a reconstruction. All 1 with fewer than 2 samples.
  [[nodiscard]] SpacingRatios spacing() const;

  [[nodiscard]] const DeformReport& report() const;
  [[nodiscard]] const Device& device() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace pointskin
