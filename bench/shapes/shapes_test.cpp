// The ground truth must be true: gradients, samples on the surface, and uniformity against an independent measure.
#include "shapes.hpp"

#include <gtest/gtest.h>

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <vector>

#include "random.hpp"
#include "rotated.hpp"

namespace pointskin::bench {
namespace {

Vec3d to_double(const Vec3f& v) { return {v.x, v.y, v.z}; }

class EveryShape : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<Shape> shape_ = make_shape(GetParam());
  Cloud cloud_ = sample_surface(*shape_, {.points = 20'000, .seed = 7});
};

TEST_P(EveryShape, HasTheGradientOfItsCentralDifferences) {
  for (std::size_t i = 0; i < 1000; ++i) {
    const Vec3d q = to_double(cloud_.positions[i]);
    const Vec3d gradient = shape_->at(q).gradient;
    for (std::size_t axis = 0; axis < 3; ++axis) {
      constexpr double kStep = 1e-5;  // error of the differences: kStep^2 F''' / 6, F''' below 1e5
      Vec3d below = q, above = q;
      below[axis] -= kStep;
      above[axis] += kStep;
      // Next to an edge the differences are those of two faces.
      if (shape_->own_area() > 0 && shape_->at(below).gradient != shape_->at(above).gradient) continue;
      EXPECT_NEAR(gradient[axis], (shape_->at(above).value - shape_->at(below).value) / (2 * kStep), 2e-4);
    }
  }
}

TEST_P(EveryShape, IsSampledOnItsSurfaceWithUnitOutwardNormals) {
  for (std::size_t i = 0; i < cloud_.positions.size(); ++i) {
    const Vec3d q = to_double(cloud_.positions[i]), normal = to_double(cloud_.normals[i]);
    EXPECT_LT(std::abs(signed_distance(*shape_, q)), 2e-7);  // float's rounding of coordinates near 1
    const Vec3d gradient = shape_->at(q).gradient;
    EXPECT_NEAR(dot(normal, normal), 1, 1e-6);
    EXPECT_NEAR(dot(normal, gradient), std::sqrt(dot(gradient, gradient)), 1e-5);
  }
}

TEST_P(EveryShape, BoundsItsOwnVariation) {
  Random random(11, 0);
  for (std::size_t i = 0; i < 20'000; ++i) {
    const double radius = 0.035 * random.uniform();
    Vec3d step;
    do step = {2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
    while (dot(step, step) > 1);
    const Vec3d surface = to_double(cloud_.positions[i]);
    const Vec3d q = {surface[0] + radius * step[0], surface[1] + radius * step[1], surface[2] + radius * step[2]};
    EXPECT_LE(std::abs(shape_->at(q).value), shape_->variation(q, radius) + 1e-6);  // 1e-6: `surface` is in float
  }
}

TEST_P(EveryShape, GivesTheSamePointsForAnyNumberOfThreads) {
  const SamplingOptions noisy{.points = 5'000, .seed = 3, .noise = 0.003, .normal_noise = 0.1, .threads = 1};
  SamplingOptions on_three = noisy;
  on_three.threads = 3;
  const Cloud one = sample_surface(*shape_, noisy), three = sample_surface(*shape_, on_three);
  EXPECT_EQ(one.positions, three.positions);
  EXPECT_EQ(one.normals, three.normals);
}

/// Crossings of uniformly random lines with the surface are area-uniform, with A = 2 pi R^2 crossings per line for
/// lines through a ball of radius R (Cauchy & Crofton). That shares nothing with the sampler but F.
/// Regions of space get the share of crossings; the sampler's points must agree with it.
class Regions {
 public:
  static constexpr std::size_t kCount = 27 * 3;
  static std::size_t of(const Vec3d& q) {
    std::size_t region = 0;
    for (const double x : {q.x, q.y, q.z}) region = region * 3 + (x < -0.3 ? 0U : x < 0.3 ? 1U : 2U);
    const double r = std::sqrt(dot(q, q));
    return region * 3 + (r < 0.97 ? 0U : r < 0.9995 ? 1U : 2U);
  }
};

struct Crossings {
  double lines = 0, total = 0;
  std::array<double, Regions::kCount> count{}, variance{};
};

/// Unit vector, uniform on the sphere (Archimedes).
Vec3d random_direction(Random& random) {
  const double z = 2 * random.uniform() - 1, angle = 2 * std::numbers::pi * random.uniform();
  const double r = std::sqrt(1 - z * z);
  return {r * std::cos(angle), r * std::sin(angle), z};
}

constexpr double kBallRadius = 1.1;  // holds every shape

std::vector<Vec3d> crossings_of_line(const Shape& shape, Random& random, int steps) {
  const Vec3d along = random_direction(random);
  const Vec3d side = std::abs(along[2]) < 0.9 ? Vec3d{-along[1], along[0], 0} : Vec3d{0, -along[2], along[1]};
  const double side_length = std::sqrt(dot(side, side));
  const Vec3d u = {side[0] / side_length, side[1] / side_length, side[2] / side_length};
  const Vec3d v = {along[1] * u[2] - along[2] * u[1], along[2] * u[0] - along[0] * u[2],
                   along[0] * u[1] - along[1] * u[0]};
  const double r = kBallRadius * std::sqrt(random.uniform()), angle = 2 * std::numbers::pi * random.uniform();
  const double half = std::sqrt(kBallRadius * kBallRadius - r * r);
  const auto point = [&](double t) {
    Vec3d q;
    for (std::size_t axis = 0; axis < 3; ++axis)
      q[axis] = r * (std::cos(angle) * u[axis] + std::sin(angle) * v[axis]) + t * along[axis];
    return q;
  };
  std::vector<Vec3d> found;
  const double step = 2 * half / steps;
  double before = shape.at(point(-half)).value;
  for (int i = 1; i <= steps; ++i) {
    const double after = shape.at(point(-half + i * step)).value;
    const Vec3d q = point(-half + (i - after / (after - before)) * step);
    if ((before < 0) != (after < 0) && shape.is_seen(q)) found.push_back(q);
    before = after;
  }
  return found;
}

Crossings cross(const Shape& shape, int lines, int steps) {
  Crossings crossings;
  std::vector<std::array<std::uint16_t, Regions::kCount>> per_line(static_cast<std::size_t>(lines));
  for (std::size_t line = 0; line < per_line.size(); ++line) {
    Random random(99, line);
    for (const Vec3d& q : crossings_of_line(shape, random, steps)) ++per_line[line][Regions::of(q)];
    for (std::size_t k = 0; k < Regions::kCount; ++k) crossings.count[k] += per_line[line][k];
  }
  crossings.lines = lines;
  for (const double count : crossings.count) crossings.total += count;
  for (const auto& line : per_line) {  // variance of a ratio: crossings of one line are not independent
    double all = 0;
    for (const std::uint16_t count : line) all += count;
    for (std::size_t k = 0; k < Regions::kCount; ++k) {
      const double residual = line[k] - crossings.count[k] / crossings.total * all;
      crossings.variance[k] += residual * residual / (crossings.total * crossings.total);
    }
  }
  return crossings;
}

TEST_P(EveryShape, IsSampledWithTheSameDensityEverywhere) {
  const bool costly = std::string(GetParam()) == "knot";
  const Crossings crossings = cross(*shape_, costly ? 4'000 : 20'000, 700);
  const Cloud cloud = sample_surface(*shape_, {.points = costly ? 50'000 : 200'000, .seed = 5});
  std::array<double, Regions::kCount> count{};
  for (const Vec3f& p : cloud.positions) ++count[Regions::of(to_double(p))];
  const auto n = static_cast<double>(cloud.size());
  for (std::size_t k = 0; k < Regions::kCount; ++k) {
    const double expected = crossings.count[k] / crossings.total;
    const double sigma = std::sqrt(crossings.variance[k] + expected * (1 - expected) / n);
    EXPECT_NEAR(count[k] / n, expected, 5 * sigma + 2e-4) << "region " << k;  // 2e-4: roots found along the line
  }
  const double area = 2 * std::numbers::pi * kBallRadius * kBallRadius * crossings.total / crossings.lines;
  EXPECT_NEAR(estimate_area(*shape_, 2'000'000, 1), area, 0.03 * area);
}

/// Samples of F on a grid: which points lie inside.
class Voxels {
 public:
  Voxels(const Shape& shape, int side) : side_(side), inside_(index(0, 0, side)) {
    for (int z = 0; z < side; ++z)
      for (int y = 0; y < side; ++y)
        for (int x = 0; x < side; ++x) inside_[index(x, y, z)] = shape.at({place(x), place(y), place(z)}).value < 0;
  }

  /// Euler number of the cubes, squares, edges and points whose corners all lie inside.
  [[nodiscard]] std::int64_t euler_of_solid() const {
    std::int64_t sum = 0;
    for (int kind = 0; kind < 8; ++kind) {  // one bit an axis that the cell extends along
      const int dx = kind & 1, dy = kind >> 1 & 1, dz = kind >> 2;
      std::int64_t cells = 0;
      for (int z = 0; z + dz < side_; ++z)
        for (int y = 0; y + dy < side_; ++y)
          for (int x = 0; x + dx < side_; ++x) cells += whole(x, y, z, dx, dy, dz) ? 1 : 0;
      sum += (dx + dy + dz) % 2 == 0 ? cells : -cells;
    }
    return sum;
  }

  /// Connected parts of the inside (neighbours share a face) and of the outside (neighbours share a corner).
  [[nodiscard]] std::int64_t parts() const {
    std::vector<bool> seen(inside_.size());
    std::int64_t count = 0;
    for (int z = 0; z < side_; ++z)
      for (int y = 0; y < side_; ++y)
        for (int x = 0; x < side_; ++x)
          if (!seen[index(x, y, z)]) ++count, flood({x, y, z}, seen);
    return count;
  }

 private:
  [[nodiscard]] std::size_t index(int x, int y, int z) const {
    return static_cast<std::size_t>((z * side_ + y) * side_ + x);
  }
  [[nodiscard]] double place(int i) const {
    return 1.1 * (2 * (i + 0.37) / side_ - 1);
  }  // no symmetry of a shape hits the grid

  [[nodiscard]] bool whole(int x, int y, int z, int dx, int dy, int dz) const {
    for (int c = 0; c <= dz; ++c)
      for (int b = 0; b <= dy; ++b)
        for (int a = 0; a <= dx; ++a)
          if (!inside_[index(x + a, y + b, z + c)]) return false;
    return true;
  }

  void flood(const std::array<int, 3>& start, std::vector<bool>& seen) const {
    std::vector<std::array<int, 3>> open{start};
    const bool inside = inside_[index(start[0], start[1], start[2])];
    seen[index(start[0], start[1], start[2])] = true;
    while (!open.empty()) {
      const auto [x, y, z] = open.back();
      open.pop_back();
      for (int n = 0; n < 27; ++n) {
        const int dx = n % 3 - 1, dy = n / 3 % 3 - 1, dz = n / 9 - 1;
        if (inside && std::abs(dx) + std::abs(dy) + std::abs(dz) > 1) continue;
        const int nx = x + dx, ny = y + dy, nz = z + dz;
        if (std::min({nx, ny, nz}) < 0 || std::max({nx, ny, nz}) >= side_) continue;
        if (seen[index(nx, ny, nz)] || inside_[index(nx, ny, nz)] != inside) continue;
        seen[index(nx, ny, nz)] = true;
        open.push_back({nx, ny, nz});
      }
    }
  }

  int side_;
  std::vector<bool> inside_;
};

TEST_P(EveryShape, HasTheTopologyOfItsVoxels) {
  const bool thin = std::string(GetParam()) == "gyroid";  // its rim has slivers
  const Voxels voxels(*shape_, thin ? 320 : 160);
  const Topology topology = shape_->topology();
  EXPECT_EQ(topology.euler, 2 * voxels.euler_of_solid());  // a closed surface bounds the solid
  EXPECT_EQ(topology.components + 1, voxels.parts());      // each surface parts one region from another
}

TEST_P(EveryShape, BoundsItsOwnGradient) {
  Random random(17, 0);
  for (int i = 0; i < 20'000; ++i) {
    const Vec3d q = {3 * random.uniform() - 1.5, 3 * random.uniform() - 1.5, 3 * random.uniform() - 1.5};
    const Vec3d gradient = shape_->at(q).gradient;
    EXPECT_LE(std::sqrt(dot(gradient, gradient)), shape_->lipschitz() + 1e-12);
  }
}

TEST_P(EveryShape, KnowsItsNearestPointsIfItIsADistance) {
  if (!shape_->is_distance()) GTEST_SKIP() << "see bench/accuracy/closest_point_test.cpp";
  Random random(13, 0);
  for (int i = 0; i < 300; ++i) {
    const Vec3d q = {3 * random.uniform() - 1.5, 3 * random.uniform() - 1.5, 3 * random.uniform() - 1.5};
    const SurfacePoint nearest = shape_->closest(q);
    const auto distance_to = [&](const Vec3d& p) { return std::hypot(q[0] - p[0], q[1] - p[1], q[2] - p[2]); };
    const double distance = distance_to(nearest.position);
    EXPECT_NEAR(shape_->at(nearest.position).value, 0, 1e-12);
    EXPECT_NEAR(dot(nearest.normal, nearest.normal), 1, 1e-12);
    EXPECT_NEAR(std::abs(shape_->at(q).value), distance, 1e-12);
    for (const Vec3f& p : cloud_.positions) ASSERT_LE(distance, distance_to(to_double(p)) + 1e-6);
  }
}

INSTANTIATE_TEST_SUITE_P(Bench, EveryShape, testing::ValuesIn(kShapeNames),
                         [](const auto& info) { return std::string(info.param); });
INSTANTIATE_TEST_SUITE_P(Rotated, EveryShape, testing::Values("torus@1", "slab@2", "hand@2"), [](const auto& info) {
  std::string name = info.param;
  std::replace(name.begin(), name.end(), '@', '_');
  return name;
});

TEST(Rotations, AreRotationsAndKeepTheDistance) {
  const Vec3d x{1, 0, 0}, y{0, 1, 0}, z{0, 0, 1};
  for (int rotation = 1; rotation <= kRotations; ++rotation) {
    const Vec3d a = rotated(x, rotation), b = rotated(y, rotation), c = rotated(z, rotation);
    EXPECT_NEAR(dot(a, b), 0, 1e-15);
    EXPECT_NEAR(a.x * (b.y * c.z - b.z * c.y) - a.y * (b.x * c.z - b.z * c.x) + a.z * (b.x * c.y - b.y * c.x), 1,
                1e-15);
    for (const Vec3d& v : {a, b, c})
      for (std::size_t axis = 0; axis < 3; ++axis) EXPECT_LT(std::abs(v[axis]), 0.92) << "turned well away";
    EXPECT_NEAR(unrotated(a, rotation).x, 1, 1e-15);
    const auto slab = make_shape("slab@" + std::to_string(rotation));
    const Vec3d q{0.3, -0.2, 0.7};
    const SurfacePoint nearest = slab->closest(q);
    const Vec3d off = q - nearest.position;
    EXPECT_NEAR(std::sqrt(dot(off, off)), slab->at(q).value, 1e-12);
  }
  EXPECT_THROW(make_shape("slab@3"), Error);
  EXPECT_THROW(make_shape("slab@"), Error);
}

TEST(EstimateArea, KnowsTheSphereTheTorusAndThePlate) {
  constexpr double kPi = std::numbers::pi;
  EXPECT_NEAR(estimate_area(*make_shape("sphere"), 10'000'000, 1), 4 * kPi, 0.01 * 4 * kPi);
  EXPECT_NEAR(estimate_area(*make_shape("torus"), 10'000'000, 1), 4 * kPi * kPi * 0.7 * 0.25, 0.07);
  // Two faces of 1.76 by 1.16, half a cylinder of radius 0.02 along each side, one ball in the four corners.
  const double plate = 2 * 1.76 * 1.16 + 2 * kPi * 0.02 * (1.76 + 1.16) + 4 * kPi * 0.02 * 0.02;
  EXPECT_NEAR(estimate_area(*make_shape("plate"), 10'000'000, 1), plate, 0.01 * plate);
}

TEST(EstimateArea, KnowsTheSlabAndTheNestedSpheres) {
  EXPECT_DOUBLE_EQ(estimate_area(*make_shape("slab"), 1, 1), 2 * (1.8 * 1.2 + 1.8 * 0.04 + 1.2 * 0.04));
  const double nested = 4 * std::numbers::pi * (0.3 * 0.3 + 0.6 * 0.6 + 0.95 * 0.95);
  EXPECT_NEAR(estimate_area(*make_shape("nested"), 10'000'000, 1), nested, 0.01 * nested);
}

TEST(SampleSurface, DrawsTheFacesOfTheSlabByArea) {
  const Cloud cloud = sample_surface(*make_shape("slab"), {.points = 200'000, .seed = 9});
  std::array<double, 6> count{};
  for (std::size_t i = 0; i < cloud.normals.size(); ++i) {
    const Vec3d n = to_double(cloud.normals[i]);
    for (std::size_t axis = 0; axis < 3; ++axis)
      if (n[axis] != 0) ++count[2 * axis + (n[axis] > 0 ? 1U : 0U)];
  }
  const Vec3d areas = {1.2 * 0.04, 1.8 * 0.04, 1.8 * 1.2};
  for (std::size_t face = 0; face < 6; ++face) {
    const double share = areas[face / 2] / (2 * (areas[0] + areas[1] + areas[2]));
    EXPECT_NEAR(count[face] / 200'000, share, 5 * std::sqrt(share / 200'000)) << "face " << face;
  }
}

TEST(SampleSurface, TurnsTheNormalsOfACavityInwards) {
  const Cloud cloud = sample_surface(*make_shape("nested"), {.points = 20'000, .seed = 4});
  std::array<int, 3> count{};
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3d q = to_double(cloud.positions[i]);
    const double r = std::sqrt(dot(q, q));
    const std::size_t sphere = r < 0.45 ? 0 : r < 0.8 ? 1 : 2;
    ++count[sphere];
    EXPECT_NEAR(r, (std::array{0.3, 0.6, 0.95})[sphere], 1e-6);
    EXPECT_NEAR(dot(q, to_double(cloud.normals[i])) / r, sphere == 1 ? -1 : 1, 1e-6);
  }
  for (const int points : count) EXPECT_GT(points, 1000);
}

TEST(SampleSurface, AddsNoiseOfTheGivenSigma) {
  const auto sphere = make_shape("sphere");
  const Cloud cloud = sample_surface(*sphere, {.points = 100'000, .seed = 2, .noise = 0.003, .normal_noise = 0.1});
  double squares = 0, tilt = 0;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3d q = to_double(cloud.positions[i]), n = to_double(cloud.normals[i]);
    squares += std::pow(std::sqrt(dot(q, q)) - 1, 2);
    tilt += 1 - std::pow(dot(q, n), 2) / dot(q, q);
    EXPECT_NEAR(dot(n, n), 1, 1e-6);
  }
  const auto count = static_cast<double>(cloud.size());
  EXPECT_NEAR(std::sqrt(squares / count), 0.003, 0.00003);
  EXPECT_NEAR(std::sqrt(tilt / count), 0.1 * std::sqrt(2.0), 0.003);  // two tangential components, renormalised
}

TEST(SampleSurface, RefusesOptionsOutOfRange) {
  const auto sphere = make_shape("sphere");
  EXPECT_THROW(sample_surface(*sphere, {.points = 0}), Error);
  EXPECT_THROW(sample_surface(*sphere, {.noise = -1}), Error);
  EXPECT_THROW(make_shape("klein bottle"), Error);
}

}  // namespace
}  // namespace pointskin::bench
