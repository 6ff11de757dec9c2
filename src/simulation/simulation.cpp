#include <pointskin/simulation.hpp>

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "core/stopwatch.hpp"
#include "exec/any_space.hpp"
#include "fluid/frames.hpp"
#include "reconstruct/engine.hpp"
#include "simulation/fluid_state.hpp"

namespace pointskin::simulation {
namespace {

constexpr double kWaterDensity = 1000;  // kg / m^3
/// Particles keep half their distance at rest from solids, times this.
constexpr float kGapShare = 0.5F;
/// What pressure is averaged over: long beside a wave that passes a particle, short beside the sloshing of a tank.
constexpr double kStandingSeconds = 0.25;
/// What the free surface is averaged over.
constexpr double kSurfaceSeconds = 0.1;
constexpr double kObstacleSpeed = 5;  // metres / second, where somebody moves it: as the hand does
/// Of the surface, in particle radii. At the height where the lattice ends (half a spacing above its highest layer) the
/// distance to the mean is 1.09, where water without any order ends 0.98; water at rest lies between.
constexpr double kSurfaceThreshold = 1.04;

[[noreturn]] void refuse(const std::string& story) { throw Error(ErrorCode::usage, story); }

void check_range(const char* option, double value, double low, double high) {
  if (!(value >= low && value <= high))
    refuse(std::string(option) + ": " + std::to_string(value) + " is not in [" + std::to_string(low) + ", " +
           std::to_string(high) + "]");
}

bool is_finite(const Vec3f& v) { return std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z); }

double length_of(const Vec3f& v) {
  const double x = v.x;
  const double y = v.y;
  const double z = v.z;
  return std::sqrt(x * x + y * y + z * z);
}

}  // namespace

void validate(const SimulationOptions& options) {
  constexpr double kMost = 1e6;
  check_range("iterations", options.iterations, 1, 100);
  check_range("relaxation", options.relaxation, 0, kMost);
  check_range("warm start", options.warm_start, 0, 1);
  check_range("standing pressure", options.standing_pressure, 0, 1);
  check_range("artificial pressure", options.artificial_pressure, 0, 1);
  check_range("viscosity", options.viscosity, 0, 1);
  check_range("vorticity", options.vorticity, 0, kMost);
  check_range("gravity", options.gravity, 0, kMost);
  check_range("courant", options.courant, 0.05, 1);
  check_range("most substeps", options.most_substeps, 1, 1000);
  check_range("fewest substeps", options.fewest_substeps, 1, options.most_substeps);
}

class PSK_HIDDEN Simulation::Impl {
 public:
  Impl(Scene scene, const SimulationOptions& options, Workspace workspace)
      : scene_(std::move(scene)), options_(options), workspace_(std::move(workspace)) {
    validate(options);
    if (scene_.positions.empty() || !(scene_.spacing > 0)) refuse("a scene needs particles and a spacing");
    radius_ = scene_.spacing / kRestSpacing;
    settings_.kernel = make_kernel_constants();
    settings_.iterations = options.iterations;
    settings_.warm_start = static_cast<float>(options.warm_start);
    settings_.standing = static_cast<float>(options.standing_pressure);
    settings_.relaxation = static_cast<float>(options.relaxation);
    settings_.artificial_pressure = static_cast<float>(options.artificial_pressure);
    settings_.viscosity = static_cast<float>(options.viscosity);
    settings_.vorticity = static_cast<float>(options.vorticity);
    settings_.gravity = static_cast<float>(options.gravity) / radius_;
    settings_.solids.tank = 1 / radius_ * scene_.tank;
    settings_.solids.gap = kGapShare * kRestSpacing / 2;
    start();
  }

  void start() {
    report_ = {};
    moved_.reset();
    settings_.seconds = 0;
    report_.particles = static_cast<std::int64_t>(scene_.positions.size());
    state_ = {};  // its memory is used again
    state_ = exec::visit(space(), [&](auto& ex) { return start_particles(ex, scene_, radius_); });
    describe();
  }

  void step(double seconds, const std::vector<Interaction>& interactions) {
    const Stopwatch watch;
    if (!(seconds > 0 && seconds <= 1)) refuse("a frame's seconds must be in (0, 1]");
    set_forces(interactions);
    const Obstacle here = obstacle();
    const Obstacle next = obstacle_after(seconds);
    const int substeps = substeps_for(seconds, length_of(next.centre - here.centre) / seconds);
    const double part = seconds / substeps;
    // Multipliers are a pressure times seconds^2.
    const double ratio = settings_.seconds > 0 ? part / double{settings_.seconds} : 1;
    settings_.rescale = static_cast<float>(ratio * ratio);
    settings_.mean_share = static_cast<float>(std::min(1.0, part / kStandingSeconds));
    settings_.missing_share = static_cast<float>(std::min(1.0, part / kSurfaceSeconds));
    settings_.seconds = static_cast<float>(part);
    for (int i = 1; i <= substeps; ++i) {
      place_obstacle(moved_ ? between(here, next, static_cast<float>(i) / static_cast<float>(substeps))
                            : scene_.obstacle_at(report_.seconds + part * i));
      exec::visit(space(), [&](auto& ex) { substep(ex, state_.particles, settings_, state_.grid); });
      settings_.rescale = 1;
    }
    if (moved_) moved_->centre = next.centre;
    report_.substeps = substeps;
    report_.seconds += seconds;
    ++report_.frame;
    describe();
    report_.ms = watch.milliseconds();
  }

  void move_obstacle(const Vec3f& goal) {
    const float radius = scene_.obstacle_radius;
    if (!(radius > 0)) refuse("this scene has no obstacle");
    if (!is_finite(goal)) refuse("the place of an obstacle must be finite");
    const auto within = [radius](float x, float side) {
      return std::clamp(x, radius, std::max(radius, side - radius));
    };
    const Vec3f& tank = scene_.tank;
    moved_ = {obstacle().centre, {within(goal.x, tank.x), within(goal.y, tank.y), within(goal.z, tank.z)}};
  }

  [[nodiscard]] Obstacle obstacle() const {
    return moved_ ? Obstacle{moved_->centre, scene_.obstacle_radius} : scene_.obstacle_at(report_.seconds);
  }

  void surface(const FluidOptions& given, Mesh& mesh) {
    const FluidOptions options = settled(given);
    surface_report_ = {};
    exec::visit(space(), [&](auto& ex) {
      fluid::FluidSurface made = surface_of(ex, state_, options, box_, surface_report_);
      fluid::download_surface(ex, std::move(made), names(options), {}, mesh, surface_report_);
    });
  }

  DeviceMesh surface_on_device(const FluidOptions& given) {
    const FluidOptions options = settled(given);
    surface_report_ = {};
    return exec::visit(space(), [&](auto& ex) {
      fluid::FluidSurface made = surface_of(ex, state_, options, box_, surface_report_);
      surface_report_.device_peak_bytes = ex.pool()->peak_bytes();
      return detail::handle_of(workspace_, {std::move(made.mesh), names(options), std::move(made.values)}, {});
    });
  }

  [[nodiscard]] const exec::AnySpace& space() const { return workspace_.data().space; }

  Scene scene_;
  SimulationOptions options_;
  Workspace workspace_;
  SimulationReport report_;
  FluidReport surface_report_;
  FluidState state_;

 private:
  [[nodiscard]] FluidOptions settled(FluidOptions options) const {
    if (options.particle_radius == 0) options.particle_radius = 0.5 * double{scene_.spacing};
    if (options.surface_threshold == 0 && options.kernel == FluidKernel::isotropic)
      options.surface_threshold = kSurfaceThreshold;
    pointskin::validate(options);
    return options;
  }

  static std::vector<std::string> names(const FluidOptions& options) {
    if (!options.attributes) return {};
    return {std::begin(kVelocityNames), std::end(kVelocityNames)};
  }

  void set_forces(const std::vector<Interaction>& interactions) {
    std::vector<Interaction> all = scene_.interactions_at(report_.seconds);
    all.insert(all.end(), interactions.begin(), interactions.end());
    if (all.size() > kMostInteractions) refuse("more than " + std::to_string(kMostInteractions) + " forces at once");
    settings_.force_count = 0;
    for (const Interaction& given : all) {
      const double length = length_of(given.direction);
      if (!is_finite(given.centre) || !std::isfinite(length) || !(length > 0) || !(given.radius > 0) ||
          !std::isfinite(given.radius) || !std::isfinite(given.strength))
        refuse("an interaction needs finite numbers, a direction and a radius above 0");
      const auto scale = static_cast<float>(given.strength / (length * radius_));
      settings_.forces[settings_.force_count++] = {1 / radius_ * given.centre, scale * given.direction,
                                                   radius_ / given.radius, given.kind == Interaction::Kind::swirl};
    }
  }

  /// Where the obstacle is at the end of a frame.
  [[nodiscard]] Obstacle obstacle_after(double seconds) const {
    if (!moved_) return scene_.obstacle_at(report_.seconds + seconds);
    const double way = length_of(moved_->goal - moved_->centre);
    const double share = way > 0 ? std::min(1.0, kObstacleSpeed * seconds / way) : 1;
    return between(obstacle(), {moved_->goal, scene_.obstacle_radius}, static_cast<float>(share));
  }

  static Obstacle between(const Obstacle& from, const Obstacle& to, float share) {
    return {from.centre + share * (to.centre - from.centre), from.radius};
  }

  /// In equal parts, none of which moves anything farther than `courant` kernel radii.
  /// @param obstacle_speed  metres / second
  [[nodiscard]] int substeps_for(double seconds, double obstacle_speed) const {
    const double speed = std::max(double{report_.max_speed}, obstacle_speed);
    const double way = seconds * (speed + options_.gravity * seconds) / radius_;
    const double needed = std::ceil(way / options_.courant);
    return static_cast<int>(
        std::clamp(needed, double{1} * options_.fewest_substeps, double{1} * options_.most_substeps));
  }

  void place_obstacle(const Obstacle& obstacle) {
    settings_.solids.centre = 1 / radius_ * obstacle.centre;
    settings_.solids.radius = obstacle.radius / radius_;
  }

  void describe() {
    const Totals totals =
        exec::visit(space(), [&](auto& ex) { return totals_of(ex, state_.particles, settings_.solids); });
    const double n = static_cast<double>(report_.particles);
    const double radius = radius_;
    const double mass = kWaterDensity * double{scene_.spacing} * scene_.spacing * scene_.spacing;
    box_ = totals.box;
    report_.lost = totals.lost;
    report_.crowded = totals.crowded;
    report_.mean_density_error = totals.compression / n;
    report_.max_density_error = totals.most_compression;
    report_.kinetic_energy = 0.5 * mass * radius * radius * totals.squared_speed;
    report_.potential_energy = mass * options_.gravity * radius * totals.height;
    report_.max_speed = radius * std::sqrt(double{totals.fastest_squared});
  }

  /// An obstacle that somebody has taken from its own way; metres.
  struct Moved {
    Vec3f centre{}, goal{};
  };

  float radius_ = 1;  ///< of the kernel, metres
  std::optional<Moved> moved_;
  StepSettings settings_;
  Bounds box_;
};

Simulation::Simulation(Scene scene, const SimulationOptions& options, Workspace workspace)
    : impl_(std::make_unique<Impl>(std::move(scene), options, std::move(workspace))) {}
Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

void Simulation::step(double seconds, const std::vector<Interaction>& interactions) {
  impl_->step(seconds, interactions);
}
void Simulation::move_obstacle(const Vec3f& centre) { impl_->move_obstacle(centre); }
Obstacle Simulation::obstacle() const { return impl_->obstacle(); }
void Simulation::restart() { impl_->start(); }
void Simulation::surface(const FluidOptions& options, Mesh& mesh) { impl_->surface(options, mesh); }
DeviceMesh Simulation::surface_on_device(const FluidOptions& options) { return impl_->surface_on_device(options); }
ParticleStates Simulation::particles() const {
  return exec::visit(impl_->space(), [&](auto& ex) { return copy_particles(ex, impl_->state_); });
}
const Scene& Simulation::scene() const { return impl_->scene_; }
const SimulationOptions& Simulation::options() const { return impl_->options_; }
const FluidReport& Simulation::surface_report() const { return impl_->surface_report_; }
const SimulationReport& Simulation::report() const { return impl_->report_; }
const Workspace& Simulation::workspace() const { return impl_->workspace_; }
const Device& Simulation::device() const { return impl_->workspace_.device(); }
double Simulation::particle_radius() const { return 0.5 * double{impl_->scene_.spacing}; }
std::int64_t Simulation::peak_bytes() const { return impl_->space().pool()->peak_bytes(); }

}  // namespace pointskin::simulation
