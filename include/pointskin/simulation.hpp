// Position-based fluids on the CPU or on a GPU: a scene, moved on frame by frame, and the surface of its water.
// Source: Macklin & Mueller, "Position based fluids", ACM Transactions on Graphics 32(4), 2013; docs/decisions/0025
// says what differs. Metres and seconds, y upwards, the tank's lower corner at the origin.
#pragma once

#include <cstdint>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/device_data.hpp>
#include <pointskin/export.hpp>
#include <pointskin/fluid.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/vector.hpp>
#include <pointskin/workspace.hpp>

namespace pointskin {
namespace simulation PSK_EXPORT {

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

struct SimulationOptions {
  int iterations = 4;       ///< of the density constraint, a substep; in [1, 100]
  double relaxation = 0.5;  ///< epsilon of the constraint, in units of kernel radii, >= 0; more is softer
  double warm_start = 0.5;  ///< part of the last substep's pressure that the next begins with, in [0, 1]; 0: none
  /// Part of the mean pressure of the last quarter of a second that is added to it, in [0, 1]. With 1 - warm_start the
  /// weight of water at rest is carried without compressing it.
  double standing_pressure = 0.5;
  double artificial_pressure = 2e-4;  ///< keeps particles apart where they are few, >= 0
  double viscosity = 0.02;            ///< c of XSPH, in [0, 1]
  double vorticity = 0;               ///< of vorticity confinement, >= 0; 0: none, and then it costs nothing
  double gravity = 9.81;              ///< downwards, metres / second^2, >= 0
  /// A frame is cut into as few equal substeps as keep the fastest particle's way below this many kernel radii.
  double courant = 1;       ///< in [0.05, 1]
  int fewest_substeps = 2;  ///< in [1, most_substeps]
  int most_substeps = 64;   ///< at most 1000; what would still be faster than one radius a substep is slowed down
};

/// @throws Error usage, naming the option, if one is out of its range
void validate(const SimulationOptions& options);

/// What the last frame did. A particle's mass is 1000 kg / m^3 times spacing^3.
struct SimulationReport {
  std::int64_t frame = 0;  ///< frames since the start
  double seconds = 0;      ///< since the start, of the simulated time
  std::int64_t particles = 0;
  std::int64_t lost = 0;          ///< outside of the tank or not finite; 0, or something is wrong
  std::int64_t crowded = 0;       ///< particles with more neighbours than are looked at
  double mean_density_error = 0;  ///< mean of max(0, density / density at rest - 1); the lattice's is 1 / 0.9945
  double max_density_error = 0;   ///< the largest
  double kinetic_energy = 0;      ///< joules
  double potential_energy = 0;    ///< joules, above the floor
  double max_speed = 0;           ///< metres / second
  int substeps = 0;
  double ms = 0;  ///< wall clock of step(), results on the device included
};

/// Particles on the host, in the scene's order.
struct ParticleStates {
  std::vector<Vec3f> positions;   ///< shape (n), metres
  std::vector<Vec3f> velocities;  ///< shape (n), metres / second
};

/// A scene on its device. The same steps give the same bytes, on CPU and GPU and for any number of threads. Not safe
/// for two threads at once.
class Simulation {
 public:
  /// @throws Error usage as validate(), device_unavailable, over_limit
  explicit Simulation(Scene scene, const SimulationOptions& options = {}, Workspace workspace = {});
  ~Simulation();
  Simulation(Simulation&&) noexcept;
  Simulation& operator=(Simulation&&) noexcept;

  /// Moves on by `seconds` under the scene's forces and `interactions`, which hold for the whole frame.
  ///
  /// Cuts the frame into k = ceil(seconds (v + g seconds) / (courant radius)) substeps, v the speed of the fastest
  /// particle or of the obstacle, k within the limits of the options. A substep on a GPU takes 26 launches and one host
  /// round trip with 4 iterations, a frame two round trips more. O(k n iterations); about 390 bytes a particle, 520 up
  /// to 2^18.
  /// @param seconds  in (0, 1]
  /// @throws Error usage if `seconds` or an interaction is out of its range, or there are more than 7 interactions
  void step(double seconds, const std::vector<Interaction>& interactions = {});

  /// Takes the obstacle from its own way: with the next step it goes to `centre` in a straight line, or towards it at
  /// 5 metres / second where that is too far for one frame, and stays there. The ball never leaves the tank.
  /// @param centre  metres
  /// @throws Error usage if it is not finite, or the scene has no obstacle
  void move_obstacle(const Vec3f& centre);
  /// Where the obstacle is now; of radius 0 in a scene without one.
  [[nodiscard]] Obstacle obstacle() const;

  /// Back to the scene's first frame, the obstacle on its own way. Every byte is as if it were new.
  void restart();

  /// Copies the particles to the host.
  [[nodiscard]] ParticleStates particles() const;

  /// The surface of the water as FluidSurfacer makes it, of the particles where they are on the device; with
  /// `options.attributes` vertices have the velocity as velocity_x, velocity_y and velocity_z. A particle_radius of 0
  /// means particle_radius(), a surface_threshold of 0 with the isotropic kernel 1.04. Where the water touches the tank
  /// the surface lies on the tank's walls. Without sharp free edges it encloses the volume of the particles, spacing^3
  /// each, to within 1 %. The same bytes whenever the steps were the same.
  /// @throws Error as FluidSurfacer::surface
  void surface(const FluidOptions& options, Mesh& mesh);
  /// The same, left on the device.
  [[nodiscard]] DeviceMesh surface_on_device(const FluidOptions& options);
  [[nodiscard]] const FluidReport& surface_report() const;

  [[nodiscard]] const Scene& scene() const;
  [[nodiscard]] const SimulationOptions& options() const;
  [[nodiscard]] const SimulationReport& report() const;
  [[nodiscard]] const Workspace& workspace() const;
  [[nodiscard]] const Device& device() const;
  /// Half of the spacing at rest, metres: what surfaces take as the particles' radius.
  [[nodiscard]] double particle_radius() const;
  /// Highest sum of all arrays on the device so far.
  [[nodiscard]] std::int64_t peak_bytes() const;

 private:
  class Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace simulation
}  // namespace pointskin
