// How far a mesh is from the truth, which is a mesh or a shape with a known surface.
#pragma once

#include <pointskin/mesh.hpp>

#include <cstdint>
#include <string>

#include <nlohmann/json.hpp>

#include "shapes.hpp"

namespace pointskin::bench {

/// The truth's own measures.
struct Truth {
  std::string name;
  double area = 0;     ///< world units^2; of shapes without a formula, good to about 0.2 %
  bool closed = true;  ///< else the topology means nothing
  Topology topology{};
};

struct Metrics {
  MeshComparison comparison;  ///< distances in world units, see pointskin::compare
  MeshReport mesh;
  Truth truth;
};

/// Measures `mesh` against the surface of `shape`: samples of the mesh to their nearest points of the surface, samples
/// of the surface to their nearest triangles. The scores mean what they mean in pointskin::compare; the diagonal is
/// that of the box of the samples. O((samples + t) log t). Deterministic for any number of threads.
/// @throws Error as pointskin::compare
Metrics measure_against(const Mesh& mesh, const std::string& name, const Shape& shape, const CompareOptions& options);

/// The same with a mesh as the truth.
Metrics measure_against(const Mesh& mesh, const std::string& name, const Mesh& truth, const CompareOptions& options);

/// All of it as JSON: distances in world units, in % of the diagonal and, where `points` > 0, in mean spacings of so
/// many samples: sqrt(area of the truth / points).
nlohmann::ordered_json to_json(const Metrics& metrics, const CompareOptions& options, std::int64_t points);

}  // namespace pointskin::bench
