#include "problems/views.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "core/vec3.hpp"
#include "mesh/mesh_checks.hpp"
#include "render/view_axes.hpp"

namespace pointskin::problems {
namespace {

using namespace mesh_detail;

constexpr double kDegree = std::numbers::pi / 180;
constexpr double kHalfFieldOfView = 14 * kDegree;  // as render's; of the pictures and of the view matrices
constexpr std::size_t kDirections = 192, kSamples = 64, kViews = 3;
/// Views are so far apart, and see so much of the region.
constexpr double kLeastAngle = 40 * kDegree, kLeastVisible = 0.05;
/// The direction of the normal is taken even if another one sees a little more.
constexpr double kNearlyBest = 0.85;

/// Directions spread evenly over the sphere (a Fibonacci spiral).
std::array<Vec3d, kDirections> directions() {
  std::array<Vec3d, kDirections> all{};
  const double turn = std::numbers::pi * (3 - std::sqrt(5.0));
  for (std::size_t i = 0; i < kDirections; ++i) {
    const double z = 1 - (2 * static_cast<double>(i) + 1) / static_cast<double>(kDirections);
    const double flat = std::sqrt(1 - z * z);
    all[i] = {flat * std::cos(turn * static_cast<double>(i)), flat * std::sin(turn * static_cast<double>(i)), z};
  }
  return all;
}

/// World to camera, for a viewer who sees the sphere of this radius about the target.
std::array<double, 16> matrix_of(const render_detail::ViewAxes& axes, const Vec3d& target, double radius) {
  std::array<double, 16> matrix{};
  const Vec3d rows[3] = {axes.right, axes.up, axes.back};
  const double distance = radius / std::sin(kHalfFieldOfView);
  for (std::size_t r = 0; r < 3; ++r) {
    for (std::size_t c = 0; c < 3; ++c) matrix[4 * r + c] = rows[r][c];
    matrix[4 * r + 3] = -dot(rows[r], target) - (r == 2 ? distance : 0);
  }
  matrix[15] = 1;
  return matrix;
}

/// So that the region is half as wide as the picture's shorter side, in surroundings of a twelfth of the mesh at least.
double zoom_of(double region_radius, double mesh_radius) {
  const double shown = std::max(region_radius / 0.5, mesh_radius / 12);
  // Half the shorter side, of which the mesh's sphere fills a part at zoom 1, at the distance of the sphere's middle.
  const double at_one = mesh_radius / (kRenderFill * std::cos(kHalfFieldOfView));
  return std::clamp(at_one / shown, 1.0, 1000.0);
}

/// Largest distance of a finite corner of a triangle.
double radius_about(const Mesh& mesh, const Vec3d& centre) {
  double squared = 0;
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t id : t) {
      const double d = squared_length(to_double(mesh.vertices[static_cast<std::size_t>(id)]) - centre);
      if (std::isfinite(d)) squared = std::max(squared, d);
    }
  return std::sqrt(squared);
}

/// Part of a region that a line of sight stands for.
struct Sample {
  Vec3d at{}, normal{};
  double weight = 0;
};

/// About kSamples, each for the same share of the score.
std::vector<Sample> samples_of(const Place& place) {
  double total = 0;
  for (const Patch& patch : place.patches) total += patch.score;
  std::vector<Sample> samples;
  double sum = 0;
  for (const Patch& patch : place.patches) {
    const double before = std::floor(sum / total * kSamples + 0.5);
    sum += patch.score;
    const double weight = std::floor(sum / total * kSamples + 0.5) - before;
    if (!(weight > 0)) continue;
    // A little above the surface, which is not to be in its own way.
    const Vec3d normal = normalized(patch.area_vector);
    const double lift = 0.25 * std::sqrt(length(patch.area_vector));
    samples.push_back({patch.centre + lift * normal, normal, weight});
  }
  return samples;
}

/// How a place looks from a direction.
struct Sight {
  Vec3d back{};        ///< unit vector to the viewer
  double score = 0;    ///< what is seen of the samples, foreshortened
  double visible = 0;  ///< share of the samples that is seen
};

Sight sight_from(const Vec3d& back, const Vec3d& viewer, const std::vector<Sample>& samples, const TriangleTree* tree) {
  Sight sight{back, 0, 0};
  double total = 0;
  for (const Sample& sample : samples) {
    total += sample.weight;
    const double facing = dot(sample.normal, normalized(viewer - sample.at));
    if (facing <= 0 || (tree != nullptr && tree->is_between(sample.at, viewer))) continue;
    sight.score += sample.weight * facing;
    sight.visible += sample.weight;
  }
  if (total > 0) sight.visible /= total;
  return sight;
}

/// The first of `sights` if it is nearly as good as the best, then the best that differ from those before.
std::vector<Sight> chosen(const std::vector<Sight>& sights) {
  const auto by_score = [](const Sight& a, const Sight& b) { return a.score < b.score; };
  const Sight& best = *std::max_element(sights.begin(), sights.end(), by_score);
  std::vector<Sight> chosen{sights.front().score >= kNearlyBest * best.score ? sights.front() : best};
  while (chosen.size() < kViews) {
    const Sight* next = nullptr;
    for (const Sight& sight : sights) {
      const bool differs = std::all_of(chosen.begin(), chosen.end(), [&](const Sight& other) {
        return dot(sight.back, other.back) <= std::cos(kLeastAngle);
      });
      if (differs && sight.visible >= kLeastVisible && (next == nullptr || sight.score > next->score)) next = &sight;
    }
    if (next == nullptr) break;
    chosen.push_back(*next);
  }
  return chosen;
}

}  // namespace

ViewFinder::ViewFinder(exec::Cpu& ex, const Mesh& mesh, UpAxis up) : mesh_(mesh), up_(up) {
  const bool usable = !mesh.triangles.empty() && corner_bounds(ex, mesh).finite;
  if (usable) tree_.emplace(ex, mesh, Vec3d{0, 0, 0});
}

std::vector<ProblemView> ViewFinder::views_of(exec::Cpu& ex, const Place& place) const {
  const double mesh_radius = radius_about(mesh_, place.centre);
  const double distance = mesh_radius / std::sin(kHalfFieldOfView);
  const std::vector<Sample> samples = samples_of(place);
  const std::array<Vec3d, kDirections> around = directions();
  std::vector<Sight> sights(kDirections + 1);
  ex.run_blocks(static_cast<std::int64_t>(sights.size()), [&](std::int64_t i) {
    const Vec3d back = i == 0 ? place.towards : around[static_cast<std::size_t>(i) - 1];
    const Vec3d viewer = place.centre + distance * back;
    sights[static_cast<std::size_t>(i)] = sight_from(back, viewer, samples, tree_ ? &*tree_ : nullptr);
  });
  std::vector<ProblemView> views;
  for (const Sight& sight : chosen(sights)) {
    const render_detail::ViewAngles angles = render_detail::view_angles(up_, sight.back);
    ProblemView view{angles.azimuth / kDegree,           angles.elevation / kDegree,
                     mesh_.origin + place.centre,        {},
                     zoom_of(place.radius, mesh_radius), sight.visible};
    view.matrix =
        matrix_of(render_detail::view_axes(up_, angles.azimuth, angles.elevation), view.target_world, place.radius);
    views.push_back(view);
  }
  return views;
}

}  // namespace pointskin::problems
