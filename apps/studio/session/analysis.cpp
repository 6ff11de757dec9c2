#include "analysis.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <numeric>
#include <string>
#include <utility>

#include "scene/vector_json.hpp"
#include "trim_thresholds.hpp"

namespace pointskin::studio {
namespace {

using Json = nlohmann::ordered_json;

Json distances_json(const DistanceStatistics& d, double diagonal) {
  const double to_percent = 100 / diagonal;
  return {{"mean", d.mean},
          {"rms", d.rms},
          {"p95", d.p95},
          {"max", d.max},
          {"mean_percent", d.mean * to_percent},
          {"rms_percent", d.rms * to_percent},
          {"p95_percent", d.p95 * to_percent},
          {"max_percent", d.max * to_percent}};
}

Json view_json(const ProblemView& view) {
  return {{"azimuth", view.azimuth_degrees},
          {"elevation", view.elevation_degrees},
          {"target", view.target_world},
          {"matrix", view.matrix},
          {"zoom", view.zoom},
          {"visible", view.visible}};
}

const std::vector<float>& floats_of(const Mesh& mesh, const std::string& name) {
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.name == name && attribute.type() == AttributeType::float32) return attribute.values.as<float>();
  throw Error(ErrorCode::usage, "the mesh has no attribute '" + name + "'");
}

Vec3d corner(const Mesh& mesh, const Triangle& triangle, int i) {
  const Vec3f& v = mesh.vertices[static_cast<std::size_t>(triangle[static_cast<std::size_t>(i)])];
  return {double{v.x}, double{v.y}, double{v.z}};
}

/// A third of the area of all triangles around each vertex.
std::vector<double> areas_of_vertices(const Mesh& mesh) {
  std::vector<double> areas(mesh.vertices.size());
  for (const Triangle& triangle : mesh.triangles) {
    const Vec3d a = corner(mesh, triangle, 0);
    const Vec3d n = cross(corner(mesh, triangle, 1) - a, corner(mesh, triangle, 2) - a);
    const double third = std::sqrt(dot(n, n)) / 6;
    for (const auto id : triangle) areas[static_cast<std::size_t>(id)] += third;
  }
  return areas;
}

/// [[q, density], ...] for trims from 0 to 0.5, closer together where they are small.
Json trim_thresholds(const std::vector<float>& at_samples) {
  constexpr int kSteps = 64;
  constexpr double kMostTrim = 0.5;
  Json table = Json::array();
  for (int step = 0; step <= kSteps && !at_samples.empty(); ++step) {
    const double q = kMostTrim * std::pow(double{1} * step / kSteps, 2);
    table.push_back({q, step == 0 ? 0 : trim_threshold(at_samples, q)});
  }
  return table;
}

}  // namespace

Json problems_json(const std::vector<ProblemRegion>& regions) {
  Json list = Json::array();
  for (const ProblemRegion& region : regions) {
    Json views = Json::array();
    for (const ProblemView& view : region.views) views.push_back(view_json(view));
    list.push_back({{"score", region.score},
                    {"peak", region.peak},
                    {"area", region.area},
                    {"triangles", region.triangles},
                    {"centroid", region.centroid_world},
                    {"lower", region.lower_world},
                    {"upper", region.upper_world},
                    {"mean_normal", region.mean_normal},
                    {"views", std::move(views)}});
  }
  return list;
}

Json comparison_json(const MeshComparison& c) {
  Json json = {{"samples", c.samples},
               {"reference_samples", c.reference_samples},
               {"reference_diagonal", c.reference_diagonal},
               {"to_reference", distances_json(c.to_reference, c.reference_diagonal)},
               {"from_reference", distances_json(c.from_reference, c.reference_diagonal)},
               {"two_sided", distances_json(c.two_sided, c.reference_diagonal)}};
  json["normal_consistency"] = c.has_normals ? Json(c.normal_consistency) : Json(nullptr);
  json.update({{"precision", c.precision}, {"recall", c.recall}, {"f_score", c.f_score}});
  return json;
}

Json density_histogram(const Mesh& mesh, const Cloud& cloud, int bins) {
  const std::vector<float>& density = floats_of(mesh, "density");
  const std::vector<double> area = areas_of_vertices(mesh);
  double low = INFINITY;
  double high = 0;
  for (const float d : density) {
    if (d > 0) low = std::min(low, double{d});
    high = std::max(high, double{d});
  }
  if (!(low <= high)) throw Error(ErrorCode::empty_result, "the surface has no density above 0");
  if (low == high) high = low * 1.001;
  const double from = std::log(low);
  const double step = (std::log(high) - from) / bins;
  std::vector<double> shares(static_cast<std::size_t>(bins));
  const double all = std::accumulate(area.begin(), area.end(), 0.0);
  for (std::size_t i = 0; i < density.size(); ++i) {
    const double place = density[i] > 0 ? (std::log(double{density[i]}) - from) / step : 0;
    shares[static_cast<std::size_t>(std::clamp(place, 0.0, bins - 1.0))] += area[i] / all;
  }
  Json edges = Json::array();
  for (int i = 0; i <= bins; ++i) edges.push_back(std::exp(from + i * step));
  return {{"densities", {{"edges", edges}, {"counts", shares}, {"log", true}}},
          {"quantiles", trim_thresholds(densities_at_samples(mesh, density, cloud))}};
}

std::optional<Place> first_hit(const Mesh& mesh, const Vec3d& origin, const Vec3d& direction) {
  // Moeller & Trumbore, "Fast, minimum storage ray-triangle intersection", 1997.
  std::optional<Place> best;
  const Vec3d from = origin - mesh.origin;
  for (const Triangle& triangle : mesh.triangles) {
    const Vec3d a = corner(mesh, triangle, 0);
    const Vec3d e1 = corner(mesh, triangle, 1) - a;
    const Vec3d e2 = corner(mesh, triangle, 2) - a;
    const Vec3d p = cross(direction, e2);
    const double det = dot(e1, p);
    if (det == 0) continue;
    const Vec3d s = from - a;
    const double u = dot(s, p) / det;
    const Vec3d q = cross(s, e1);
    const double v = dot(direction, q) / det;
    const double t = dot(e2, q) / det;
    if (u < 0 || v < 0 || u + v > 1 || !(t > 0) || (best && t >= best->distance)) continue;
    const Vec3d n = cross(e1, e2);
    best = {origin + t * direction, 1 / std::sqrt(dot(n, n)) * n, t};
  }
  return best;
}

void TimeModel::learn(std::int64_t bytes, double ms) {
  const double b = static_cast<double>(bytes);
  count_ += 1;
  bytes_ += b;
  ms_ += ms;
  bytes_squared_ += b * b;
  bytes_ms_ += b * ms;
}

std::optional<double> TimeModel::ms_for(std::int64_t bytes) const {
  if (count_ == 0) return std::nullopt;
  const double b = static_cast<double>(bytes);
  const double spread = count_ * bytes_squared_ - bytes_ * bytes_;
  // Runs of one size say nothing of a fixed cost.
  if (!(spread > 1e-6 * bytes_ * bytes_)) return ms_ / bytes_ * b;
  const double slope = (count_ * bytes_ms_ - bytes_ * ms_) / spread;
  const double fixed = (ms_ - slope * bytes_) / count_;
  if (slope < 0 || fixed < 0) return ms_ / bytes_ * b;
  return fixed + slope * b;
}

Json estimate_json(const Cloud& cloud, const Options& options, const TimeModel& model, int threads,
                   const std::function<bool()>& should_stop) {
  constexpr int kBelow = 3;
  constexpr int kDeepest = 20;
  Json depths = Json::array();
  Json present = {{"bytes", nullptr}, {"ms", nullptr}};
  for (int depth = std::max(1, options.depth - kBelow); depth <= std::min(kDeepest, options.depth + 1); ++depth) {
    if (should_stop()) throw Error(ErrorCode::interrupted, "the estimate was interrupted");
    Options tried = options;
    tried.depth = depth;
    Json bytes;
    Json ms;
    try {
      const std::int64_t needed = estimate_device_bytes(cloud, tried, threads);
      bytes = needed;
      if (const auto expected = model.ms_for(needed)) ms = *expected;
    } catch (const Error& error) {
      if (error.code() != ErrorCode::over_limit) throw;
    }
    if (depth == options.depth) present = {{"bytes", bytes}, {"ms", ms}};
    depths.push_back({{"depth", depth}, {"bytes", bytes}, {"ms", ms}});
  }
  present["depths"] = std::move(depths);
  return present;
}

}  // namespace pointskin::studio
