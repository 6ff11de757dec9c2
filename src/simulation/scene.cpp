#include <pointskin/simulation.hpp>

#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

namespace pointskin::simulation {
namespace {

constexpr std::array<std::pair<SceneKind, const char*>, 5> kNames{{{SceneKind::dam_break, "dam-break"},
                                                                   {SceneKind::double_dam_break, "double-dam-break"},
                                                                   {SceneKind::drop, "drop"},
                                                                   {SceneKind::obstacle, "obstacle"},
                                                                   {SceneKind::stir, "stir"}}};

/// A box of water that stands on the floor.
struct Block {
  double x0, x1, height, z0, z1;
  [[nodiscard]] double volume() const { return (x1 - x0) * height * (z1 - z0); }
};

/// Metres. The first block takes the particles that the others and the ball leave.
struct Plan {
  Vec3d tank;
  std::vector<Block> blocks;
  Vec3d ball_centre{};
  double ball_radius = 0;      ///< of water, in the air; 0: none
  double obstacle_radius = 0;  ///< of stone, at obstacle_place(0); 0: none
};

constexpr double kPi = 3.14159265358979324;
constexpr double kObstacleRadius = 0.13;
constexpr double kObstacleHeight = 0.26;
constexpr double kObstaclePeriod = 4;  // seconds, to and fro

double ball_volume(double radius) { return 4 * kPi / 3 * radius * radius * radius; }

Plan plan_of(SceneKind kind) {
  switch (kind) {
    case SceneKind::dam_break:
      return {{2, 1.2, 0.8}, {{0, 0.8, 0.7, 0, 0.8}}};
    case SceneKind::double_dam_break:
      return {{2, 1.2, 0.8}, {{0, 0.7, 0.75, 0, 0.4}, {1.3, 2, 0.75, 0.4, 0.8}}};
    case SceneKind::drop:
      return {{1.2, 1.2, 1.2}, {{0, 1.2, 0.3, 0, 1.2}}, {0.6, 0.8, 0.6}, 0.22};
    case SceneKind::obstacle:
      return {{2, 1, 0.8}, {{0, 2, 0.4, 0, 0.8}}, {}, 0, kObstacleRadius};
    case SceneKind::stir:
      break;
  }
  return {{1, 0.9, 1}, {{0, 1, 0.45, 0, 1}}};
}

/// The cube root by Newton's method: the same bits with every C library.
double cube_root(double a) {
  double x = std::max(1.0, a);
  for (int i = 0; i < 200; ++i) x -= (x * x * x - a) / (3 * x * x);
  return x;
}

std::int64_t cells(double length, double spacing) {
  return std::max<std::int64_t>(1, static_cast<std::int64_t>(std::floor(length / spacing + 0.5)));
}

/// Adds lattice points, layer by layer upwards; stops at `count`, or at the tank's lid.
class Filler {
 public:
  Filler(double spacing, const Plan& plan, Scene& scene)
      : spacing_(spacing), top_(cells(plan.tank[1], spacing)), plan_(plan), scene_(scene) {
    const Obstacle obstacle = scene.obstacle_at(0);
    obstacle_ = {obstacle.centre.x, obstacle.centre.y, obstacle.centre.z};
  }

  void fill(const Block& block, std::int64_t count) {
    const std::int64_t x0 = lattice(block.x0);
    const std::int64_t x1 = std::max(x0 + 1, lattice(block.x1));
    const std::int64_t z0 = lattice(block.z0);
    const std::int64_t z1 = std::max(z0 + 1, lattice(block.z1));
    for (std::int64_t y = 0; y < top_; ++y)
      for (std::int64_t x = x0; x < x1; ++x)
        for (std::int64_t z = z0; z < z1; ++z) {
          if (count == 0) return;
          if (add(x, y, z)) --count;
        }
    throw Error(ErrorCode::internal, "a scene's water does not fit into its tank");
  }

  void fill_ball() {
    const auto reach = static_cast<std::int64_t>(plan_.ball_radius / spacing_) + 1;
    const std::array<std::int64_t, 3> middle{lattice(plan_.ball_centre[0]), lattice(plan_.ball_centre[1]),
                                             lattice(plan_.ball_centre[2])};
    for (std::int64_t y = middle[1] - reach; y <= middle[1] + reach; ++y)
      for (std::int64_t x = middle[0] - reach; x <= middle[0] + reach; ++x)
        for (std::int64_t z = middle[2] - reach; z <= middle[2] + reach; ++z)
          if (squared_distance(x, y, z, plan_.ball_centre) < plan_.ball_radius * plan_.ball_radius) add(x, y, z);
  }

 private:
  [[nodiscard]] std::int64_t lattice(double at) const {
    return static_cast<std::int64_t>(std::floor(at / spacing_ + 0.5));
  }
  [[nodiscard]] double place(std::int64_t i) const { return (static_cast<double>(i) + 0.5) * spacing_; }
  [[nodiscard]] double squared_distance(std::int64_t x, std::int64_t y, std::int64_t z, const Vec3d& from) const {
    const double dx = place(x) - from[0];
    const double dy = place(y) - from[1];
    const double dz = place(z) - from[2];
    return dx * dx + dy * dy + dz * dz;
  }

  /// @returns false where the obstacle is
  bool add(std::int64_t x, std::int64_t y, std::int64_t z) {
    const double room = plan_.obstacle_radius + 0.5 * spacing_;
    if (plan_.obstacle_radius > 0 && squared_distance(x, y, z, obstacle_) < room * room) return false;
    scene_.positions.push_back(
        {static_cast<float>(place(x)), static_cast<float>(place(y)), static_cast<float>(place(z))});
    return true;
  }

  double spacing_;
  std::int64_t top_;
  const Plan& plan_;
  Scene& scene_;
  Vec3d obstacle_{};
};

/// 0 at 0, 1 at 1, slope 0 at both.
double smooth_step(double t) { return t * t * (3 - 2 * t); }

}  // namespace

const char* name_of(SceneKind kind) { return kNames.at(static_cast<std::size_t>(kind)).second; }

std::optional<SceneKind> parse_scene(const std::string& name) {
  for (const auto& [kind, text] : kNames)
    if (name == text) return kind;
  return std::nullopt;
}

std::vector<SceneKind> all_scenes() {
  std::vector<SceneKind> all;
  for (const auto& entry : kNames) all.push_back(entry.first);
  return all;
}

Obstacle Scene::obstacle_at(double seconds) const {
  if (!(obstacle_radius > 0)) return {};
  const double turns = seconds / kObstaclePeriod;
  const double phase = 2 * (turns - std::floor(turns));  // 0..1 to, 1..2 fro
  const double share = smooth_step(phase < 1 ? phase : 2 - phase);
  const double low = 2.5 * obstacle_radius;
  const double high = tank.x - low;
  return {{static_cast<float>(low + share * (high - low)), static_cast<float>(kObstacleHeight), tank.z / 2},
          obstacle_radius};
}

std::vector<Interaction> Scene::interactions_at(double /*seconds*/) const {
  if (kind != SceneKind::stir) return {};
  const float radius = 0.45F * tank.x;
  return {{Interaction::Kind::swirl, {tank.x / 2, 0.2F, tank.z / 2}, {0, 1, 0}, radius, 12}};
}

Scene make_scene(SceneKind kind, std::int64_t particles) {
  if (particles < kFewestParticles || particles > kMostParticles)
    throw Error(ErrorCode::usage, std::to_string(particles) + " particles are not in [" +
                                      std::to_string(kFewestParticles) + ", " + std::to_string(kMostParticles) + "]");
  const Plan plan = plan_of(kind);
  double volume = ball_volume(plan.ball_radius) - ball_volume(plan.obstacle_radius);
  for (const Block& block : plan.blocks) volume += block.volume();
  const double spacing = cube_root(volume / static_cast<double>(particles));
  Scene scene;
  scene.kind = kind;
  scene.spacing = static_cast<float>(spacing);
  const auto side = [&](std::size_t a) {
    return static_cast<float>(static_cast<double>(cells(plan.tank[a], spacing)) * spacing);
  };
  scene.tank = {side(0), side(1), side(2)};
  scene.obstacle_radius = static_cast<float>(plan.obstacle_radius);
  scene.positions.reserve(static_cast<std::size_t>(particles));
  Filler filler(spacing, plan, scene);
  if (plan.ball_radius > 0) filler.fill_ball();
  const auto left = [&] { return particles - static_cast<std::int64_t>(scene.positions.size()); };
  for (std::size_t b = 1; b < plan.blocks.size(); ++b)
    filler.fill(plan.blocks[b], left() / static_cast<std::int64_t>(plan.blocks.size() - b + 1));
  filler.fill(plan.blocks[0], left());
  return scene;
}

}  // namespace pointskin::simulation
