// Sources: Gonzalez, "Measurement of areas on a sphere using Fibonacci and latitude-longitude lattices", Mathematical
// Geosciences 42, 2010 (places of the cameras); Marsaglia, "Choosing a point from the surface of a sphere", Annals of
// Mathematical Statistics 43, 1972 (random rotation: a unit vector in four dimensions).
#include "scan.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <optional>
#include <vector>

#include "core/vec3.hpp"
#include "depth_image.hpp"
#include "exec/cpu_primitives.hpp"
#include "random.hpp"

namespace pointskin::bench {
namespace {

/// Streams of random numbers that have nothing to do with each other.
enum class Stream : std::uint64_t { cameras, motions, pixels, outliers };

Random random_of(const ScanOptions& options, Stream stream, std::uint64_t index) {
  return {options.seed, (static_cast<std::uint64_t>(stream) << 56U) | index};
}

Vec3d gaussian_vector(Random& random) {
  const auto [a, b] = random.gaussian_pair();
  return {a, b, random.gaussian_pair()[0]};
}

/// `v` turned about the direction of `turn` by its length in radians (Rodrigues).
Vec3d turned(const Vec3d& v, const Vec3d& turn) {
  const double angle = length(turn);
  const Vec3d axis = normalized(turn);
  return std::cos(angle) * v + std::sin(angle) * cross(axis, v) + (1 - std::cos(angle)) * dot(axis, v) * axis;
}

/// A random rotation, as the vector of turned().
Vec3d random_turn(Random& random) {
  const Vec3d v = gaussian_vector(random);
  return 2 * std::atan2(length(v), random.gaussian_pair()[0]) * normalized(v);
}

Camera camera_of(const Scene& scene, const ScanOptions& options, int view) {
  Random together = random_of(options, Stream::cameras, 0);
  const Vec3d turn = random_turn(together);
  Random random = random_of(options, Stream::cameras, static_cast<std::uint64_t>(view) + 1);
  // Golden section in longitude, equal areas in latitude.
  const double z = 1 - (2 * view + 1.0) / options.views;
  const double longitude = std::numbers::pi * (3 - std::sqrt(5.0)) * view;
  const double r = std::sqrt(1 - z * z);
  const Vec3d outward = turned({r * std::cos(longitude), r * std::sin(longitude), z}, turn);

  const double nearest = options.distance * (1 - options.spread);
  const double distance = options.distance * (1 + options.spread * (2 * random.uniform() - 1));
  Camera camera;
  camera.position = scene.centre() + distance * scene.diagonal() * outward;
  camera.forward = -1 * outward;
  const Vec3d aside = std::abs(outward[2]) < 0.9 ? Vec3d{0, 0, 1} : Vec3d{1, 0, 0};
  camera.right =
      turned(normalized(cross(camera.forward, aside)), 2 * std::numbers::pi * random.uniform() * camera.forward);
  camera.up = cross(camera.right, camera.forward);
  camera.half_width = std::tan(std::asin(0.5 / nearest));  // all cameras have the lens of the nearest
  camera.resolution = options.resolution;
  return camera;
}

struct Motion {
  Vec3d shift, turn;
};

/// One rigid motion a view, whose mean is none.
std::vector<Motion> motions(const Scene& scene, const ScanOptions& options) {
  std::vector<Motion> result;
  Motion mean{};
  for (int view = 0; view < options.views; ++view) {
    Random random = random_of(options, Stream::motions, static_cast<std::uint64_t>(view));
    const Vec3d shift = options.misregistration * scene.diagonal() * gaussian_vector(random);
    result.push_back({shift, 2 * options.misregistration * gaussian_vector(random)});
    mean = {mean.shift + shift, mean.turn + result.back().turn};
  }
  for (Motion& motion : result) {
    motion.shift -= 1.0 / options.views * mean.shift;
    motion.turn -= 1.0 / options.views * mean.turn;
  }
  return result;
}

/// The normal that the scanner gives to a pixel, facing the camera, or nothing.
std::optional<Vec3d> normal_at(const DepthImage& image, const ScanOptions& options, double sigma_world, int row,
                               int column, Random& random) {
  std::optional<Vec3d> normal;
  if (options.normals == ScanNormals::exact)
    normal = image.normal(row, column) + options.normal_noise * gaussian_vector(random);
  else
    normal = image.fitted_normal(row, column, options.window,
                                 {std::tan(options.grazing * std::numbers::pi / 180), 6 * sigma_world});
  if (!normal) return std::nullopt;
  *normal = normalized(*normal);
  const double facing = -dot(*normal, image.camera().direction(row, column));
  if (std::abs(facing) < std::cos(options.grazing * std::numbers::pi / 180)) return std::nullopt;
  return facing < 0 ? -1 * *normal : *normal;
}

/// Scans one view and appends its points to `cloud`.
void add_view(exec::Cpu& ex, const Scene& scene, const ScanOptions& options, int view, const Motion& motion,
              Cloud& cloud) {
  const double sigma_world = options.sigma * scene.diagonal();
  const auto pixel_random = [&](int row, int column, std::uint64_t use) {
    const auto n = static_cast<std::uint64_t>(options.resolution);
    const auto pixel = (static_cast<std::uint64_t>(view) * n + static_cast<std::uint64_t>(row)) * n;
    return random_of(options, Stream::pixels, 2 * (pixel + static_cast<std::uint64_t>(column)) + use);
  };
  DepthImage image(camera_of(scene, options, view));
  ex.run_blocks(options.resolution, [&](std::int64_t row) {
    image.take_row(scene, static_cast<int>(row), [&](int column) {
      Random random = pixel_random(static_cast<int>(row), column, 0);
      return sigma_world * random.gaussian_pair()[0];
    });
  });
  std::vector<std::vector<SurfacePoint>> rows(static_cast<std::size_t>(options.resolution));
  ex.run_blocks(options.resolution, [&](std::int64_t at) {
    const int row = static_cast<int>(at);
    for (int column = 0; column < options.resolution; ++column) {
      if (!image.has(row, column)) continue;
      Random random = pixel_random(row, column, 1);
      const auto normal = normal_at(image, options, sigma_world, row, column, random);
      if (!normal) continue;
      const Vec3d from_centre = image.point(row, column) - scene.centre();
      const Vec3d moved = scene.centre() + (motion.shift + turned(from_centre, motion.turn));
      rows[static_cast<std::size_t>(row)].push_back({moved, turned(*normal, motion.turn)});
    }
  });
  for (const std::vector<SurfacePoint>& row : rows) {
    for (const SurfacePoint& point : row) {
      cloud.positions.push_back(to_float(point.position));
      cloud.normals.push_back(to_float(point.normal));
    }
  }
}

void add_outliers(const Scene& scene, const ScanOptions& options, Cloud& cloud) {
  const auto count = std::llround(static_cast<double>(cloud.size()) * options.outliers / (1 - options.outliers));
  const Vec3d half = 0.6 * (scene.upper - scene.lower);
  for (long long i = 0; i < count; ++i) {
    Random random = random_of(options, Stream::outliers, static_cast<std::uint64_t>(i));
    Vec3d p = scene.centre();
    for (std::size_t axis = 0; axis < 3; ++axis) p[axis] += half[axis] * (2 * random.uniform() - 1);
    cloud.positions.push_back(to_float(p));
    cloud.normals.push_back(to_float(normalized(gaussian_vector(random))));
  }
}

void check(const ScanOptions& o) {
  const auto need = [](bool fine, const char* what) {
    if (!fine) throw Error(ErrorCode::usage, what);
  };
  need(o.views > 0 && o.views <= 10'000, "the number of views must be in [1, 10000]");
  need(o.resolution >= 3 && o.resolution <= 10'000, "the resolution must be in [3, 10000] pixels");
  need(o.spread >= 0 && o.spread < 1, "the spread must be in [0, 1)");
  need(o.distance * (1 - o.spread) > 0.55 && o.distance <= 1000, "the nearest camera must be farther than 0.55");
  need(o.sigma >= 0 && o.misregistration >= 0 && o.normal_noise >= 0, "noise must be zero or positive");
  need(o.outliers >= 0 && o.outliers < 1, "the share of outliers must be in [0, 1)");
  need(o.grazing > 0 && o.grazing <= 90, "the grazing angle must be in (0, 90] degrees");
  need(o.window >= 1 && o.window <= 100, "the window must be in [1, 100] pixels");
}

}  // namespace

Cloud scan(const Scene& scene, const ScanOptions& options) {
  check(options);
  exec::Cpu ex(options.threads);
  const std::vector<Motion> moved = motions(scene, options);
  Cloud cloud;
  for (int view = 0; view < options.views; ++view)
    add_view(ex, scene, options, view, moved[static_cast<std::size_t>(view)], cloud);
  if (cloud.positions.empty()) throw Error(ErrorCode::empty_result, "no camera saw the surface");
  add_outliers(scene, options, cloud);
  return cloud;
}

}  // namespace pointskin::bench
