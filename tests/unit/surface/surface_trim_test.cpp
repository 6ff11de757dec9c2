// Cutting a surface along an iso-line, against clipping every triangle by itself.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <map>
#include <numbers>
#include <queue>
#include <set>
#include <string>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"
#include "support/shapes.hpp"
#include "support/spaces.hpp"
#include "surface/trim.hpp"

namespace pointskin {
namespace {

using test::Random;

double triangle_area(const Mesh& mesh, const Triangle& t) {
  Vec3d corner[3];
  for (std::size_t k = 0; k < 3; ++k) corner[k] = to_double(mesh.vertices[static_cast<std::size_t>(t[k])]);
  Vec3d u, v;
  for (std::size_t a = 0; a < 3; ++a) {
    u[a] = corner[1][a] - corner[0][a];
    v[a] = corner[2][a] - corner[0][a];
  }
  return 0.5 * std::hypot(u[1] * v[2] - u[2] * v[1], u[2] * v[0] - u[0] * v[2], u[0] * v[1] - u[1] * v[0]);
}

struct Trimmed {
  Mesh mesh;
  surface::TrimCounts counts;
};

Trimmed trimmed(const Mesh& mesh, const std::vector<float>& values, const surface::TrimOptions& options,
                int threads = 2) {
  exec::Cpu ex(threads);
  surface::Surface s{test::upload(ex, mesh.vertices), test::upload(ex, mesh.normals), test::upload(ex, mesh.triangles)};
  const auto at = test::upload(ex, values);
  Trimmed result;
  s = surface::trim_surface(ex, std::move(s), at.cview(), options, result.counts);
  result.mesh.vertices = test::to_host(ex, s.positions);
  result.mesh.normals = test::to_host(ex, s.normals);
  result.mesh.triangles = test::to_host(ex, s.triangles);
  return result;
}

std::vector<float> values_of(const Mesh& mesh, const std::function<double(const Vec3d&)>& f) {
  std::vector<float> values;
  for (const Vec3f& v : mesh.vertices) values.push_back(static_cast<float>(f(to_double(v))));
  return values;
}

/// Where the cut crosses from `a` to `b`: as far from the ends as documented.
double crossing(double a, double b, double limit) { return std::clamp((limit - a) / (b - a), 1e-3, 1 - 1e-3); }

/// What is kept of one triangle, as a share of its area: by its corners' sides and the crossings of two edges.
double kept_share(const double (&value)[3], const bool (&kept)[3], double limit) {
  const int corners = static_cast<int>(kept[0]) + static_cast<int>(kept[1]) + static_cast<int>(kept[2]);
  if (corners == 0 || corners == 3) return corners / 3;
  for (int k = 0; k < 3; ++k) {
    const int n = (k + 1) % 3;
    const int l = (k + 2) % 3;
    if (kept[n] != kept[l]) continue;
    const double corner = crossing(value[k], value[n], limit) * crossing(value[k], value[l], limit);
    return kept[k] ? corner : 1 - corner;
  }
  return 0;
}

double kept_area(const Mesh& mesh, const Triangle& t, const std::vector<float>& values, const std::vector<bool>& kept,
                 double limit) {
  double value[3];
  bool stays[3];
  for (std::size_t k = 0; k < 3; ++k) {
    value[k] = values[static_cast<std::size_t>(t[k])];
    stays[k] = kept[static_cast<std::size_t>(t[k])];
  }
  return kept_share(value, stays, limit) * triangle_area(mesh, t);
}

/// Sides of the vertices, after the small pieces have changed theirs: by flood filling.
struct Reference {
  std::vector<bool> kept;
  double area = 0;
  int holes_filled = 0, islands_removed = 0;
};

int flip_small(const Mesh& mesh, const std::vector<float>& values, const surface::TrimOptions& options, double least,
               bool side, std::vector<bool>& kept) {
  std::vector<std::set<std::size_t>> neighbours(mesh.vertices.size());
  std::vector<std::vector<std::size_t>> star(mesh.vertices.size());
  for (std::size_t i = 0; i < mesh.triangles.size(); ++i)
    for (std::size_t k = 0; k < 3; ++k) {
      const auto a = static_cast<std::size_t>(mesh.triangles[i][k]);
      const auto b = static_cast<std::size_t>(mesh.triangles[i][(k + 1) % 3]);
      neighbours[a].insert(b);
      neighbours[b].insert(a);
      star[a].push_back(i);
    }
  std::vector<bool> seen(kept.size());
  const std::vector<bool> before = kept;
  int flipped = 0;
  for (std::size_t start = 0; start < kept.size(); ++start) {
    if (seen[start] || before[start] != side) continue;
    std::vector<std::size_t> piece = {start};
    seen[start] = true;
    std::set<std::size_t> touched;
    for (std::size_t i = 0; i < piece.size(); ++i) {
      touched.insert(star[piece[i]].begin(), star[piece[i]].end());
      for (const std::size_t n : neighbours[piece[i]])
        if (!seen[n] && before[n] == side) {
          seen[n] = true;
          piece.push_back(n);
        }
    }
    // A split triangle has parts of two pieces only, so all of one side of it belongs to this piece.
    double area = 0;
    for (const std::size_t i : touched) {
      const double whole = triangle_area(mesh, mesh.triangles[i]);
      const double stays = kept_area(mesh, mesh.triangles[i], values, before, options.limit);
      area += side ? stays : whole - stays;
    }
    if (area >= least) continue;
    ++flipped;
    for (const std::size_t v : piece) kept[v] = !side;
  }
  return flipped;
}

Reference reference(const Mesh& mesh, const std::vector<float>& values, const surface::TrimOptions& options) {
  Reference r;
  for (const float value : values) r.kept.push_back(value <= options.limit);
  double total = 0;
  for (const Triangle& t : mesh.triangles) total += triangle_area(mesh, t);
  const double least = options.island_ratio * total;
  if (least > 0) {
    r.holes_filled = flip_small(mesh, values, options, least, false, r.kept);
    r.islands_removed = flip_small(mesh, values, options, least, true, r.kept);
  }
  for (const Triangle& t : mesh.triangles) r.area += kept_area(mesh, t, values, r.kept, options.limit);
  return r;
}

void expect_as_reference(const Mesh& mesh, const std::vector<float>& values, const surface::TrimOptions& options) {
  const Reference expected = reference(mesh, values, options);
  const Trimmed got = trimmed(mesh, values, options);
  EXPECT_EQ(got.counts.holes_filled, expected.holes_filled);
  EXPECT_EQ(got.counts.islands_removed, expected.islands_removed);
  EXPECT_NEAR(got.counts.area_kept, expected.area, 1e-5 * expected.area);
  const MeshReport report = measure(got.mesh);
  EXPECT_NEAR(report.area, expected.area, 1e-5 * expected.area);
  EXPECT_TRUE(report.manifold());
  EXPECT_TRUE(report.oriented());
  EXPECT_EQ(report.used_vertices, report.vertices);
  // The vertices that stay come first, in their order and with their bits.
  std::size_t next = 0;
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    if (!expected.kept[v]) continue;
    ASSERT_LT(next, got.mesh.vertices.size());
    ASSERT_EQ(got.mesh.vertices[next], mesh.vertices[v]);
    ASSERT_EQ(got.mesh.normals[next], mesh.normals[v]);
    ++next;
  }
  for (const Vec3f& n : got.mesh.normals) ASSERT_NEAR(std::hypot(n.x, n.y, n.z), 1, 1e-5);
  const auto two = [](const Vec3f& v) { return std::vector<float>{v.x, v.y, v.z}; };
  std::set<std::vector<float>> places;
  for (const Vec3f& v : got.mesh.vertices) ASSERT_TRUE(places.insert(two(v)).second) << "two vertices at one place";
}

TEST(Trim, LeavesASurfaceAsItIsWhereNothingIsBeyondTheLimit) {
  const Mesh mesh = test::icosphere_mesh(3);
  const Trimmed got = trimmed(mesh, values_of(mesh, [](const Vec3d& p) { return p[2]; }), {2, 0.001});
  EXPECT_EQ(got.mesh.vertices, mesh.vertices);
  EXPECT_EQ(got.mesh.normals, mesh.normals);
  EXPECT_EQ(got.mesh.triangles, mesh.triangles);
  EXPECT_EQ(got.counts.triangles_removed + got.counts.triangles_split, 0);
  EXPECT_EQ(got.counts.area_kept, got.counts.area_before);
}

TEST(Trim, LeavesNothingWhereAllIsBeyondTheLimit) {
  const Mesh mesh = test::icosphere_mesh(3);
  const Trimmed got = trimmed(mesh, values_of(mesh, [](const Vec3d& p) { return p[2]; }), {-2, 0.001});
  EXPECT_TRUE(got.mesh.triangles.empty());
  EXPECT_TRUE(got.mesh.vertices.empty());
  EXPECT_EQ(got.counts.triangles_removed, static_cast<std::int64_t>(mesh.triangles.size()));
  EXPECT_EQ(got.counts.area_kept, 0);
  EXPECT_TRUE(trimmed({}, {}, {0, 0.001}).mesh.triangles.empty());
}

TEST(Trim, CutsASphereAlongACircle) {
  const Mesh mesh = test::icosphere_mesh(5);
  const double limit = 0.3;
  const Trimmed got = trimmed(mesh, values_of(mesh, [](const Vec3d& p) { return p[2]; }), {0.3F, 0.001});
  const MeshReport report = measure(got.mesh);
  EXPECT_EQ(report.euler, 1);
  EXPECT_GT(report.boundary_edges, 50);
  EXPECT_EQ(report.boundary_edges, got.counts.triangles_split);
  EXPECT_NEAR(report.area, 2 * std::numbers::pi * (1 + limit), 0.01);
  std::int64_t on_the_line = 0;
  for (const Vec3f& v : got.mesh.vertices) {
    ASSERT_LT(v.z, limit + 1e-4);  // edges are at most 0.08 long, and the margin a thousandth of them
    on_the_line += std::abs(v.z - limit) < 1e-4 ? 1 : 0;
  }
  EXPECT_GE(on_the_line, report.boundary_edges);
}

TEST(Trim, OfRandomValuesIsAManifoldOfTheAreaThatClippingGives) {
  for (std::uint64_t seed = 1; seed <= 20; ++seed) {
    SCOPED_TRACE("seed " + std::to_string(seed));
    Random random(seed);
    const Mesh mesh = seed % 2 == 0 ? test::icosphere_mesh(3) : test::torus_mesh(31, 17);
    std::vector<float> values;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) values.push_back(static_cast<float>(random.in(1, 3)));
    for (const double ratio : {0.0, 0.0005, 0.002, 0.02})
      expect_as_reference(mesh, values, {static_cast<float>(random.in(1.2, 2.8)), ratio});
  }
}

TEST(Trim, OfSmoothValuesClearsTheSmallPieces) {
  const Mesh mesh = test::icosphere_mesh(5);
  const auto values =
      values_of(mesh, [](const Vec3d& p) { return std::sin(9 * p[0]) * std::sin(7 * p[1] + 1) + 0.6 * p[2]; });
  for (const double ratio : {0.0, 0.003, 0.01, 0.03, 0.1})
    for (const float limit : {-0.7F, -0.3F, 0.0F, 0.4F, 0.9F}) {
      SCOPED_TRACE(std::to_string(ratio) + ", limit " + std::to_string(limit));
      expect_as_reference(mesh, values, {limit, ratio});
    }
}

/// Rings around the middle of a square, by distance: a speck that stays within a hole that is filled.
TEST(Trim, FillsAHoleWithAllThatIsInIt) {
  Mesh mesh = test::patch_mesh(100);
  mesh.normals.assign(mesh.vertices.size(), {0, 0, 1});
  const auto values = values_of(mesh, [](const Vec3d& p) {
    const double r = std::hypot(p[0] - 0.5, p[1] - 0.5);
    return r < 0.02 || r > 0.04 ? 0 : 1;
  });
  const Trimmed got = trimmed(mesh, values, {0.5F, 0.01});
  EXPECT_EQ(got.mesh.triangles, mesh.triangles);
  EXPECT_EQ(got.counts.holes_filled, 1);
  EXPECT_EQ(got.counts.islands_removed, 0);
  const MeshReport open = measure(trimmed(mesh, values, {0.5F, 0}).mesh);
  EXPECT_EQ(open.components, 2);
}

TEST(Trim, GivesTheSameBytesForAnyNumberOfThreads) {
  const Mesh mesh = test::icosphere_mesh(6);
  const auto values =
      values_of(mesh, [](const Vec3d& p) { return std::sin(20 * p[0]) * std::sin(17 * p[1] + 1) + 0.6 * p[2]; });
  const surface::TrimOptions options{0.1F, 0.002};
  const Trimmed expected = trimmed(mesh, values, options, 1);
  EXPECT_GT(expected.counts.islands_removed + expected.counts.holes_filled, 3);
  for (const int threads : {2, 5, 16}) {
    const Trimmed got = trimmed(mesh, values, options, threads);
    EXPECT_EQ(got.mesh.vertices, expected.mesh.vertices);
    EXPECT_EQ(got.mesh.normals, expected.mesh.normals);
    EXPECT_EQ(got.mesh.triangles, expected.mesh.triangles);
    EXPECT_EQ(got.counts.area_kept, expected.counts.area_kept);
  }
}

}  // namespace
}  // namespace pointskin
