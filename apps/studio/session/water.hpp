// Live water: a scene of the simulation that is moved on frame by frame, pushed and stirred.
#pragma once

#include <cstdint>
#include <memory>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <pointskin/mesh.hpp>
#include <pointskin/simulation.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin::studio {

/// A place or a direction of a page, as the simulation has them.
Vec3f to_floats(const Vec3d& v);

/// Works where its workspace does; all calls from one thread.
class Water {
 public:
  static constexpr double kSecondsPerFrame = 1.0 / 60;

  /// @param scene  "dam-break" and so on
  /// @throws Error usage for a scene or a number of particles that there is not, over_limit
  Water(const std::string& scene, std::int64_t particles, Workspace workspace);

  /// Forces that hold from the next frame on, instead of those before. @throws Error usage for more than 6
  void set_forces(std::vector<simulation::Interaction> forces);
  /// @throws Error usage if the scene has no obstacle
  void move_obstacle(const Vec3f& centre) { simulation_.move_obstacle(centre); }
  void restart();

  /// Moves on by a frame and makes its surface. The mesh is valid until the next call.
  const Mesh& next_frame();

  /// Facts of the last frame for a page: index, seconds, particles, speed, obstacle, milliseconds.
  [[nodiscard]] nlohmann::ordered_json facts() const;

 private:
  simulation::Simulation simulation_;
  std::string scene_;
  std::vector<simulation::Interaction> forces_;
  Mesh mesh_;
  double surface_ms_ = 0;
};

/// {"kind": "push"|"swirl", "centre": [3], "direction": [3], "radius": r, "strength": s}: a force as a page sends it.
/// @throws Error usage
simulation::Interaction force_of(const nlohmann::json& json);

}  // namespace pointskin::studio
