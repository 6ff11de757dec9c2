// The meshes of shapes.hpp.
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>
#include <utility>

#include "core/vec3.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

constexpr double kPi = std::numbers::pi;

void add_square(Mesh& mesh, std::int32_t a, std::int32_t b, std::int32_t c, std::int32_t d) {
  mesh.triangles.push_back({a, b, c});
  mesh.triangles.push_back({a, c, d});
}

/// Unit vectors and triangles of a sphere, refined by halving edges.
struct Sphere {
  std::vector<Vec3d> vertices;
  std::vector<Triangle> triangles;
};

Vec3d unit(const Vec3d& v) {
  const double length = std::sqrt(v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
  return {v[0] / length, v[1] / length, v[2] / length};
}

Sphere icosahedron() {
  const double g = std::numbers::phi;
  Sphere sphere;
  for (const Vec3d& v : std::vector<Vec3d>{{-1, g, 0},
                                           {1, g, 0},
                                           {-1, -g, 0},
                                           {1, -g, 0},
                                           {0, -1, g},
                                           {0, 1, g},
                                           {0, -1, -g},
                                           {0, 1, -g},
                                           {g, 0, -1},
                                           {g, 0, 1},
                                           {-g, 0, -1},
                                           {-g, 0, 1}})
    sphere.vertices.push_back(unit(v));
  sphere.triangles = {{0, 11, 5},  {0, 5, 1},  {0, 1, 7},  {0, 7, 10}, {0, 10, 11}, {1, 5, 9}, {5, 11, 4},
                      {11, 10, 2}, {10, 7, 6}, {7, 1, 8},  {3, 9, 4},  {3, 4, 2},   {3, 2, 6}, {3, 6, 8},
                      {3, 8, 9},   {4, 9, 5},  {2, 4, 11}, {6, 2, 10}, {8, 6, 7},   {9, 8, 1}};
  return sphere;
}

Sphere refined(const Sphere& coarse) {
  Sphere fine{coarse.vertices, {}};
  std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
  const auto middle = [&](std::int32_t a, std::int32_t b) {
    const auto [it, is_new] = middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(fine.vertices.size()));
    if (is_new) {
      const Vec3d& p = coarse.vertices[static_cast<std::size_t>(a)];
      const Vec3d& q = coarse.vertices[static_cast<std::size_t>(b)];
      fine.vertices.push_back(unit({p[0] + q[0], p[1] + q[1], p[2] + q[2]}));
    }
    return it->second;
  };
  for (const auto& [a, b, c] : coarse.triangles) {
    const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
    fine.triangles.insert(fine.triangles.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
  }
  return fine;
}

}  // namespace

Mesh box_mesh(Vec3d lower, Vec3d upper) {
  Mesh mesh;
  for (int i = 0; i < 8; ++i)
    mesh.vertices.push_back(to_float(
        {(i & 1) != 0 ? upper[0] : lower[0], (i & 2) != 0 ? upper[1] : lower[1], (i & 4) != 0 ? upper[2] : lower[2]}));
  add_square(mesh, 0, 2, 3, 1);  // z lower
  add_square(mesh, 4, 5, 7, 6);  // z upper
  add_square(mesh, 0, 1, 5, 4);  // y lower
  add_square(mesh, 2, 6, 7, 3);  // y upper
  add_square(mesh, 0, 4, 6, 2);  // x lower
  add_square(mesh, 1, 3, 7, 5);  // x upper
  return mesh;
}

Mesh tetrahedron_mesh() {
  Mesh mesh;
  mesh.vertices = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  mesh.triangles = {{0, 2, 1}, {0, 1, 3}, {0, 3, 2}, {1, 2, 3}};
  return mesh;
}

Mesh icosphere_mesh(int subdivisions, double radius, Vec3d centre) {
  Sphere sphere = icosahedron();
  for (int i = 0; i < subdivisions; ++i) sphere = refined(sphere);
  Mesh mesh;
  for (const Vec3d& v : sphere.vertices) {
    mesh.vertices.push_back(
        to_float({centre[0] + radius * v[0], centre[1] + radius * v[1], centre[2] + radius * v[2]}));
    mesh.normals.push_back(to_float(v));
  }
  mesh.triangles = std::move(sphere.triangles);
  return mesh;
}

Mesh torus_mesh(int rings, int sides, double major, double minor) {
  Mesh mesh;
  const auto vertex = [&](int ring, int side) { return (ring % rings) * sides + side % sides; };
  for (int ring = 0; ring < rings; ++ring)
    for (int side = 0; side < sides; ++side) {
      const double around = 2 * kPi * ring / rings, tube = 2 * kPi * side / sides;
      const Vec3d n{std::cos(tube) * std::cos(around), std::cos(tube) * std::sin(around), std::sin(tube)};
      mesh.vertices.push_back(
          to_float({major * std::cos(around) + minor * n[0], major * std::sin(around) + minor * n[1], minor * n[2]}));
      mesh.normals.push_back(to_float(n));
      add_square(mesh, vertex(ring, side), vertex(ring + 1, side), vertex(ring + 1, side + 1), vertex(ring, side + 1));
    }
  return mesh;
}

Mesh patch_mesh(int cells, double size, double z) {
  Mesh mesh;
  for (int y = 0; y <= cells; ++y)
    for (int x = 0; x <= cells; ++x) mesh.vertices.push_back(to_float({size * x / cells, size * y / cells, z}));
  const int row = cells + 1;
  for (int y = 0; y < cells; ++y)
    for (int x = 0; x < cells; ++x) {
      const int a = y * row + x;
      add_square(mesh, a, a + 1, a + 1 + row, a + row);
    }
  return mesh;
}

Mesh moebius_mesh(int segments) {
  Mesh mesh;
  for (int i = 0; i < segments; ++i) {
    const double around = 2 * kPi * i / segments;
    for (const double side : {-0.3, 0.3}) {
      const double r = 1 + side * std::cos(around / 2);
      mesh.vertices.push_back(to_float({r * std::cos(around), r * std::sin(around), side * std::sin(around / 2)}));
    }
  }
  for (int i = 0; i + 1 < segments; ++i) add_square(mesh, 2 * i, 2 * i + 2, 2 * i + 3, 2 * i + 1);
  // Half a turn later the last square meets the first with its sides exchanged.
  const int last = 2 * segments - 2;
  add_square(mesh, last, 1, 0, last + 1);
  return mesh;
}

void append(Mesh& mesh, const Mesh& more) {
  const bool normals = mesh.normals.size() == mesh.vertices.size() && more.normals.size() == more.vertices.size();
  const auto first = static_cast<std::int32_t>(mesh.vertices.size());
  mesh.vertices.insert(mesh.vertices.end(), more.vertices.begin(), more.vertices.end());
  if (normals)
    mesh.normals.insert(mesh.normals.end(), more.normals.begin(), more.normals.end());
  else
    mesh.normals.clear();
  for (const auto& [a, b, c] : more.triangles) mesh.triangles.push_back({a + first, b + first, c + first});
}

Mesh translated(const Mesh& mesh, Vec3f offset) {
  Mesh result = mesh;
  for (Vec3f& v : result.vertices) v = {v.x + offset.x, v.y + offset.y, v.z + offset.z};
  return result;
}

Mesh flipped(const Mesh& mesh) {
  Mesh result = mesh;
  for (Triangle& t : result.triangles) std::swap(t[1], t[2]);
  for (Vec3f& n : result.normals) n = {-n.x, -n.y, -n.z};
  return result;
}

}  // namespace pointskin::test
