// Walls that particles touch: images of particles, and surfaces that end there.
#include <gtest/gtest.h>

#include <pointskin/mesh.hpp>

#include <cstdint>
#include <vector>

#include "core/array_view.hpp"
#include "exec/cpu.hpp"
#include "exec/cpu_primitives.hpp"
#include "fluid/surface.hpp"
#include "fluid/walls.hpp"

namespace pointskin::test {
namespace {

template <class T>
ArrayView<const T> view_of(const std::vector<T>& values) {
  return {values.data(), static_cast<std::int64_t>(values.size())};
}

TypedView typed_view_of(const std::vector<float>& values) {
  return {AttributeType::float32, values.data(), nullptr, static_cast<std::int64_t>(values.size())};
}

TEST(Images, AreAsManyAsTheSetsOfWallsNearAParticleAndTurnVectors) {
  exec::Cpu ex(2);
  const std::vector<Vec3f> positions{{0.5F, 1, 1.5F}, {0.125F, 1, 1.5F}, {0.875F, 0.25F, 2.75F}};
  const std::vector<float> along_x{1, 2, 3};
  const std::vector<float> mass{4, 5, 6};
  fluid::Particles particles{view_of(positions)};
  particles.walls = Bounds{{0, 0, 0}, {1, 2, 3}};
  particles.values = {{"vx", typed_view_of(along_x), 0}, {"mass", typed_view_of(mass)}};
  const fluid::MirroredParticles all = fluid::add_images(ex, particles, 0.375F);
  const std::vector<Vec3f> expected{
      {0.5F, 1, 1.5F},         {0.125F, 1, 1.5F},       {0.875F, 0.25F, 2.75F},  // themselves
      {-0.125F, 1, 1.5F},                                                        // of the second
      {0.875F, -0.25F, 2.75F}, {0.875F, -0.25F, 3.25F}, {0.875F, 0.25F, 3.25F},  // of the third
      {1.125F, -0.25F, 2.75F}, {1.125F, -0.25F, 3.25F}, {1.125F, 0.25F, 2.75F}, {1.125F, 0.25F, 3.25F}};
  ASSERT_EQ(all.positions.size(), static_cast<std::int64_t>(expected.size()));
  for (std::size_t i = 0; i < expected.size(); ++i) {
    const Vec3f p = all.positions.data()[i];
    EXPECT_TRUE(p.x == expected[i].x && p.y == expected[i].y && p.z == expected[i].z)
        << i << ": " << p.x << ' ' << p.y << ' ' << p.z;
  }
  const std::vector<float> turned{1, 2, 3, -2, 3, 3, 3, -3, -3, -3, -3};
  const std::vector<float> kept{4, 5, 6, 5, 6, 6, 6, 6, 6, 6, 6};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_EQ(all.values[0].data()[i], turned[i]) << i;
    EXPECT_EQ(all.values[1].data()[i], kept[i]) << i;
  }
}

/// The surface of particles at the middles of the unit cells of a box of which all but the highest `empty` layers hold
/// some.
Mesh surface_of_full_box(int empty, FluidOptions options) {
  exec::Cpu ex(2);
  std::vector<Vec3f> positions;
  for (int x = 0; x < 12; ++x)
    for (int y = 0; y < 9 - empty; ++y)
      for (int z = 0; z < 10; ++z)
        positions.push_back({static_cast<float>(x) + 3.5F, static_cast<float>(y) - 6.5F, static_cast<float>(z) + 0.5F});
  fluid::Particles particles{view_of(positions)};
  particles.walls = Bounds{{3, -7, 0}, {15, 2, 10}};
  options.particle_radius = 0.5;
  FluidReport report;
  const fluid::FluidSurface made = fluid::make_surface(ex, particles, options, report);
  EXPECT_EQ(report.particles, static_cast<std::int64_t>(positions.size()));
  Mesh mesh;
  mesh.vertices.assign(made.mesh.positions.data(), made.mesh.positions.data() + made.mesh.positions.size());
  mesh.triangles.assign(made.mesh.triangles.data(), made.mesh.triangles.data() + made.mesh.triangles.size());
  return mesh;
}

TEST(WalledSurface, OfAFullBoxIsTheBox) {
  for (const FluidKernel kernel : {FluidKernel::isotropic, FluidKernel::anisotropic})
    for (const double cube_size : {0.5, 0.3, 1.0}) {
      SCOPED_TRACE(cube_size);
      FluidOptions options;
      options.kernel = kernel;
      options.cube_size = cube_size;
      const Mesh mesh = surface_of_full_box(0, options);
      const MeshReport report = measure(mesh);
      EXPECT_TRUE(report.watertight());
      EXPECT_EQ(report.components, 1);
      const double cell = 0.5 * cube_size;
      const double edges = 4 * (12 + 9 + 10);
      EXPECT_LE(report.volume, 12 * 9 * 10 + 0.01);
      EXPECT_GE(report.volume, 12 * 9 * 10 - edges * cell * cell);  // an edge may lose a cell
      for (const Vec3f& v : mesh.vertices) {
        ASSERT_TRUE(v.x > 3 - 1e-4F && v.x < 15 + 1e-4F) << v.x;
        ASSERT_TRUE(v.y > -7 - 1e-4F && v.y < 2 + 1e-4F) << v.y;
        ASSERT_TRUE(v.z > -1e-4F && v.z < 10 + 1e-4F) << v.z;
      }
    }
}

TEST(WalledSurface, MeetsTheWallsAtRightAngles) {
  const Mesh mesh = surface_of_full_box(4, {});
  EXPECT_TRUE(measure(mesh).watertight());
  // Without images the rim would sink by half a spacing and more towards the walls.
  double low = 1e9;
  double high = -1e9;
  for (const Vec3f& v : mesh.vertices) {
    if (v.y < -3 || v.x < 3.3F || v.x > 14.7F || v.z < 0.3F || v.z > 9.7F) continue;
    low = v.y < low ? v.y : low;
    high = v.y > high ? v.y : high;
  }
  EXPECT_NEAR(high, -2, 0.1);  // five layers from -7
  EXPECT_NEAR(low, high, 0.05);
}

}  // namespace
}  // namespace pointskin::test
