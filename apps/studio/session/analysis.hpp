// What is measured on a mesh for the panels of the studio, as JSON.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <vector>

#include <nlohmann/json.hpp>

#include <pointskin/cloud.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/problems.hpp>
#include <pointskin/reconstruct.hpp>

namespace pointskin::studio {

/// Regions with their views, the worst first, as `pointskin problems --report` lists them.
nlohmann::ordered_json problems_json(const std::vector<ProblemRegion>& regions);

/// The table of a comparison, with the names of `pointskin compare --json`.
nlohmann::ordered_json comparison_json(const MeshComparison& comparison);

/// Shares of the surface's area by the density of the samples there, and what a trim would cut.
///
/// {"densities": {"edges": [bins + 1], "counts": [bins], "log": true}, "quantiles": [[q, density], ...]}: edges are
/// equally far apart in the logarithm; below the density of an entry the surface is cut with that trim (to within 20 %:
/// the trim itself measures distances between samples in the octree).
/// @param mesh  not trimmed, with the attribute "density"
/// @param cloud  that it was made of
/// @throws Error usage if it has none
/// O(v log v + t).
nlohmann::ordered_json density_histogram(const Mesh& mesh, const Cloud& cloud, int bins = 64);

/// A place of a mesh.
struct Place {
  Vec3d point{}, normal{};  ///< world coordinates; normal of the triangle, unit length
  double distance = 0;      ///< from the origin of the ray, in lengths of its direction
};

/// The first triangle that a ray meets, from either side. World coordinates. O(t).
std::optional<Place> first_hit(const Mesh& mesh, const Vec3d& origin, const Vec3d& direction);

/// How long a run takes, from what runs took: milliseconds are linear in the bytes that the run is estimated to need.
class TimeModel {
 public:
  /// @param bytes  estimate_device_bytes of the run
  void learn(std::int64_t bytes, double ms);
  /// @returns nothing before a run was learned
  [[nodiscard]] std::optional<double> ms_for(std::int64_t bytes) const;

 private:
  double count_ = 0, bytes_ = 0, ms_ = 0, bytes_squared_ = 0, bytes_ms_ = 0;
};

/// What the depths from 3 below that of `options` to the next one would take: {"bytes", "ms", "depths": [{"depth",
/// "bytes", "ms"}, ...]}, ms null where nothing is known, bytes null where the octree would not fit its ids. Five
/// estimates of memory long; deeper ones would take longer than all of these.
/// @param should_stop  asked before each depth
/// @throws Error interrupted if should_stop says so
nlohmann::ordered_json estimate_json(const Cloud& cloud, const Options& options, const TimeModel& model, int threads,
                                     const std::function<bool()>& should_stop);

}  // namespace pointskin::studio
