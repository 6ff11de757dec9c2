#include "support/stray_clouds.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <set>

#include "core/stray_limit.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

void add(Cloud& cloud, double x, double y, double z) {
  cloud.positions.push_back({static_cast<float>(x), static_cast<float>(y), static_cast<float>(z)});
  cloud.normals.push_back({0, 0, 1});
}

double normal_deviate(Random& random) {  // Box & Muller
  return std::sqrt(-2 * std::log(1 - random.unit())) * std::cos(2 * std::numbers::pi * random.unit());
}

Cloud blob(std::int64_t n, std::uint64_t seed) {
  Random random(seed);
  Cloud cloud;
  for (std::int64_t i = 0; i < n; ++i)
    add(cloud, normal_deviate(random), normal_deviate(random), normal_deviate(random));
  return cloud;
}

Cloud uniform_cube(std::int64_t n, std::uint64_t seed) {
  Random random(seed);
  Cloud cloud;
  for (std::int64_t i = 0; i < n; ++i) add(cloud, random.unit(), random.unit(), random.unit());
  return cloud;
}

Cloud helix(std::int64_t n, double turns) {
  Cloud cloud;
  for (std::int64_t i = 0; i < n; ++i) {
    const double t = static_cast<double>(i) / static_cast<double>(n) * turns;
    add(cloud, std::cos(2 * std::numbers::pi * t), std::sin(2 * std::numbers::pi * t), t);
  }
  return cloud;
}

/// A ground plane as a scanner at height 1 sees it: points at equal steps of the angle, density falls with the fourth
/// power of the distance.
Cloud scanned_ground(std::int64_t n, std::uint64_t seed, double farthest) {
  Random random(seed);
  Cloud cloud;
  for (std::int64_t i = 0; i < n; ++i) {
    const double r = std::tan(random.in(0, std::atan(farthest)));
    const double angle = random.in(0, 2 * std::numbers::pi);
    add(cloud, r * std::cos(angle), r * std::sin(angle), 0);
  }
  return cloud;
}

Cloud ring(std::int64_t n, double radius) {
  Cloud cloud;
  for (std::int64_t i = 0; i < n; ++i) {
    const double angle = 2 * std::numbers::pi * static_cast<double>(i) / static_cast<double>(n);
    add(cloud, radius * std::cos(angle), radius * std::sin(angle), 0);
  }
  return cloud;
}

Cloud sphere_and(const Cloud& more, std::int64_t n) {
  Cloud cloud = sphere_cloud(n, 1);
  append(cloud, more);
  return cloud;
}

/// Sphere whose density is e^(3 g) of a smooth g that is about normal, along one axis.
Cloud lognormal_density(std::int64_t n, std::uint64_t seed) {
  Random random(seed);
  Cloud cloud;
  while (cloud.size() < n) {
    const Vec3d p = random.direction();
    if (random.unit() < std::exp(3 * (std::sin(5 * p[0]) + std::sin(7 * p[1]) - 2))) add(cloud, p[0], p[1], p[2]);
  }
  return cloud;
}

Cloud repeated(const Cloud& cloud, std::size_t index, std::int64_t times) {
  Cloud result = cloud;
  for (std::int64_t i = 0; i < times; ++i) {
    result.positions.push_back(cloud.positions[index]);
    result.normals.push_back(cloud.normals[index]);
  }
  return result;
}

void add_small_clouds(std::vector<NamedCloud>& all) {
  Random random(77);
  for (std::int64_t n = 1; n <= 50; ++n) {
    Cloud cloud;
    for (std::int64_t i = 0; i < n; ++i) {
      const double far = std::pow(10.0, random.in(-3, 3));  // scattered over six decades
      const Vec3d d = random.direction();
      add(cloud, far * d[0], far * d[1], far * d[2]);
    }
    all.push_back({std::to_string(n) + " points", cloud});
  }
}

}  // namespace

std::vector<NamedCloud> clouds_without_strays() {
  std::vector<NamedCloud> all;
  add_small_clouds(all);
  all.push_back({"sphere", sphere_cloud(20'000, 1)});
  all.push_back({"linked tori", linked_tori_cloud(20'000, 2)});
  all.push_back({"rod 1:100", box_cloud(20'000, 3, {0, 0, 0}, {100, 1, 1})});
  all.push_back({"rod 1:10000", box_cloud(20'000, 4, {0, 0, 0}, {1, 1e4, 1})});
  all.push_back({"plate", thin_plate_cloud(20'000, 5, 0.01)});
  all.push_back({"plane", plane_cloud(20'000, 6)});
  all.push_back({"line", box_cloud(5'000, 7, {0, 0, 0}, {1, 1e-30, 1e-30})});
  all.push_back({"gaussian blob", blob(50'000, 8)});
  all.push_back({"uniform cube", uniform_cube(50'000, 9)});
  all.push_back({"helix", helix(5'000, 30)});
  all.push_back({"log-normal density", lognormal_density(20'000, 10)});
  all.push_back({"ground around a scanner", scanned_ground(100'000, 11, 100)});
  all.push_back({"sparse ring", sphere_and(ring(300, 10), 100'000)});
  all.push_back({"small far sphere", sphere_and(sphere_cloud(200, 12, 0.1, {50, 0, 0}), 200'000)});
  all.push_back({"equal clusters", sphere_and(sphere_cloud(20'000, 13, 1, {1000, 300, -700}), 20'000)});
  all.push_back({"clusters 1:50", sphere_and(sphere_cloud(400, 14, 1, {30, 0, 0}), 20'000)});
  all.push_back({"dense patch 1000:1", sphere_and(sphere_cloud(20'000, 15, 0.03, {1, 0, 0}), 2'000)});
  all.push_back({"dense patch, sparse rest", sphere_and(sphere_cloud(200'000, 16, 0.01, {1, 0, 0}), 2'000)});
  all.push_back({"duplicates", repeated(sphere_cloud(5'000, 17), 3, 50'000)});
  all.push_back({"nearly all at one place", repeated(sphere_cloud(20, 18), 3, 50'000)});
  all.push_back({"one place", repeated(sphere_cloud(1, 19), 0, 1000)});
  return all;
}

Cloud with_points_at(const Cloud& cloud, const std::vector<Vec3f>& places) {
  Cloud result = cloud;
  const std::size_t step = cloud.positions.size() / (places.size() + 1);
  for (std::size_t i = 0; i < places.size(); ++i) {
    const auto at = static_cast<std::ptrdiff_t>((i + 1) * step);
    result.positions.insert(result.positions.begin() + at, places[i]);
    result.normals.insert(result.normals.begin() + at, {0.6F, 0, 0.8F});
  }
  return result;
}

std::vector<Vec3f> places_around(int count, std::uint64_t seed, double nearest, double farthest, Vec3d centre) {
  Random random(seed);
  std::vector<Vec3f> places;
  for (int i = 0; i < count; ++i) {
    const double r = std::exp(random.in(std::log(nearest), std::log(farthest)));
    const Vec3d d = random.direction();
    places.push_back({static_cast<float>(centre[0] + r * d[0]), static_cast<float>(centre[1] + r * d[1]),
                      static_cast<float>(centre[2] + r * d[2])});
  }
  return places;
}

std::vector<NamedPlaces> stray_places() {
  std::vector<NamedPlaces> all = {
      {"one at 10^6", {{1e6F, 0, 0}}},
      {"one at -10^6", {{0, 0, -1e6F}}},
      {"one at 10^30", {{0, 1e30F, 0}}},
      {"several at unlike scales", {{1e6F, 0, 0}, {0, -1e3F, 0}, {0, 0, 3e37F}, {9, 9, 9}}},
      {"six directions", {{9, 0, 0}, {-9, 0, 0}, {0, 8, 0}, {0, -8, 0}, {0, 0, 7}, {0, 0, -7}}},
      {"two beside each other", {{500, 500, 1}, {500, 501, 1}}}};
  all.push_back({"20 at 3 to 10 diameters", places_around(20, 21, 6, 20)});
  all.push_back({"20 at 3 to 100 diameters", places_around(20, 22, 6, 200)});
  std::vector<Vec3f> mixed = places_around(20, 23, 6, 20);
  mixed.push_back({1e6F, -1e6F, 3});
  mixed.push_back({0, 1e3F, 0});
  all.push_back({"20 near, one at 10^3, one at 10^6", mixed});
  return all;
}

namespace {

double axis_of(const Vec3f& p, std::size_t a) { return a == 0 ? p.x : a == 1 ? p.y : p.z; }

struct BruteBox {
  std::array<double, 3> lower, upper;

  [[nodiscard]] double side() const {
    return std::max({upper[0] - lower[0], upper[1] - lower[1], upper[2] - lower[2]});
  }
  [[nodiscard]] double distance(const Vec3f& p) const {
    double d = 0;
    for (std::size_t a = 0; a < 3; ++a) d = std::max({d, lower[a] - axis_of(p, a), axis_of(p, a) - upper[a]});
    return d;
  }
  void add(const Vec3f& p) {
    for (std::size_t a = 0; a < 3; ++a) {
      lower[a] = std::min(lower[a], axis_of(p, a));
      upper[a] = std::max(upper[a], axis_of(p, a));
    }
  }
};

bool close(const Vec3f& p, const Vec3f& q, double d) {
  return std::abs(double{p.x} - q.x) <= d && std::abs(double{p.y} - q.y) <= d && std::abs(double{p.z} - q.z) <= d;
}

BruteBox box_of(const std::vector<Vec3f>& positions, const std::set<std::int64_t>& left_out) {
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  BruteBox box{{kInfinity, kInfinity, kInfinity}, {-kInfinity, -kInfinity, -kInfinity}};
  for (std::size_t i = 0; i < positions.size(); ++i)
    if (!left_out.contains(static_cast<std::int64_t>(i))) box.add(positions[i]);
  return box;
}

}  // namespace

std::vector<std::int64_t> brute_strays(const std::vector<Vec3f>& positions) {
  const auto n = static_cast<std::int64_t>(positions.size());
  const std::int64_t limit = stray_limit(n);
  if (limit == 0) return {};
  BruteBox core{};
  for (std::size_t a = 0; a < 3; ++a) {
    std::vector<double> sorted;
    for (const Vec3f& p : positions) sorted.push_back(axis_of(p, a));
    std::sort(sorted.begin(), sorted.end());
    core.lower[a] = sorted[static_cast<std::size_t>(limit)];
    core.upper[a] = sorted[static_cast<std::size_t>(n - 1 - limit)];
  }
  if (core.side() <= 0) return {};
  std::set<std::int64_t> outside;
  for (std::int64_t i = 0; i < n; ++i)
    if (core.distance(positions[static_cast<std::size_t>(i)]) > 0) outside.insert(i);
  const auto at = [&](std::int64_t i) { return positions[static_cast<std::size_t>(i)]; };
  for (bool grew = true; grew;) {
    std::vector<std::int64_t> taken;
    for (const std::int64_t i : outside)
      if (core.distance(at(i)) <= core.side()) taken.push_back(i);
    if (taken.empty() && std::ssize(outside) > kFewPoints)
      for (const std::int64_t i : outside) {
        const double reach = core.distance(at(i)) / 8;
        const auto company = std::count_if(outside.begin(), outside.end(), [&](std::int64_t j) {
          return at(j) != at(i) && close(at(i), at(j), reach);
        });
        if (company >= 8) taken.push_back(i);
      }
    for (const std::int64_t i : taken) {
      outside.erase(i);
      core.add(at(i));
    }
    grew = !taken.empty();
  }
  if (std::ssize(outside) > limit) return {};
  if (box_of(positions, {}).side() < 1.5 * box_of(positions, outside).side()) return {};
  return {outside.begin(), outside.end()};
}

}  // namespace pointskin::test
