// Position-based fluids: the water's volume is the particles', at the start and once it has come to rest.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <pointskin/simulation.hpp>

namespace pointskin::simulation {
namespace {

constexpr double kFrame = 1.0 / 60;

double volume_of_particles(const Simulation& simulation) {
  return static_cast<double>(simulation.scene().positions.size()) * std::pow(double{simulation.scene().spacing}, 3);
}

/// Mean height of the surface away from the walls, over what the water's volume takes in the tank.
double level_of(const Mesh& mesh, const Simulation& simulation) {
  const Vec3f tank = simulation.scene().tank;
  const double expected = volume_of_particles(simulation) / (double{tank.x} * double{tank.z});
  const float far = 2 * simulation.scene().spacing;
  double sum = 0;
  std::int64_t count = 0;
  for (const Vec3f& v : mesh.vertices) {
    if (v.x < far || v.z < far || v.x > tank.x - far || v.z > tank.z - far || v.y < 0.5 * expected) continue;
    sum += v.y;
    ++count;
  }
  return sum / (static_cast<double>(count) * expected);
}

void expect_within_one_percent_at_rest(Simulation& simulation, double most_speed) {
  ASSERT_LT(simulation.report().max_speed, most_speed) << "this is not at rest";
  Mesh mesh;
  simulation.surface({}, mesh);
  const MeshReport report = measure(mesh);
  EXPECT_TRUE(report.watertight());
  EXPECT_NEAR(report.volume / volume_of_particles(simulation), 1, 0.01);
  EXPECT_NEAR(level_of(mesh, simulation), 1, 0.01);
}

TEST(VolumeOfTheFluid, IsKeptBySurfaceAndLevelWhenADamBreakHasComeToRest) {
  SimulationOptions options;
  options.viscosity = 0.5;  // comes to rest within seconds
  Simulation simulation(make_scene(SceneKind::dam_break, 1500), options, Device::cpu(2));
  for (int frame = 0; frame < 300; ++frame) simulation.step(kFrame);
  expect_within_one_percent_at_rest(simulation, 0.25);
}

TEST(VolumeOfTheFluid, IsKeptBySurfaceAndLevelOfAPoolAtRest) {
  Scene scene = make_scene(SceneKind::stir, 3000);
  scene.kind = SceneKind::dam_break;  // the pool without its force
  Simulation simulation(scene, {}, Device::cpu(2));
  for (int frame = 0; frame < 90; ++frame) simulation.step(kFrame);
  expect_within_one_percent_at_rest(simulation, 0.5);
}

TEST(VolumeOfTheFluid, IsThatOfTheParticlesInTheFirstFrame) {
  for (const SceneKind kind : all_scenes()) {
    SCOPED_TRACE(name_of(kind));
    Simulation simulation(make_scene(kind, 20'000), {}, Device::cpu(2));
    Mesh mesh;
    simulation.surface({}, mesh);
    EXPECT_NEAR(measure(mesh).volume / volume_of_particles(simulation), 1, 0.01);
  }
}

TEST(SurfaceOfTheFluid, LiesOnTheWallsThatTheWaterTouches) {
  Simulation simulation(make_scene(SceneKind::dam_break, 3000), {}, Device::cpu(2));
  for (int frame = 0; frame < 20; ++frame) simulation.step(kFrame);
  Mesh mesh;
  simulation.surface({}, mesh);
  const Vec3f tank = simulation.scene().tank;
  const float rounding = 1e-5F;
  std::int64_t on_the_floor = 0;
  std::int64_t on_the_sides = 0;
  for (std::size_t i = 0; i < mesh.vertices.size(); ++i) {
    const Vec3f v = mesh.vertices[i];
    ASSERT_TRUE(v.x > -rounding && v.y > -rounding && v.z > -rounding) << i;
    ASSERT_TRUE(v.x < tank.x + rounding && v.y < tank.y + rounding && v.z < tank.z + rounding) << i;
    on_the_floor += v.y < rounding ? 1 : 0;
    if (v.z > rounding && v.z < tank.z - rounding) continue;
    ++on_the_sides;
    EXPECT_NEAR(mesh.attributes[2].values.at(i), 0, 1e-3) << "water runs through the wall at vertex " << i;
  }
  const double cell = 0.25 * double{simulation.scene().spacing};
  EXPECT_GT(static_cast<double>(on_the_floor) * cell * cell, 0.8 * 0.8 * 0.9);  // the block's foot, which only grows
  EXPECT_GT(static_cast<double>(on_the_sides) * cell * cell, 2 * 0.8 * 0.6 * 0.9);
}

}  // namespace
}  // namespace pointskin::simulation
