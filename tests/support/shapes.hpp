// Shapes whose surface, topology and volume are known: meshes, and oriented clouds drawn from them.
//
// Everything is a function of its arguments alone: std::mt19937_64 with a mapping of our own, since the distributions
// of <random> differ between standard libraries. Clouds have exact outward unit normals and are uniform per area.
#pragma once

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/vector.hpp>

#include <cstdint>
#include <random>
#include <vector>

namespace pointskin::test {

/// Random numbers that are the same everywhere.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Uniform in [0, 1).
  double unit() { return static_cast<double>(engine_() >> 11) * 0x1p-53; }
  /// Uniform in [lower, upper).
  double in(double lower, double upper) { return lower + (upper - lower) * unit(); }
  /// Uniform in [0, n), n > 0.
  std::int64_t below(std::int64_t n) { return static_cast<std::int64_t>(engine_() % static_cast<std::uint64_t>(n)); }
  /// Uniform on the unit sphere.
  Vec3d direction();

 private:
  std::mt19937_64 engine_;
};

// ---- Clouds
// -----------------------------------------------------------------------------------------------------------

/// Sphere. Genus 0, volume 4/3 pi radius^3.
Cloud sphere_cloud(std::int64_t n, std::uint64_t seed, double radius = 1, Vec3d centre = {});

/// Torus about the z axis, `major` from the axis to the tube's centre, `minor` the tube's radius. Genus 1, volume
/// 2 pi^2 major minor^2.
Cloud torus_cloud(std::int64_t n, std::uint64_t seed, double major = 1, double minor = 0.35, Vec3d centre = {});

/// Two tori that pass through each other's hole, n points in all: the torus of torus_cloud at the origin, and one about
/// the y axis at (major, 0, 0). Two components of genus 1; their tubes are major - 2 minor apart.
Cloud linked_tori_cloud(std::int64_t n, std::uint64_t seed, double major = 1, double minor = 0.25);

/// Axis-aligned box. Genus 0. A face gets its share of the points by area; none lie exactly on an edge.
Cloud box_cloud(std::int64_t n, std::uint64_t seed, Vec3d lower = {-1, -1, -1}, Vec3d upper = {1, 1, 1});

/// Plate of 2 x 2 x `thickness` at the origin, thin along z. Genus 0, volume 4 thickness.
Cloud thin_plate_cloud(std::int64_t n, std::uint64_t seed, double thickness);

/// Two unit spheres, `gap` apart along x, n points in all, the origin in the middle of the gap.
Cloud two_spheres_cloud(std::int64_t n, std::uint64_t seed, double gap);

/// Square [-1, 1]^2 in the plane z = 0 with normals along +z: a surface with a border.
Cloud plane_cloud(std::int64_t n, std::uint64_t seed);

/// Adds the points of `more` behind those of `cloud`. Both must have the same origin and neither attributes.
void append(Cloud& cloud, const Cloud& more);

/// The same points in another order; normals and attributes go along.
Cloud shuffled(const Cloud& cloud, std::uint64_t seed);

/// Every position moved by a uniform offset in the cube [-amount, amount]^3; normals stay.
Cloud jittered(const Cloud& cloud, std::uint64_t seed, double amount);

/// Positions multiplied by `factor` > 0. A power of two is exact.
Cloud scaled(const Cloud& cloud, float factor);

/// Positions moved by `offset` in float.
Cloud translated(const Cloud& cloud, Vec3f offset);

/// (x, y, z) becomes (y, z, x), in positions and normals: a rotation, exact.
Cloud axes_rotated(const Cloud& cloud);

/// Normals turned inside out.
Cloud flipped(const Cloud& cloud);

// ---- Meshes
// -----------------------------------------------------------------------------------------------------------

/// Axis-aligned box: 8 vertices, 12 triangles, the two of each side next to each other. No normals.
Mesh box_mesh(Vec3d lower = {0, 0, 0}, Vec3d upper = {1, 1, 1});

/// The corner of the unit cube at the origin: vertices 0, x, y, z; volume 1/6, area 3/2 + sqrt(3)/2.
Mesh tetrahedron_mesh();

/// Icosahedron cut `subdivisions` times, vertices on the sphere, with normals. 20 4^subdivisions triangles.
Mesh icosphere_mesh(int subdivisions, double radius = 1, Vec3d centre = {});

/// Torus about the z axis as torus_cloud, with normals. 2 rings sides triangles.
Mesh torus_mesh(int rings, int sides, double major = 1, double minor = 0.35);

/// Square [0, size]^2 at height `z`, facing +z, of cells x cells squares. No normals.
Mesh patch_mesh(int cells, double size = 1, double z = 0);

/// Moebius strip of `segments` >= 3 squares about the z axis: one border, one misoriented edge.
Mesh moebius_mesh(int segments);

/// Adds the vertices and triangles of `more` to `mesh`, which stay apart. Both must have the same origin, attributes
/// are not allowed; normals are kept if both have them.
void append(Mesh& mesh, const Mesh& more);

/// Every vertex moved by `offset` in float.
Mesh translated(const Mesh& mesh, Vec3f offset);

/// Every triangle turned over; normals too.
Mesh flipped(const Mesh& mesh);

}  // namespace pointskin::test
