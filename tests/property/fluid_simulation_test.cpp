// Position-based fluids: what must hold of every frame of every scene.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include <pointskin/simulation.hpp>

namespace pointskin::simulation {
namespace {

constexpr double kFrame = 1.0 / 60;

template <class T>
bool same_bytes(const std::vector<T>& a, const std::vector<T>& b) {
  return a.size() == b.size() && std::memcmp(a.data(), b.data(), a.size() * sizeof(T)) == 0;
}

bool same_bytes(const ParticleStates& a, const ParticleStates& b) {
  return same_bytes(a.positions, b.positions) && same_bytes(a.velocities, b.velocities);
}

/// A pool at rest: the scene `stir` without its force.
Scene pool(std::int64_t particles) {
  Scene scene = make_scene(SceneKind::stir, particles);
  scene.kind = SceneKind::dam_break;
  return scene;
}

double energy(const SimulationReport& report) { return report.kinetic_energy + report.potential_energy; }

double squared_distance(const Vec3f& a, const Vec3f& b) {
  const double x = double{a.x} - double{b.x};
  const double y = double{a.y} - double{b.y};
  const double z = double{a.z} - double{b.z};
  return x * x + y * y + z * z;
}

/// Density at a particle over that of water at rest, whose order is not that of the lattice, from all particles and all
/// their images in the tank's walls.
double density_by_brute_force(const Scene& scene, const std::vector<Vec3f>& positions, std::size_t i) {
  const double radius = 2 * double{scene.spacing};
  const auto weight = [radius](double squared) {
    const double t = 1 - squared / (radius * radius);
    return t > 0 ? t * t * t : 0.0;
  };
  double rest = 0;
  for (int x = -2; x <= 2; ++x)
    for (int y = -2; y <= 2; ++y)
      for (int z = -2; z <= 2; ++z) rest += weight((x * x + y * y + z * z) * double{scene.spacing} * scene.spacing);
  double sum = 0;
  for (const Vec3f& p : positions)
    for (const float x : {p.x, -p.x, 2 * scene.tank.x - p.x})
      for (const float y : {p.y, -p.y, 2 * scene.tank.y - p.y})
        for (const float z : {p.z, -p.z, 2 * scene.tank.z - p.z})
          sum += weight(squared_distance(positions[i], {x, y, z}));
  constexpr double kRestOrder = 0.9945;
  return sum / (kRestOrder * rest);
}

class EveryScene : public testing::TestWithParam<SceneKind> {};
INSTANTIATE_TEST_SUITE_P(Scenes, EveryScene, testing::ValuesIn(all_scenes()), [](const auto& info) {
  std::string name = name_of(info.param);
  std::replace(name.begin(), name.end(), '-', '_');
  return name;
});

TEST_P(EveryScene, HasAsManyParticlesAsAskedForInsideOfItsTankAndApart) {
  for (const std::int64_t count : {200, 777, 5000, 32768, 100'003}) {
    SCOPED_TRACE(count);
    const Scene scene = make_scene(GetParam(), count);
    ASSERT_EQ(static_cast<std::int64_t>(scene.positions.size()), count);
    const float half = 0.49F * scene.spacing;
    for (const Vec3f& p : scene.positions) {
      ASSERT_TRUE(p.x > half && p.y > half && p.z > half);
      ASSERT_TRUE(p.x < scene.tank.x - half && p.y < scene.tank.y - half && p.z < scene.tank.z - half);
    }
    std::vector<Vec3f> sorted = scene.positions;
    std::sort(sorted.begin(), sorted.end(), [](const Vec3f& a, const Vec3f& b) {
      return a.x != b.x ? a.x < b.x : a.y != b.y ? a.y < b.y : a.z < b.z;
    });
    EXPECT_EQ(std::adjacent_find(sorted.begin(), sorted.end()), sorted.end());
  }
}

TEST_P(EveryScene, StartsNoDenserThanTheLattice) {
  const Simulation simulation(make_scene(GetParam(), 4000), {}, Device::cpu(2));
  EXPECT_EQ(simulation.report().particles, 4000);
  EXPECT_EQ(simulation.report().kinetic_energy, 0);
  const ParticleStates at_first = simulation.particles();
  for (std::size_t i = 0; i < 4000; i += 397)
    EXPECT_LT(density_by_brute_force(simulation.scene(), at_first.positions, i), 1.0001 / 0.9945);
}

/// Limits of the energy over that at the start: the stone and the stirring add some.
double most_energy(SceneKind kind) { return kind == SceneKind::stir ? 2.0 : kind == SceneKind::obstacle ? 1.15 : 1.02; }

TEST_P(EveryScene, KeepsItsParticlesItsDensityAndItsEnergyForThreeHundredFrames) {
  Simulation simulation(make_scene(GetParam(), 3000), {}, Device::cpu(2));
  const double at_first = energy(simulation.report());
  for (int frame = 1; frame <= 300; ++frame) {
    simulation.step(kFrame);
    const SimulationReport& report = simulation.report();
    ASSERT_EQ(report.frame, frame);
    ASSERT_EQ(report.lost, 0) << frame;
    ASSERT_EQ(report.crowded, 0) << frame;
    ASSERT_LT(report.mean_density_error, 0.04) << frame;
    ASSERT_LT(report.max_density_error, 0.4) << frame;
    ASSERT_LT(energy(report), most_energy(GetParam()) * at_first) << frame;
    ASSERT_GE(report.substeps, 2);
  }
  const ParticleStates now = simulation.particles();
  ASSERT_EQ(now.positions.size(), 3000U);
  const Scene& scene = simulation.scene();
  const Obstacle obstacle = scene.obstacle_at(simulation.report().seconds);
  for (std::size_t i = 0; i < 3000; ++i) {
    const Vec3f p = now.positions[i];
    ASSERT_TRUE(p.x > 0 && p.y > 0 && p.z > 0 && p.x < scene.tank.x && p.y < scene.tank.y && p.z < scene.tank.z);
    ASSERT_TRUE(std::isfinite(now.velocities[i].x + now.velocities[i].y + now.velocities[i].z));
    ASSERT_GE(squared_distance(p, obstacle.centre), 0.998 * obstacle.radius * obstacle.radius);
  }
}

TEST_P(EveryScene, GivesTheSameBytesForAnyNumberOfThreadsAndAfterARestart) {
  const Scene scene = make_scene(GetParam(), 3000);
  const auto run = [](Simulation& simulation) {
    for (int frame = 0; frame < 25; ++frame) simulation.step(kFrame);
    return simulation.particles();
  };
  Simulation alone(scene, {}, Device::cpu(1));
  const ParticleStates expected = run(alone);
  const SimulationReport report = alone.report();
  EXPECT_FALSE(same_bytes(expected.positions, scene.positions));
  for (const int threads : {2, 5}) {
    Simulation simulation(scene, {}, Device::cpu(threads));
    EXPECT_TRUE(same_bytes(run(simulation), expected)) << threads;
    EXPECT_EQ(simulation.report().mean_density_error, report.mean_density_error);
    EXPECT_EQ(simulation.report().kinetic_energy, report.kinetic_energy);
  }
  alone.restart();
  EXPECT_EQ(alone.report().frame, 0);
  EXPECT_TRUE(same_bytes(run(alone), expected));
}

TEST(Pool, StaysAtRest) {
  Simulation simulation(pool(4000), {}, Device::cpu(2));
  const double potential = simulation.report().potential_energy;
  double fastest = 0;
  for (int frame = 0; frame < 240; ++frame) {
    simulation.step(kFrame);
    EXPECT_LT(simulation.report().kinetic_energy, 0.01 * potential);
    if (frame >= 180) fastest = std::max(fastest, simulation.report().max_speed);
  }
  // It has settled a little, and hardly anything moves.
  EXPECT_LT(simulation.report().kinetic_energy, 0.002 * potential);
  EXPECT_LT(fastest, 0.4);
  EXPECT_NEAR(simulation.report().potential_energy, potential, 0.05 * potential);
}

TEST(Density, IsWhatAllParticlesAndTheirImagesAddUpTo) {
  Simulation simulation(make_scene(SceneKind::dam_break, 1500), {}, Device::cpu(2));
  for (int frame = 0; frame < 40; ++frame) simulation.step(kFrame);
  const ParticleStates now = simulation.particles();
  double sum = 0;
  double most = 0;
  for (std::size_t i = 0; i < now.positions.size(); ++i) {
    const double error = std::max(0.0, density_by_brute_force(simulation.scene(), now.positions, i) - 1);
    sum += error;
    most = std::max(most, error);
  }
  const SimulationReport& report = simulation.report();
  EXPECT_GT(sum, 0);
  // Neighbours that came near during the corrections do not count in the report.
  EXPECT_NEAR(report.mean_density_error, sum / 1500, 0.15 * sum / 1500);
  EXPECT_NEAR(report.max_density_error, most, 0.15 * most + 0.005);
}

TEST(FreeFall, IsThatOfAStone) {
  Scene scene = make_scene(SceneKind::drop, 2000);
  std::vector<Vec3f> ball;
  for (const Vec3f& p : scene.positions)
    if (p.y > 0.45F) ball.push_back(p);
  ASSERT_GT(ball.size(), 100U);
  scene.positions = ball;
  SimulationOptions options;
  options.artificial_pressure = 0;
  Simulation simulation(scene, options, Device::cpu(2));
  const auto mean_height = [&] {
    double sum = 0;
    const ParticleStates now = simulation.particles();
    for (const Vec3f& p : now.positions) sum += p.y;
    return sum / static_cast<double>(ball.size());
  };
  const double before = mean_height();
  double speed = 0;
  double fallen = 0;
  for (int frame = 0; frame < 12; ++frame) {
    simulation.step(kFrame);
    for (int part = 0; part < simulation.report().substeps; ++part) {  // symplectic Euler
      const double seconds = kFrame / simulation.report().substeps;
      speed += 9.81 * seconds;
      fallen += speed * seconds;
    }
  }
  EXPECT_NEAR(before - mean_height(), fallen, 1e-3 * fallen);
  EXPECT_NEAR(simulation.report().max_speed, speed, 0.01 * speed);
}

TEST(Interaction, PushesAndSwirlsWhatIsWithinItsBall) {
  SimulationOptions options;
  options.gravity = 0;
  options.artificial_pressure = 0;
  const Scene scene = pool(4000);
  Interaction push{Interaction::Kind::push, {0.5F, 0.2F, 0.5F}, {0, 0, 2}, 0.2F, 30};
  const auto velocities_after = [&](const Interaction& interaction) {
    Simulation simulation(scene, options, Device::cpu(2));
    simulation.step(kFrame, {interaction});
    return simulation.particles().velocities;
  };
  const auto mean_along = [&](const std::vector<Vec3f>& v, const auto& along) {
    double sum = 0;
    double count = 0;
    for (std::size_t i = 0; i < v.size(); ++i) {
      const Vec3f p = scene.positions[i];
      if (squared_distance(p, push.centre) > 0.01) continue;
      const Vec3f axis = along(p);
      sum += v[i].x * axis.x + v[i].y * axis.y + v[i].z * axis.z;
      ++count;
    }
    return sum / count;
  };
  const auto z = [](const Vec3f&) { return Vec3f{0, 0, 1}; };
  const std::vector<Vec3f> pushed = velocities_after(push);
  EXPECT_GT(mean_along(pushed, z), 0.05);  // at most 30 / 60 m/s
  EXPECT_LT(mean_along(pushed, z), 0.5);
  push.strength = -30;
  EXPECT_LT(mean_along(velocities_after(push), z), -0.05);
  for (std::size_t i = 0; i < pushed.size(); ++i)  // what is far away hardly notices
    if (squared_distance(scene.positions[i], push.centre) > 0.16) {
      ASSERT_LT(squared_distance(pushed[i], {}), 5e-4) << i;  // 0.02 m/s
    }
  push = {Interaction::Kind::swirl, push.centre, {0, 1, 0}, 0.3F, 30};
  const auto around = [&](const Vec3f& p) {  // y cross (p - centre)
    return Vec3f{p.z - push.centre.z, 0, -(p.x - push.centre.x)};
  };
  const std::vector<Vec3f> swirled = velocities_after(push);
  EXPECT_GT(mean_along(swirled, around), 0.001);
  EXPECT_NEAR(mean_along(swirled, z), 0, 0.01);
}

TEST(Vorticity, ConfinementKeepsMoreOfASwirl) {
  const auto kinetic_after = [](double vorticity) {
    SimulationOptions options;
    options.vorticity = vorticity;
    options.viscosity = 0.1;
    Simulation simulation(pool(3000), options, Device::cpu(2));
    const Interaction swirl{Interaction::Kind::swirl, {0.5F, 0.2F, 0.5F}, {0, 1, 0}, 0.45F, 20};
    for (int frame = 0; frame < 20; ++frame) simulation.step(kFrame, {swirl});
    for (int frame = 0; frame < 40; ++frame) simulation.step(kFrame);
    return simulation.report().kinetic_energy;
  };
  EXPECT_GT(kinetic_after(0.5), 1.02 * kinetic_after(0));
}

TEST(Substeps, FollowTheFastestParticle) {
  SimulationOptions options;
  options.fewest_substeps = 1;
  Simulation simulation(make_scene(SceneKind::dam_break, 2000), options, Device::cpu(2));
  const double radius = 2 * double{simulation.scene().spacing};
  for (int frame = 0; frame < 30; ++frame) {
    const double speed = simulation.report().max_speed;
    simulation.step(1.0 / 30);
    const double way = (speed + 9.81 / 30) / 30 / radius;
    EXPECT_EQ(simulation.report().substeps, std::max(1, static_cast<int>(std::ceil(way / options.courant))));
  }
}

TEST(Surface, OfASimulationIsClosedAndCarriesVelocities) {
  Simulation simulation(make_scene(SceneKind::double_dam_break, 3000), {}, Device::cpu(2));
  for (int frame = 0; frame < 10; ++frame) simulation.step(kFrame);
  Mesh mesh;
  simulation.surface({}, mesh);
  const MeshReport report = measure(mesh);
  EXPECT_TRUE(report.watertight());
  const double water = 3000 * std::pow(double{simulation.scene().spacing}, 3);
  EXPECT_NEAR(report.volume, water, 0.1 * water);
  ASSERT_EQ(mesh.attributes.size(), 3U);
  EXPECT_EQ(mesh.attributes[1].name, "velocity_y");
  const std::vector<float>& velocities = mesh.attributes[1].values.as<float>();
  const auto lowest = *std::min_element(velocities.begin(), velocities.end());
  EXPECT_LT(lowest, -0.5F);
  EXPECT_GE(lowest, -1.2F * static_cast<float>(simulation.report().max_speed));
  Simulation other(make_scene(SceneKind::double_dam_break, 3000), {}, Device::cpu(5));
  for (int frame = 0; frame < 10; ++frame) other.step(kFrame);
  Mesh again;
  other.surface({}, again);
  EXPECT_TRUE(same_bytes(again.vertices, mesh.vertices));
  EXPECT_TRUE(same_bytes(again.triangles, mesh.triangles));
}

TEST(Simulation, RefusesWhatIsOutOfRange) {
  const auto code_of = [](const auto& call) {
    try {
      call();
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::internal;
  };
  EXPECT_EQ(code_of([] { make_scene(SceneKind::drop, kFewestParticles - 1); }), ErrorCode::usage);
  EXPECT_EQ(code_of([] { make_scene(SceneKind::drop, kMostParticles + 1); }), ErrorCode::usage);
  SimulationOptions options;
  options.iterations = 0;
  EXPECT_EQ(code_of([&] { validate(options); }), ErrorCode::usage);
  options = {};
  options.courant = std::nan("");
  EXPECT_EQ(code_of([&] { validate(options); }), ErrorCode::usage);
  Simulation simulation(pool(300), {}, Device::cpu(1));
  EXPECT_EQ(code_of([&] { simulation.step(0); }), ErrorCode::usage);
  EXPECT_EQ(code_of([&] {
              simulation.step(kFrame, {Interaction{Interaction::Kind::push, {}, {0, 0, 0}}});
            }),
            ErrorCode::usage);
  EXPECT_EQ(code_of([&] { simulation.step(kFrame, std::vector<Interaction>(9)); }), ErrorCode::usage);
  EXPECT_EQ(parse_scene("dam_break"), std::nullopt);
  for (const SceneKind kind : all_scenes()) EXPECT_EQ(parse_scene(name_of(kind)), kind);
}

/// Drags the obstacle through a pool for some frames. @returns the particles at the end
ParticleStates dragged(Simulation& simulation) {
  simulation.move_obstacle({1.5F, 0.4F, 0.3F});
  for (int frame = 0; frame < 12; ++frame) simulation.step(kFrame);
  simulation.move_obstacle({9, -9, 0.3F});
  for (int frame = 0; frame < 12; ++frame) simulation.step(kFrame);
  return simulation.particles();
}

TEST(Obstacle, GoesWhereItIsMovedAndStaysInTheTank) {
  Simulation simulation(make_scene(SceneKind::obstacle, 3000));
  const Scene& scene = simulation.scene();
  simulation.step(kFrame);
  const Vec3f before = simulation.obstacle().centre;
  simulation.move_obstacle({before.x + 0.05F, before.y, before.z});
  simulation.step(kFrame);
  EXPECT_NEAR(double{simulation.obstacle().centre.x}, double{before.x} + 0.05, 1e-6);  // 3 metres / second
  simulation.move_obstacle({9, 9, 9});
  simulation.step(kFrame);
  const double way = std::sqrt(squared_distance(simulation.obstacle().centre, {before.x + 0.05F, before.y, before.z}));
  EXPECT_NEAR(way, 5 * kFrame, 1e-6);
  for (int frame = 0; frame < 60; ++frame) simulation.step(kFrame);
  const float radius = scene.obstacle_radius;
  const Vec3f corner{scene.tank.x - radius, scene.tank.y - radius, scene.tank.z - radius};
  EXPECT_LT(squared_distance(simulation.obstacle().centre, corner), 1e-10);
}

TEST(Obstacle, PushesTheWaterThatIsInItsWay) {
  Simulation simulation(make_scene(SceneKind::obstacle, 3000));
  const ParticleStates first = dragged(simulation);
  const Obstacle obstacle = simulation.obstacle();
  for (const Vec3f& p : first.positions)
    ASSERT_GE(squared_distance(p, obstacle.centre), 0.998 * obstacle.radius * obstacle.radius);
  simulation.restart();
  EXPECT_TRUE(same_bytes(dragged(simulation), first));
  Simulation alone(make_scene(SceneKind::obstacle, 3000));
  for (int frame = 0; frame < 24; ++frame) alone.step(kFrame);
  EXPECT_FALSE(same_bytes(alone.particles(), first));
}

TEST(Obstacle, IsRefusedWhereThereIsNone) {
  Simulation simulation(make_scene(SceneKind::dam_break, 1000));
  EXPECT_THROW(simulation.move_obstacle({0, 0, 0}), Error);
  Simulation with(make_scene(SceneKind::obstacle, 1000));
  EXPECT_THROW(with.move_obstacle({NAN, 0, 0}), Error);
}

}  // namespace
}  // namespace pointskin::simulation
