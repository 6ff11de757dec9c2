#include <pointskin/problems.hpp>

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numeric>
#include <utility>

#include "core/vec3.hpp"
#include "problems/views.hpp"

namespace pointskin {
namespace {

using namespace mesh_detail;

void check(const Mesh& mesh, const ProblemOptions& options) {
  if (!(options.threshold > 0 && options.threshold <= 1))
    throw Error(ErrorCode::usage, "option threshold must be in (0, 1]");
  if (!(options.least_area >= 0 && options.least_area <= 1))
    throw Error(ErrorCode::usage, "option least-area must be in [0, 1]");
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t id : t)
      if (id < 0 || static_cast<std::size_t>(id) >= mesh.vertices.size())
        throw Error(ErrorCode::invalid_input, "a triangle names a vertex that does not exist");
}

std::vector<float> weakness_of(const Mesh& mesh) {
  for (const Attribute& attribute : mesh.attributes)
    if (attribute.name == "weakness" && attribute.values.size() == mesh.vertices.size())
      return attribute.values.converted(AttributeType::float32).as<float>();
  throw Error(ErrorCode::usage, "the mesh has no attribute \"weakness\"; reconstruct it with the option weakness");
}

/// A triangle's part in its region.
struct Piece {
  Vec3d centre{}, area_vector{};
  double area = 0, weakness = 0;
};

Piece piece_of(const Mesh& mesh, const std::vector<float>& weakness, const Triangle& t) {
  Vec3d corner[3];
  Piece piece;
  for (std::size_t k = 0; k < 3; ++k) {
    const auto id = static_cast<std::size_t>(t[k]);
    corner[k] = to_double(mesh.vertices[id]);
    piece.centre += 1.0 / 3 * corner[k];
    piece.weakness += weakness[id] / 3.0;
  }
  piece.area_vector = 0.5 * cross(corner[1] - corner[0], corner[2] - corner[0]);
  piece.area = length(piece.area_vector);
  return piece;
}

/// Sets of vertices that are joined by triangles.
class Sets {
 public:
  explicit Sets(std::size_t n) : parent_(n) { std::iota(parent_.begin(), parent_.end(), std::size_t{0}); }
  std::size_t root(std::size_t i) {
    while (parent_[i] != i) i = parent_[i] = parent_[parent_[i]];
    return i;
  }
  void unite(std::size_t a, std::size_t b) {
    a = root(a);
    b = root(b);
    parent_[std::max(a, b)] = std::min(a, b);
  }

 private:
  std::vector<std::size_t> parent_;
};

/// A region while its triangles are added.
struct Sums {
  ProblemRegion region;
  Vec3d weighted_centre{}, weighted_normal{};
  double score_of_weakest = -1;
  Vec3d weakest_normal{};
  std::vector<std::size_t> triangles;
};

void add(const Piece& piece, Sums& sums) {
  const double score = piece.area * piece.weakness;
  sums.region.score += score;
  sums.region.area += piece.area;
  ++sums.region.triangles;
  sums.weighted_centre += score * piece.centre;
  sums.weighted_normal += piece.weakness * piece.area_vector;
  if (score <= sums.score_of_weakest) return;
  sums.score_of_weakest = score;
  sums.weakest_normal = normalized(piece.area_vector);
}

/// The views are left out.
ProblemRegion finished(const Mesh& mesh, const std::vector<float>& weakness, const Sums& sums) {
  ProblemRegion region = sums.region;
  const Vec3d centre = 1 / region.score * sums.weighted_centre;
  region.centroid_world = mesh.origin + centre;
  region.mean_normal = 1 / region.score * sums.weighted_normal;
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  Vec3d lower{kInfinity, kInfinity, kInfinity}, upper{-kInfinity, -kInfinity, -kInfinity};
  for (const std::size_t t : sums.triangles)
    for (const std::int32_t id : mesh.triangles[t]) {
      const Vec3d p = to_double(mesh.vertices[static_cast<std::size_t>(id)]);
      for (std::size_t a = 0; a < 3; ++a) {
        lower[a] = std::min(lower[a], p[a]);
        upper[a] = std::max(upper[a], p[a]);
      }
      region.peak = std::max(region.peak, double{weakness[static_cast<std::size_t>(id)]});
    }
  region.lower_world = mesh.origin + lower;
  region.upper_world = mesh.origin + upper;
  return region;
}

/// The place of a region, for its views.
problems::Place place_of(const Mesh& mesh, const std::vector<float>& weakness, const Sums& sums,
                         const ProblemRegion& region) {
  constexpr double kLeastMean = 0.2;  // a shorter mean normal says nothing: sides face away from each other
  problems::Place place;
  place.centre = region.centroid_world - mesh.origin;
  place.towards = length(region.mean_normal) > kLeastMean ? normalized(region.mean_normal) : sums.weakest_normal;
  for (const std::size_t t : sums.triangles) {
    const Piece piece = piece_of(mesh, weakness, mesh.triangles[t]);
    place.patches.push_back({piece.centre, piece.area_vector, piece.area * piece.weakness});
    for (const std::int32_t id : mesh.triangles[t])
      place.radius =
          std::max(place.radius, length(to_double(mesh.vertices[static_cast<std::size_t>(id)]) - place.centre));
  }
  return place;
}

}  // namespace

std::vector<ProblemRegion> find_problems(const Mesh& mesh, const ProblemOptions& options) {
  check(mesh, options);
  const std::vector<float> weakness = weakness_of(mesh);
  Sets sets(mesh.vertices.size());
  std::vector<std::size_t> weak;
  double mesh_area = 0;
  for (std::size_t t = 0; t < mesh.triangles.size(); ++t) {
    const Piece piece = piece_of(mesh, weakness, mesh.triangles[t]);
    mesh_area += piece.area;
    if (!(piece.weakness >= options.threshold) || !(piece.area > 0)) continue;
    weak.push_back(t);
    for (const std::int32_t id : mesh.triangles[t])
      sets.unite(static_cast<std::size_t>(mesh.triangles[t][0]), static_cast<std::size_t>(id));
  }

  std::vector<std::ptrdiff_t> region_of(mesh.vertices.size(), -1);
  std::vector<Sums> all;
  for (const std::size_t t : weak) {
    std::ptrdiff_t& region = region_of[sets.root(static_cast<std::size_t>(mesh.triangles[t][0]))];
    if (region < 0) {
      region = static_cast<std::ptrdiff_t>(all.size());
      all.emplace_back();
    }
    Sums& sums = all[static_cast<std::size_t>(region)];
    add(piece_of(mesh, weakness, mesh.triangles[t]), sums);
    sums.triangles.push_back(t);
  }
  std::erase_if(all, [&](const Sums& sums) { return sums.region.area < options.least_area * mesh_area; });
  std::vector<ProblemRegion> regions;
  if (all.empty()) return regions;
  exec::Cpu ex(options.threads);
  const problems::ViewFinder finder(ex, mesh, options.up);
  for (const Sums& sums : all) {
    regions.push_back(finished(mesh, weakness, sums));
    regions.back().views = finder.views_of(ex, place_of(mesh, weakness, sums, regions.back()));
  }
  std::stable_sort(regions.begin(), regions.end(),
                   [](const ProblemRegion& a, const ProblemRegion& b) { return a.score > b.score; });
  return regions;
}

}  // namespace pointskin
