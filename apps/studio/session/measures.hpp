// The panels' questions about the surface: problems, comparison, values to colour by, densities, costs.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <variant>
#include <vector>

#include "analysis.hpp"
#include "mesh_teller.hpp"
#include "scene_desk.hpp"

namespace pointskin::studio {

/// Of the surface that pages are shown: of a very large one, of a coarser one. The comparison's table is of the whole.
/// Functions may throw Error. What takes a reconstruction is kept until the scene changes. Of the engine's thread.
class Measures {
 public:
  Measures(Services& services, SceneDesk& desk, MeshTeller& teller)
      : services_(services), desk_(desk), teller_(teller), sources_(services.device.threads) {}

  Json problems();
  /// Shows the distance of every vertex from the reference. @param name  of it, for the table
  Json compare(const scene::SolidSource& reference, const std::string& name);
  /// Shows the mesh with a number a vertex: density, weakness, distance (to the points), or a number of the points.
  Json values(const std::string& name);
  Json histogram();
  Json estimate(const nlohmann::json& patch);
  Json pick(const Vec3d& origin, const Vec3d& direction) const;

 private:
  /// The scene's surface as it is shown, with what `options` add to its vertices.
  Mesh reconstructed(Options options) const;
  /// With density and weakness, made once a state.
  const Mesh& annotated();
  void show(const Mesh& mesh, wire::Values values);

  Services& services_;
  SceneDesk& desk_;
  MeshTeller& teller_;
  TimeModel times_;
  std::optional<std::uint64_t> learned_state_, annotated_state_;
  Mesh annotated_;
  scene::Sources sources_;
};

}  // namespace pointskin::studio
