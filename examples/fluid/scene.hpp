// Scenes: a tank, the particles in it as a lattice at rest, and what moves them. All on the host, in metres and
// seconds, y upwards, the tank's lower corner at the origin.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/vector.hpp>

namespace pointskin::simulation {

enum class SceneKind {
  dam_break,         ///< a block of water at one end of a tank
  double_dam_break,  ///< two blocks in opposite corners
  drop,              ///< a ball of water falls into a pool
  obstacle,          ///< a ball of stone goes to and fro through a pool
  stir,              ///< a pool is stirred about its vertical axis
};

/// "dam-break" and so on: the names of the command line.
const char* name_of(SceneKind kind);
std::optional<SceneKind> parse_scene(const std::string& name);
/// All kinds, in the order of the enumeration.
std::vector<SceneKind> all_scenes();

/// A force field on the particles within a ball, strongest at its centre: with q = |x - centre| / radius < 1, the
/// acceleration is strength (1 - q^2)^2 times `direction` (push), or times direction x (x - centre) / radius (swirl:
/// about the axis `direction` through the centre).
struct Interaction {
  enum class Kind { push, swirl };
  Kind kind = Kind::push;
  Vec3f centre{};            ///< metres
  Vec3f direction{1, 0, 0};  ///< of any length but zero; only where it points matters
  float radius = 0.25F;      ///< metres, > 0
  float strength = 20;       ///< metres / second^2, any sign
};

/// A moving ball that water flows around.
struct Obstacle {
  Vec3f centre{};    ///< metres
  float radius = 0;  ///< metres; 0: there is none
};

/// A scene before its first step.
struct Scene {
  SceneKind kind = SceneKind::dam_break;
  float spacing = 0;             ///< of the lattice: a particle stands for spacing^3 of water; metres
  Vec3f tank{};                  ///< upper corner; every side is a multiple of the spacing
  std::vector<Vec3f> positions;  ///< shape (n): the particles; layer by layer from below, body by body
  float obstacle_radius = 0;     ///< metres; 0: no obstacle

  /// Where the obstacle is. Piecewise polynomials of time: no libm.
  [[nodiscard]] Obstacle obstacle_at(double seconds) const;
  /// The forces that belong to the scene itself.
  [[nodiscard]] std::vector<Interaction> interactions_at(double seconds) const;
};

/// Makes a scene of exactly `particles` particles: the spacing is chosen so that the water has its nominal volume, the
/// tank is rounded to it, and the highest layer of the pool or of every block holds what is left. O(n).
/// @param particles  in [kFewestParticles, kMostParticles]
/// @throws Error usage if it is not
Scene make_scene(SceneKind kind, std::int64_t particles);

inline constexpr std::int64_t kFewestParticles = 200;
inline constexpr std::int64_t kMostParticles = 64'000'000;

}  // namespace pointskin::simulation
