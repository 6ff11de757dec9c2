// Area-uniform sampling of an implicit surface by rejection from a thin band around it.
#include <pointskin/error.hpp>

#include <algorithm>
#include <atomic>
#include <cmath>
#include <functional>
#include <thread>

#include "random.hpp"
#include "shapes.hpp"

namespace pointskin::bench {
namespace {

constexpr double kBand = 0.001;                // half the width of the band, world units
constexpr int kGridDepth = 8;                  // the band is drawn from cells of a 2^8 grid
constexpr std::int64_t kBlockDraws = 1 << 15;  // draws a thread makes at a time

/// Calls task(i) for i in [0, count) on `threads` threads.
void run_parallel(std::int64_t count, int threads, const std::function<void(std::int64_t)>& task) {
  std::atomic<std::int64_t> next{0};
  const auto work = [&] {
    for (std::int64_t i = next++; i < count; i = next++) task(i);
  };
  std::vector<std::thread> helpers;
  for (int t = 1; t < threads; ++t) helpers.emplace_back(work);
  work();
  for (std::thread& helper : helpers) helper.join();
}

int thread_count(int asked) { return asked > 0 ? asked : std::max(1U, std::thread::hardware_concurrency()); }

/// Lower corners of the grid's cells that may meet the band; the rest of the cube holds none of it.
struct Cells {
  double side = 0;
  std::vector<Vec3d> lower;

  [[nodiscard]] double volume() const { return side * side * side * static_cast<double>(lower.size()); }
};

/// Halves the cube `kGridDepth` times, dropping cells whose values stay away from zero by Shape::variation().
Cells cells_near_surface(const Shape& shape, int threads) {
  Cells cells{2 * kHalfExtent, {{-kHalfExtent, -kHalfExtent, -kHalfExtent}}};
  for (int depth = 1; depth <= kGridDepth; ++depth) {
    const double side = cells.side / 2;
    const double reach = side * std::sqrt(3.0) / 2 + 2 * kBand;
    constexpr std::int64_t kChunk = 1024;
    const auto parents = static_cast<std::int64_t>(cells.lower.size());
    std::vector<std::vector<Vec3d>> kept(static_cast<std::size_t>((parents + kChunk - 1) / kChunk));
    run_parallel(static_cast<std::int64_t>(kept.size()), threads, [&](std::int64_t chunk) {
      for (std::int64_t i = 8 * chunk * kChunk; i < 8 * std::min(parents, (chunk + 1) * kChunk); ++i) {
        const auto child = static_cast<unsigned>(i & 7);
        Vec3d lower = cells.lower[static_cast<std::size_t>(i / 8)];
        for (unsigned axis = 0; axis < 3; ++axis) lower[axis] += ((child >> axis) & 1U) != 0 ? side : 0;
        const Vec3d centre = {lower[0] + side / 2, lower[1] + side / 2, lower[2] + side / 2};
        if (std::abs(shape.at(centre).value) <= shape.variation(centre, reach))
          kept[static_cast<std::size_t>(chunk)].push_back(lower);
      }
    });
    cells = {side, {}};
    for (const std::vector<Vec3d>& part : kept) cells.lower.insert(cells.lower.end(), part.begin(), part.end());
  }
  return cells;
}

/// One draw: a uniform point of the cells. @returns true if it lies in the band
bool draw(const Shape& shape, const Cells& cells, Random& random, Vec3d& q, Sample& sample) {
  const auto pick = static_cast<std::size_t>(random.uniform() * static_cast<double>(cells.lower.size()));
  q = cells.lower[std::min(pick, cells.lower.size() - 1)];
  for (std::size_t a = 0; a < 3; ++a) q[a] += cells.side * random.uniform();
  sample = shape.at(q);
  const Vec3d& g = sample.gradient;
  return sample.value * sample.value < kBand * kBand * squared_length(g) && shape.is_seen(q);
}

void add_noise(SurfacePoint& point, const SamplingOptions& options, Random& random) {
  const auto [a, b] = random.gaussian_pair();
  const auto [c, d] = random.gaussian_pair();
  const auto [e, f] = random.gaussian_pair();
  const Vec3d shift = {a, b, c}, turn = {d, e, f};
  double norm2 = 0;
  for (std::size_t axis = 0; axis < 3; ++axis) {
    point.position[axis] += options.noise * shift[axis];
    point.normal[axis] += options.normal_noise * turn[axis];
    norm2 += point.normal[axis] * point.normal[axis];
  }
  point.normal = point.normal / std::sqrt(norm2);
}

std::vector<SurfacePoint> sample_block(const Shape& shape, const Cells& cells, const SamplingOptions& options,
                                       std::int64_t block) {
  std::vector<SurfacePoint> points;
  for (std::int64_t i = block * kBlockDraws; i < (block + 1) * kBlockDraws; ++i) {
    Random random(options.seed, static_cast<std::uint64_t>(i));
    Vec3d q;
    Sample sample;
    if (cells.lower.empty())
      points.push_back(shape.draw(random));
    else if (draw(shape, cells, random, q, sample))
      points.push_back(project(shape, q, sample));
    else
      continue;
    if (options.noise > 0 || options.normal_noise > 0) add_noise(points.back(), options, random);
  }
  return points;
}

Vec3f to_float(const Vec3d& v) {
  return {static_cast<float>(v[0]), static_cast<float>(v[1]), static_cast<float>(v[2])};
}

}  // namespace

Cloud sample_surface(const Shape& shape, const SamplingOptions& options) {
  if (options.points <= 0) throw Error(ErrorCode::usage, "the number of points must be positive");
  if (!(options.noise >= 0 && options.normal_noise >= 0))
    throw Error(ErrorCode::usage, "noise must be zero or positive");
  const int threads = thread_count(options.threads);
  const Cells cells = shape.own_area() > 0 ? Cells{} : cells_near_surface(shape, threads);

  Cloud cloud;
  cloud.positions.reserve(static_cast<std::size_t>(options.points));
  cloud.normals.reserve(static_cast<std::size_t>(options.points));
  // Blocks are appended in order and the excess is cut, so the number of blocks per round does not show.
  std::vector<std::vector<SurfacePoint>> blocks(static_cast<std::size_t>(threads) * 8);
  for (std::int64_t first = 0; cloud.size() < options.points; first += static_cast<std::int64_t>(blocks.size())) {
    run_parallel(static_cast<std::int64_t>(blocks.size()), threads, [&](std::int64_t b) {
      blocks[static_cast<std::size_t>(b)] = sample_block(shape, cells, options, first + b);
    });
    for (const std::vector<SurfacePoint>& block : blocks) {
      for (const SurfacePoint& point : block) {
        if (cloud.size() == options.points) break;
        cloud.positions.push_back(to_float(point.position));
        cloud.normals.push_back(to_float(point.normal));
      }
    }
  }
  return cloud;
}

double estimate_area(const Shape& shape, std::int64_t draws, std::uint64_t seed, int threads) {
  if (shape.own_area() > 0) return shape.own_area();
  const Cells cells = cells_near_surface(shape, thread_count(threads));
  const std::int64_t blocks = (draws + kBlockDraws - 1) / kBlockDraws;
  std::atomic<std::int64_t> hits{0};
  run_parallel(blocks, thread_count(threads), [&](std::int64_t block) {
    std::int64_t found = 0;
    for (std::int64_t i = block * kBlockDraws; i < (block + 1) * kBlockDraws; ++i) {
      Random random(seed, static_cast<std::uint64_t>(i));
      Vec3d q;
      Sample sample;
      found += draw(shape, cells, random, q, sample) ? 1 : 0;
    }
    hits += found;
  });
  return cells.volume() * static_cast<double>(hits) / static_cast<double>(blocks * kBlockDraws) / (2 * kBand);
}

}  // namespace pointskin::bench
