// The band around a surface of particles against a grid that is evaluated everywhere.
#include "exec/cpu_primitives.hpp"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <vector>

#include "fluid/sorted_particles.hpp"
#include "support/particles.hpp"
#include "support/spaces.hpp"

namespace pointskin::test {
namespace {

constexpr std::uint64_t kSeed = 4711;

struct Frame {
  fluid::FluidFrame frame;
  fluid::SortedParticles sorted;
  fluid::ZhuBridsonField field;
};

Frame prepare(exec::Cpu& ex, const Cloud& cloud, const FluidOptions& options) {
  Frame f;
  f.frame = fluid::fit_frame(bounds_of(cloud.positions), options);
  const ArrayView<const Vec3f> positions{cloud.positions.data(), cloud.size()};
  f.sorted = fluid::sort_particles(ex, {positions}, f.frame);
  f.field = fluid::isotropic_field(f.sorted, f.frame, options);
  return f;
}

/// Edges between neighbouring corners of a grid over the whole cube whose ends have different signs.
template <class Field>
std::int64_t crossed_edges_of_grid(exec::Cpu& ex, const Field& field, int depth) {
  const std::int64_t side = (std::int64_t{1} << depth) + 1;
  std::vector<std::uint8_t> inside(static_cast<std::size_t>(side * side * side));
  const float width = 1.0F / static_cast<float>(1 << depth);
  ex.run_blocks(side, [&](std::int64_t x) {
    for (std::int64_t y = 0; y < side; ++y)
      for (std::int64_t z = 0; z < side; ++z)
        inside[static_cast<std::size_t>((x * side + y) * side + z)] =
            field.at({static_cast<float>(x) * width, static_cast<float>(y) * width, static_cast<float>(z) * width}) >=
            0;
  });
  std::int64_t crossed = 0;
  for (std::int64_t x = 0; x < side; ++x)
    for (std::int64_t y = 0; y < side; ++y)
      for (std::int64_t z = 0; z < side; ++z) {
        const std::size_t i = static_cast<std::size_t>((x * side + y) * side + z);
        if (x + 1 < side) crossed += inside[i] != inside[i + static_cast<std::size_t>(side * side)];
        if (y + 1 < side) crossed += inside[i] != inside[i + static_cast<std::size_t>(side)];
        if (z + 1 < side) crossed += inside[i] != inside[i + 1];
      }
  return crossed;
}

TEST(FluidBand, LosesNoCrossingOfADenseGrid) {
  exec::Cpu ex(2);
  for (const NamedParticles& frame : particle_frames(kSeed))
    for (const double cube_size : {0.6, 1.0, 1.7}) {
      SCOPED_TRACE(::testing::Message() << frame.name << ", cube size " << cube_size);
      FluidOptions options;
      options.particle_radius = 1;
      options.cube_size = cube_size;
      const Frame f = prepare(ex, frame.cloud, options);
      if (f.frame.depth > 7) continue;
      const fluid::Band band = fluid::find_isotropic_band(ex, f.sorted, f.frame, options);
      const surface::Surface mesh = surface::extract_surface(ex, band.field(), {.curvature = 0, .normals = false});
      EXPECT_EQ(mesh.positions.size(), crossed_edges_of_grid(ex, f.field, f.frame.depth));
    }
}

TEST(FluidBand, LosesNoCrossingOfEllipsoids) {
  exec::Cpu ex(2);
  for (const NamedParticles& frame : particle_frames(kSeed))
    for (const double cube_size : {0.6, 1.0, 1.7}) {
      SCOPED_TRACE(::testing::Message() << frame.name << ", cube size " << cube_size);
      FluidOptions options;
      options.particle_radius = 1;
      options.cube_size = cube_size;
      options.kernel = FluidKernel::anisotropic;
      const Frame f = prepare(ex, frame.cloud, options);
      if (f.frame.depth > 6) continue;
      const fluid::Ellipsoids ellipsoids = fluid::ellipsoids_of(ex, f.sorted, f.frame, options);
      const fluid::AnisotropicField field = fluid::anisotropic_field(ellipsoids, f.frame, options);
      const fluid::Band band = fluid::find_anisotropic_band(ex, field, f.frame, options);
      const surface::Surface mesh = surface::extract_surface(ex, band.field(), {.curvature = 0, .normals = false});
      EXPECT_EQ(mesh.positions.size(), crossed_edges_of_grid(ex, field, f.frame.depth));
      for (std::int64_t i = 0; i < ellipsoids.centres.size(); ++i) {
        const fluid::Ellipsoid& e = ellipsoids.ellipsoids.data()[i];
        ASSERT_TRUE(e.xx >= 0.99F && e.yy >= 0.99F && e.zz >= 0.99F) << "reaches beyond the kernel's radius";
      }
    }
}

TEST(FluidBand, HoldsTheFieldsValuesBitForBit) {
  exec::Cpu ex(2);
  for (const NamedParticles& frame : particle_frames(kSeed)) {
    SCOPED_TRACE(frame.name);
    FluidOptions options;
    options.particle_radius = 1;
    options.cube_size = 0.8;
    const Frame f = prepare(ex, frame.cloud, options);
    const fluid::Band band = fluid::find_isotropic_band(ex, f.sorted, f.frame, options);
    const octree::LevelView level = band.fine.view();
    for (std::int32_t n = 0; n < level.nodes(); ++n) {
      const octree::Coordinates c = octree::decode(level.node_key(n));
      const float width = 1.0F / static_cast<float>(1 << level.depth);
      ASSERT_EQ(band.fine.values.data()[n],
                f.field.at({static_cast<float>(c.x) * width, static_cast<float>(c.y) * width,
                            static_cast<float>(c.z) * width}))
          << n;
    }
    const fluid::Ellipsoids ellipsoids = fluid::ellipsoids_of(ex, f.sorted, f.frame, options);
    options.kernel = FluidKernel::anisotropic;
    const fluid::AnisotropicField field = fluid::anisotropic_field(ellipsoids, f.frame, options);
    const fluid::Band other = fluid::find_anisotropic_band(ex, field, f.frame, options);
    const octree::LevelView fine = other.fine.view();
    for (std::int32_t n = 0; n < fine.nodes(); ++n) {
      const octree::Coordinates c = octree::decode(fine.node_key(n));
      const float width = 1.0F / static_cast<float>(1 << fine.depth);
      ASSERT_EQ(other.fine.values.data()[n], field.at({static_cast<float>(c.x) * width, static_cast<float>(c.y) * width,
                                                       static_cast<float>(c.z) * width}))
          << n;
    }
  }
}

TEST(FluidBand, IsCompleteFromASingleCellOn) {
  // Nothing is doubtful, so the search misses cells, and rounds must find them.
  exec::Cpu ex(2);
  const Cloud ball = ball_of_particles(1, 9, 0.3, kSeed);
  FluidOptions options;
  options.particle_radius = 1;
  options.cube_size = 0.8;
  const Frame f = prepare(ex, ball, options);
  fluid::BandOptions band_options;
  band_options.depth = f.frame.depth;
  band_options.doubt = 0;
  const fluid::Band band = fluid::find_band(ex, f.field, f.field.tree, f.field.positions, band_options);
  const surface::Surface mesh = surface::extract_surface(ex, band.field(), {.curvature = 0, .normals = false});
  EXPECT_EQ(mesh.positions.size(), crossed_edges_of_grid(ex, f.field, f.frame.depth));
}

TEST(FluidBand, DoesNotEvaluateWhatIsDeep) {
  exec::Cpu ex(2);
  FluidOptions options;
  options.particle_radius = 1;
  options.cube_size = 1;
  const Cloud large = lattice_particles(1, 60, 0.1, kSeed, [](const Vec3d&) { return true; });
  const Frame f = prepare(ex, large, options);
  const fluid::Band band = fluid::find_isotropic_band(ex, f.sorted, f.frame, options);
  const double whole = std::pow(122.0 / 2, 3);  // coarse corners in the block, without those around it
  EXPECT_LT(static_cast<double>(band.coarse_corners), 0.8 * whole);
  EXPECT_EQ(band.rounds, 0);
}

TEST(LargestEigenvalue, IsThatOfDiagonalsAndNeverAbove) {
  const auto of = [](float a, float b, float c) { return fluid::largest_eigenvalue({a, 0, 0, b, 0, c}); };
  EXPECT_FLOAT_EQ(of(2, 0, 0), 2);
  EXPECT_FLOAT_EQ(of(1, 1, 1), 1);
  EXPECT_EQ(of(0, 0, 0), 0);
  for (const float second : {0.0F, 0.3F, 0.6F, 0.8F, 0.9F, 1.0F}) {
    EXPECT_LE(of(1, second, second), 1.000001F);
    EXPECT_GE(of(1, second, second), 0.94F) << second;
  }
  // Turned by 45 degrees about z: eigenvalues 3, 1, 2.
  EXPECT_NEAR(fluid::largest_eigenvalue({2, 1, 0, 2, 0, 2}), 3, 0.05);
}

TEST(FluidFrame, HasCellsOfExactlyTheAskedWidth) {
  FluidOptions options;
  options.particle_radius = 0.025;
  options.cube_size = 0.7;
  for (const float side : {0.0F, 1.0F, 17.3F}) {
    const fluid::FluidFrame frame = fluid::fit_frame({{-1, 2, 3}, {-1 + side, 2, 3.5F}}, options);
    EXPECT_DOUBLE_EQ(frame.cube.size / std::ldexp(1.0, frame.depth), 0.7 * 0.025);
    for (std::size_t a = 0; a < 3; ++a) {
      const double steps = frame.cube.lower[a] / (4 * 0.7 * 0.025);
      EXPECT_NEAR(steps, std::round(steps), 1e-9);
    }
    EXPECT_LT(frame.cube.lower[0], -1 - 0.1);
    EXPECT_GT(frame.cube.lower[0] + frame.cube.size, -1 + static_cast<double>(side) + 0.1);
  }
}

}  // namespace
}  // namespace pointskin::test
