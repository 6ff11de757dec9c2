// Clouds; the meshes are in shape_meshes.cpp.
#include "support/shapes.hpp"
#include "core/vec3.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <numeric>
#include <utility>

namespace pointskin::test {
namespace {

constexpr double kPi = std::numbers::pi;

void add_point(Cloud& cloud, const Vec3d& position, const Vec3d& normal) {
  cloud.positions.push_back(to_float(position));
  cloud.normals.push_back(to_float(normal));
}

/// f(position) and g(normal) of every point.
template <class F, class G>
Cloud mapped(Cloud cloud, const F& f, const G& g) {
  for (Vec3f& p : cloud.positions) p = f(p);
  for (Vec3f& n : cloud.normals) n = g(n);
  return cloud;
}

Vec3f same(const Vec3f& v) { return v; }

/// A uniform point on a side of the box.
void add_box_point(Cloud& cloud, Random& random, const Vec3d& lower, const Vec3d& upper) {
  const Vec3d size{upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]};
  const Vec3d areas{size[1] * size[2], size[2] * size[0], size[0] * size[1]};
  double pick = random.unit() * (areas[0] + areas[1] + areas[2]);
  std::size_t axis = 0;
  while (axis < 2 && pick >= areas[axis]) pick -= areas[axis++];
  const bool at_upper = random.unit() < 0.5;
  Vec3d position{}, normal{};
  for (std::size_t k = 0; k < 3; ++k) position[k] = random.in(lower[k], upper[k]);
  position[axis] = at_upper ? upper[axis] : lower[axis];
  normal[axis] = at_upper ? 1 : -1;
  add_point(cloud, position, normal);
}

}  // namespace

Vec3d Random::direction() {
  // Archimedes: heights on a sphere are uniform.
  const double z = in(-1, 1), angle = in(0, 2 * kPi);
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

Cloud sphere_cloud(std::int64_t n, std::uint64_t seed, double radius, Vec3d centre) {
  Random random(seed);
  Cloud cloud;
  for (std::int64_t i = 0; i < n; ++i) {
    const Vec3d d = random.direction();
    add_point(cloud, {centre[0] + radius * d[0], centre[1] + radius * d[1], centre[2] + radius * d[2]}, d);
  }
  return cloud;
}

Cloud torus_cloud(std::int64_t n, std::uint64_t seed, double major, double minor, Vec3d centre) {
  Random random(seed);
  Cloud cloud;
  while (cloud.size() < n) {
    const double around = random.in(0, 2 * kPi), tube = random.in(0, 2 * kPi);
    const double ring = major + minor * std::cos(tube);
    // Area grows with the distance from the axis: keep a point with a chance in proportion to it.
    if (random.unit() * (major + minor) >= ring) continue;
    const Vec3d normal{std::cos(tube) * std::cos(around), std::cos(tube) * std::sin(around), std::sin(tube)};
    add_point(
        cloud,
        {centre[0] + ring * std::cos(around), centre[1] + ring * std::sin(around), centre[2] + minor * std::sin(tube)},
        normal);
  }
  return cloud;
}

Cloud linked_tori_cloud(std::int64_t n, std::uint64_t seed, double major, double minor) {
  Cloud cloud = torus_cloud(n / 2, seed, major, minor);
  // Rotating the axes turns the z axis into the y axis.
  const Cloud other = axes_rotated(torus_cloud(n - n / 2, seed + 1, major, minor));
  append(cloud, translated(other, {static_cast<float>(major), 0, 0}));
  return cloud;
}

Cloud box_cloud(std::int64_t n, std::uint64_t seed, Vec3d lower, Vec3d upper) {
  Random random(seed);
  Cloud cloud;
  for (std::int64_t i = 0; i < n; ++i) add_box_point(cloud, random, lower, upper);
  return cloud;
}

Cloud thin_plate_cloud(std::int64_t n, std::uint64_t seed, double thickness) {
  return box_cloud(n, seed, {-1, -1, -thickness / 2}, {1, 1, thickness / 2});
}

Cloud two_spheres_cloud(std::int64_t n, std::uint64_t seed, double gap) {
  Cloud cloud = sphere_cloud(n / 2, seed, 1, {-1 - gap / 2, 0, 0});
  append(cloud, sphere_cloud(n - n / 2, seed + 1, 1, {1 + gap / 2, 0, 0}));
  return cloud;
}

Cloud plane_cloud(std::int64_t n, std::uint64_t seed) {
  Random random(seed);
  Cloud cloud;
  for (std::int64_t i = 0; i < n; ++i) {
    const double x = random.in(-1, 1), y = random.in(-1, 1);
    add_point(cloud, {x, y, 0}, {0, 0, 1});
  }
  return cloud;
}

void append(Cloud& cloud, const Cloud& more) {
  cloud.positions.insert(cloud.positions.end(), more.positions.begin(), more.positions.end());
  cloud.normals.insert(cloud.normals.end(), more.normals.begin(), more.normals.end());
}

Cloud shuffled(const Cloud& cloud, std::uint64_t seed) {
  // Fisher-Yates by hand: std::shuffle differs between standard libraries.
  Random random(seed);
  Cloud result = cloud;
  std::vector<std::int64_t> order(cloud.positions.size());
  std::iota(order.begin(), order.end(), 0);
  for (std::int64_t i = cloud.size() - 1; i > 0; --i) {
    const auto a = static_cast<std::size_t>(i), b = static_cast<std::size_t>(random.below(i + 1));
    std::swap(result.positions[a], result.positions[b]);
    if (!result.normals.empty()) std::swap(result.normals[a], result.normals[b]);
    std::swap(order[a], order[b]);
  }
  for (Attribute& attribute : result.attributes) attribute.values = attribute.values.gather(order);
  return result;
}

Cloud jittered(const Cloud& cloud, std::uint64_t seed, double amount) {
  Random random(seed);
  const auto move = [&](float x) { return x + static_cast<float>(random.in(-amount, amount)); };
  return mapped(
      cloud,
      [&](const Vec3f& p) {
        return Vec3f{move(p.x), move(p.y), move(p.z)};
      },
      same);
}

Cloud scaled(const Cloud& cloud, float factor) {
  return mapped(
      cloud,
      [&](const Vec3f& p) {
        return Vec3f{p.x * factor, p.y * factor, p.z * factor};
      },
      same);
}

Cloud translated(const Cloud& cloud, Vec3f offset) {
  return mapped(
      cloud,
      [&](const Vec3f& p) {
        return Vec3f{p.x + offset.x, p.y + offset.y, p.z + offset.z};
      },
      same);
}

Cloud axes_rotated(const Cloud& cloud) {
  const auto rotate = [](const Vec3f& v) { return Vec3f{v.y, v.z, v.x}; };
  return mapped(cloud, rotate, rotate);
}

Cloud flipped(const Cloud& cloud) {
  return mapped(cloud, same, [](const Vec3f& n) { return Vec3f{-n.x, -n.y, -n.z}; });
}

}  // namespace pointskin::test
