// The scores are those of src/mesh/compare.cpp, with a shape's exact surface in the place of one mesh.
#include "metrics.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <functional>
#include <vector>

#include "closest_point.hpp"
#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"
#include "mesh/both_ways.hpp"
#include "mesh/surface_samples.hpp"
#include "mesh/triangle_tree.hpp"

namespace pointskin::bench {
namespace {

using mesh_detail::Direction;
using Json = nlohmann::ordered_json;

constexpr std::int64_t kBlock = 1024;
constexpr std::int64_t kAreaDraws = 4'000'000;

/// What one sample found on the other surface.
struct Found {
  double distance = 0;
  double cosine = 0;  ///< |n . n'|, or negative where a triangle has no normal
};

double cosine_of(const Vec3d& a, const Vec3d& b) {
  if (a == Vec3d{0, 0, 0} || b == Vec3d{0, 0, 0}) return -1;
  return std::min(1.0, std::abs(dot(a, b)));
}

/// Sums in the order of the samples, so that threads do not show.
Direction conclude(std::vector<Found>& found, double threshold) {
  Direction result;
  double squares = 0, cosines = 0, with_normal = 0;
  for (const Found& one : found) {
    result.distances.mean += one.distance;
    squares += one.distance * one.distance;
    result.distances.max = std::max(result.distances.max, one.distance);
    result.share_near += one.distance <= threshold ? 1 : 0;
    cosines += std::max(one.cosine, 0.0);
    with_normal += one.cosine >= 0 ? 1 : 0;
  }
  const auto n = static_cast<double>(found.size());
  result.distances.mean /= n;
  result.distances.rms = std::sqrt(squares / n);
  result.share_near /= n;
  result.normal_consistency = with_normal > 0 ? cosines / with_normal : 0;
  // The smallest distance that at least 95 % of the samples do not exceed.
  const auto p95 = found.begin() + static_cast<std::ptrdiff_t>(found.size() - found.size() / 20 - 1);
  std::nth_element(found.begin(), p95, found.end(),
                   [](const Found& a, const Found& b) { return a.distance < b.distance; });
  result.distances.p95 = p95->distance;
  return result;
}

/// Calls measure(i, hint) for every sample; `hint` is passed from one sample to the next of its block.
Direction measure_all(exec::Cpu& ex, std::int64_t samples, double threshold,
                      const std::function<Found(std::int64_t, std::int32_t&)>& measure) {
  std::vector<Found> found(static_cast<std::size_t>(samples));
  ex.run_blocks(exec::block_count(samples, kBlock), [&](std::int64_t block) {
    std::int32_t hint = -1;
    for (std::int64_t i = block * kBlock; i < std::min(samples, (block + 1) * kBlock); ++i)
      found[static_cast<std::size_t>(i)] = measure(i, hint);
  });
  return conclude(found, threshold);
}

Direction mesh_to_shape(exec::Cpu& ex, const Mesh& mesh, const Shape& shape, const CompareOptions& options,
                        double threshold) {
  const mesh_detail::SurfaceSampler sampler(ex, mesh, mesh.origin);
  const ClosestPoint closest(ex, shape);
  return measure_all(ex, options.samples, threshold, [&](std::int64_t i, std::int32_t& /*hint*/) {
    const mesh_detail::SurfaceSample sample = sampler.sample(i, options.samples);
    const SurfacePoint nearest = closest(sample.point);
    return Found{length(sample.point - nearest.position), cosine_of(sample.normal, nearest.normal)};
  });
}

Direction shape_to_mesh(exec::Cpu& ex, const Cloud& surface, const Mesh& mesh, double threshold) {
  const mesh_detail::TriangleTree tree(ex, mesh, mesh.origin);
  return measure_all(ex, surface.size(), threshold, [&](std::int64_t i, std::int32_t& hint) {
    const auto k = static_cast<std::size_t>(i);
    const mesh_detail::Nearest nearest = tree.nearest(to_double(surface.positions[k]), hint);
    hint = nearest.slot;
    const Vec3d normal = normalized(tree.triangle(nearest.slot).area_vector());
    return Found{std::sqrt(nearest.squared_distance), cosine_of(to_double(surface.normals[k]), normal)};
  });
}

double diagonal_of(const Cloud& cloud) {
  const Bounds box = bounds_of(cloud.positions);
  return length(to_double(box.upper) - to_double(box.lower));
}

Json distances_json(const DistanceStatistics& d, double diagonal, double spacing) {
  const auto scaled = [&](double by) {
    return Json{{"mean", d.mean * by}, {"rms", d.rms * by}, {"p95", d.p95 * by}, {"max", d.max * by}};
  };
  Json json = scaled(1);
  json["percent"] = scaled(100 / diagonal);
  if (spacing > 0) json["spacings"] = scaled(1 / spacing);
  return json;
}

Json topology_json(bool closed, const Topology& topology) {
  Json json{{"closed", closed}, {"components", topology.components}, {"euler", topology.euler}};
  json["genus"] = closed ? Json(topology.genus()) : Json(nullptr);
  return json;
}

}  // namespace

Metrics measure_against(const Mesh& mesh, const std::string& name, const Shape& shape, const CompareOptions& options) {
  if (mesh.triangles.empty()) throw Error(ErrorCode::invalid_input, "the mesh has no triangle");
  if (options.samples <= 0 || !(options.tau > 0)) throw Error(ErrorCode::usage, "samples and tau must be positive");
  Metrics metrics;
  metrics.mesh = measure(mesh, options.threads);  // checks the indices
  metrics.truth = {name, estimate_area(shape, kAreaDraws, 1, options.threads), true, shape.topology()};
  const Cloud surface =
      sample_surface(shape, {.points = options.samples, .seed = 0x5a3b1e5, .threads = options.threads});
  const double diagonal = diagonal_of(surface), threshold = options.tau * diagonal;
  exec::Cpu ex(options.threads);
  const Direction there = mesh_to_shape(ex, mesh, shape, options, threshold);
  metrics.comparison = mesh_detail::both_ways(there, shape_to_mesh(ex, surface, mesh, threshold), diagonal);
  return metrics;
}

Metrics measure_against(const Mesh& mesh, const std::string& name, const Mesh& truth, const CompareOptions& options) {
  Metrics metrics;
  metrics.mesh = measure(mesh, options.threads);
  const MeshReport report = measure(truth, options.threads);
  metrics.truth = {name, report.area, report.closed() && report.manifold(), {report.components, report.euler}};
  metrics.comparison = compare(mesh, truth, options);
  return metrics;
}

Json to_json(const Metrics& metrics, const CompareOptions& options, std::int64_t points) {
  const MeshComparison& c = metrics.comparison;
  const double spacing = points > 0 ? std::sqrt(metrics.truth.area / static_cast<double>(points)) : 0;
  const MeshReport& mesh = metrics.mesh;
  Json result = topology_json(mesh.closed(), {mesh.components, mesh.euler});
  result.update({{"watertight", mesh.watertight()},
                 {"vertices", mesh.used_vertices},
                 {"triangles", mesh.triangles},
                 {"area", mesh.area},
                 {"volume", mesh.volume}});
  Json truth = topology_json(metrics.truth.closed, metrics.truth.topology);
  truth.update({{"name", metrics.truth.name}, {"diagonal", c.reference_diagonal}, {"area", metrics.truth.area}});
  return {{"version", 1},
          {"samples", options.samples},
          {"tau", options.tau},
          {"spacing", spacing > 0 ? Json(spacing) : Json(nullptr)},
          {"result", std::move(result)},
          {"truth", std::move(truth)},
          {"to_truth", distances_json(c.to_reference, c.reference_diagonal, spacing)},
          {"from_truth", distances_json(c.from_reference, c.reference_diagonal, spacing)},
          {"two_sided", distances_json(c.two_sided, c.reference_diagonal, spacing)},
          {"normal_consistency", c.normal_consistency},
          {"precision", c.precision},
          {"recall", c.recall},
          {"f_score", c.f_score}};
}

}  // namespace pointskin::bench
