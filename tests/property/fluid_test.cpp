// Surfaces of particles through the public interface: closed whatever the particles, and as large as they are.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <numeric>
#include <random>
#include <vector>

#include <pointskin/error.hpp>
#include <pointskin/fluid.hpp>
#include <pointskin/io.hpp>

#include "support/attributes.hpp"
#include "support/particles.hpp"

namespace pointskin::test {
namespace {

constexpr std::uint64_t kSeed = 90210;
constexpr double kPi = 3.14159265358979323846;

FluidOptions options_of(double particle_radius, double cube_size = 0.75) {
  FluidOptions options;
  options.particle_radius = particle_radius;
  options.cube_size = cube_size;
  return options;
}

Mesh surface_of(const Cloud& cloud, const FluidOptions& options, int threads = 2) {
  return FluidSurfacer(Device::cpu(threads)).surface(cloud, options);
}

MeshReport expect_watertight(const Mesh& mesh) {
  const MeshReport report = measure(mesh);
  EXPECT_TRUE(report.closed());
  EXPECT_TRUE(report.manifold());
  EXPECT_TRUE(report.oriented());
  EXPECT_GT(report.volume, 0);
  return report;
}

class FluidKernels : public ::testing::TestWithParam<FluidKernel> {
 protected:
  static FluidOptions options(double particle_radius, double cube_size = 0.75) {
    FluidOptions result = options_of(particle_radius, cube_size);
    result.kernel = GetParam();
    return result;
  }
};
INSTANTIATE_TEST_SUITE_P(All, FluidKernels, ::testing::Values(FluidKernel::isotropic, FluidKernel::anisotropic));

TEST_P(FluidKernels, AreWatertightWhateverTheParticles) {
  for (const NamedParticles& frame : particle_frames(kSeed))
    for (const double cube_size : {0.5, 1.0, 2.0})
      for (const int smoothing : {0, 5}) {
        SCOPED_TRACE(::testing::Message() << frame.name << ", cube size " << cube_size);
        FluidOptions chosen = options(1, cube_size);
        chosen.smoothing_iterations = smoothing;
        Mesh mesh;
        try {
          mesh = surface_of(frame.cloud, chosen);
        } catch (const Error& error) {  // drops that lie between the corners of large cells
          EXPECT_EQ(error.code(), ErrorCode::empty_result);
          EXPECT_GT(cube_size, 1.1);
          continue;
        }
        expect_watertight(mesh);
      }
}

TEST_P(FluidKernels, KeepTheVolumeOfABall) {
  const Cloud ball = ball_of_particles(0.01, 0.25, 0.2, kSeed);
  const double rest = static_cast<double>(ball.size()) * std::pow(0.02, 3);
  const MeshReport report = expect_watertight(surface_of(ball, options(0.01)));
  // The centres of ellipsoids move inwards, farther where the surface is curved.
  EXPECT_NEAR(report.volume / rest, 1, GetParam() == FluidKernel::isotropic ? 0.05 : 0.07);
  EXPECT_EQ(report.components, 1);
  EXPECT_EQ(report.euler, 2);
}

TEST_P(FluidKernels, DoNotDependOnTheOrderOfParticlesOrThreads) {
  Cloud cloud = particle_frames(kSeed).back().cloud;
  std::vector<float> weights(cloud.positions.size());
  std::iota(weights.begin(), weights.end(), 0.0F);
  std::vector<std::int32_t> ids(weights.begin(), weights.end());
  cloud.attributes = {{"weight", std::move(weights)}, {"id", std::move(ids)}};
  FluidOptions chosen = options(1);
  chosen.smoothing_iterations = 3;
  const Mesh first = surface_of(cloud, chosen, 1);
  std::vector<std::int64_t> order(cloud.positions.size());
  std::iota(order.begin(), order.end(), 0);
  std::shuffle(order.begin(), order.end(), std::mt19937(1));
  Cloud shuffled = cloud;
  for (std::size_t i = 0; i < order.size(); ++i)
    shuffled.positions[i] = cloud.positions[static_cast<std::size_t>(order[i])];
  for (Attribute& a : shuffled.attributes) a.values = a.values.gather(order);
  for (const int threads : {1, 2, 5}) {
    const Mesh again = surface_of(shuffled, chosen, threads);
    EXPECT_TRUE(again.vertices == first.vertices);
    EXPECT_TRUE(again.normals == first.normals);
    EXPECT_TRUE(again.triangles == first.triangles);
    for (std::size_t a = 0; a < first.attributes.size(); ++a)
      EXPECT_TRUE(test::same_bytes(again.attributes[a].values, first.attributes[a].values));
  }
}

TEST(Fluid, ASingleParticleIsABall) {
  Cloud cloud;
  cloud.positions = {{1, 2, 3}};
  const MeshReport report = expect_watertight(surface_of(cloud, options_of(0.5, 0.25)));
  EXPECT_NEAR(report.volume, 4.0 / 3 * kPi * 0.125, 0.02);
  EXPECT_EQ(report.euler, 2);
}

TEST(Fluid, DropsThatAreApartStayApart) {
  const auto components = [](float distance) {
    Cloud cloud;
    cloud.positions = {{0, 0, 0}, {distance, 0, 0}};
    return expect_watertight(surface_of(cloud, options_of(1, 0.4))).components;
  };
  EXPECT_EQ(components(2), 1);
  EXPECT_EQ(components(4.2F), 2);
  EXPECT_EQ(components(5), 2);
  EXPECT_EQ(components(8.5F), 2);
}

TEST(Fluid, NothingFloatsBetweenTwoBodies) {
  // Two blocks, the gap wide enough for the kernel to see both: without damping a sheet hangs between them.
  for (const double gap : {3.0, 4.0, 5.0, 6.0, 7.0}) {
    Cloud cloud = lattice_particles(1, 9, 0.2, kSeed, [](const Vec3d& p) { return p[0] < 0; });
    const auto half = cloud.positions.size();
    float rightmost = -100;
    for (const Vec3f& p : cloud.positions) rightmost = std::max(rightmost, p.x);
    for (std::size_t i = 0; i < half; ++i) {
      const Vec3f p = cloud.positions[i];
      cloud.positions.push_back({2 * rightmost - p.x + 2 + static_cast<float>(gap), p.y, p.z});
    }
    EXPECT_EQ(expect_watertight(surface_of(cloud, options_of(1, 0.5))).components, 2) << gap;
  }
}

TEST(Fluid, AFlatSurfaceLiesOneRadiusAboveTheParticles) {
  const Cloud cloud = lattice_particles(1, 16, 0, kSeed, [](const Vec3d& p) { return p[2] <= 0; });
  const Mesh mesh = surface_of(cloud, options_of(1, 0.5));
  for (const Vec3f& v : mesh.vertices)
    if (std::abs(v.x) < 8 && std::abs(v.y) < 8 && v.z > -8) {
      EXPECT_NEAR(v.z, 1, 0.2);
    }
}

TEST(Fluid, BubblesAreRealUnlessTheyAreSmall) {
  const Cloud cloud =
      lattice_particles(1, 15, 0.1, kSeed, [](const Vec3d& p) { return length(p) < 15 && length(p) > 5; });
  const MeshReport hollow = expect_watertight(surface_of(cloud, options_of(1)));
  EXPECT_EQ(hollow.components, 2);
  FluidOptions options = options_of(1);
  options.min_component = 200;
  FluidSurfacer surfacer(Device::cpu(2));
  const MeshReport filled = expect_watertight(surfacer.surface(cloud, options));
  EXPECT_EQ(filled.components, 1);
  EXPECT_EQ(surfacer.report().removed_components, 1);
  EXPECT_GT(filled.volume, hollow.volume + 200);
}

TEST(Fluid, SmallDropsAreRemoved) {
  Cloud cloud = ball_of_particles(1, 8, 0.2, kSeed);
  for (int i = 0; i < 5; ++i) cloud.positions.push_back({20, 10.0F * static_cast<float>(i), 0});
  FluidSurfacer surfacer(Device::cpu(2));
  FluidOptions options = options_of(1);
  EXPECT_EQ(measure(surfacer.surface(cloud, options)).components, 6);
  EXPECT_EQ(surfacer.report().removed_components, 0);
  options.min_component = 2;
  EXPECT_EQ(expect_watertight(surfacer.surface(cloud, options)).components, 1);
  EXPECT_EQ(surfacer.report().removed_components, 5);
  options.min_component = 1e6;
  EXPECT_THROW(surfacer.surface(cloud, options), Error);
}

TEST(Fluid, AttributesAreMeansOfTheParticlesAround) {
  Cloud cloud = ball_of_particles(1, 8, 0.2, kSeed);
  std::vector<float> gaps(cloud.positions.size(), 3);
  for (std::size_t i = 0; i < gaps.size(); i += 2) gaps[i] = std::numeric_limits<float>::quiet_NaN();
  cloud.attributes = {
      test::attribute_of<float>("vx", cloud.positions, [](const Vec3f& p) { return p.x; }),
      test::attribute_of<std::uint8_t>("red", cloud.positions, [](const Vec3f& p) { return p.x < 0 ? 10 : 250; }),
      {"t", std::move(gaps)}};
  const Mesh mesh = surface_of(cloud, options_of(1));
  ASSERT_EQ(mesh.attributes.size(), 3U);
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    EXPECT_NEAR(mesh.attributes[0].values.at(v), mesh.vertices[v].x, 1.5);
    const double red = mesh.attributes[1].values.at(v);
    EXPECT_TRUE(red >= 10 && red <= 250);
    EXPECT_FLOAT_EQ(mesh.attributes[2].values.as<float>()[v], 3);
  }
  FluidOptions options = options_of(1);
  options.attributes = false;
  options.normals = false;
  const Mesh bare = surface_of(cloud, options);
  EXPECT_TRUE(bare.attributes.empty());
  EXPECT_TRUE(bare.normals.empty());
  EXPECT_TRUE(bare.vertices == mesh.vertices);
}

TEST(Fluid, VerticesBeyondTheRadiusHaveTheValuesOfTheNearestParticle) {
  FluidOptions options = options_of(1);
  options.cube_size = 4;
  options.smoothing_length = 1;
  for (int i = 0; i < 8; ++i) {
    SCOPED_TRACE(i);
    Cloud cloud;
    cloud.positions = {{0.13F * i, 0.31F * i, 0.07F * i * i}, {40, 0, 0}};
    cloud.attributes = {{"heat", std::vector<float>{3, 7}},
                        {"time", std::vector<double>{1e9, 2e9}},
                        {"red", std::vector<std::uint8_t>{30, 200}},
                        {"id", std::vector<std::int32_t>{11, 12}}};
    const Mesh mesh = surface_of(cloud, options);
    float farthest = 0;
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
      const int nearest = mesh.vertices[v].x < 20 ? 0 : 1;
      farthest = std::max(farthest, length(mesh.vertices[v] - cloud.positions[nearest]));
      for (std::size_t a = 0; a < 4; ++a)
        EXPECT_NEAR(mesh.attributes[a].values.at(v) / cloud.attributes[a].values.at(nearest), 1, 1e-6);
    }
    EXPECT_GT(farthest, 2);  // the radius of the kernel
  }
}

TEST(Fluid, LabelsAreThoseOfTheNearestParticleThatHasOne) {
  Cloud cloud = ball_of_particles(1, 6, 0.3, kSeed);
  std::vector<std::int32_t> ids(cloud.positions.size());
  std::iota(ids.begin(), ids.end(), 1'000'000'001);
  cloud.attributes = {{"id", ids}, {"part", ids}, {"none", AttributeValues::missing(AttributeType::int16, ids.size())}};
  for (std::size_t i = 0; i < ids.size(); ++i)
    if (i % 4 != 0) cloud.attributes[1].values.set_missing(i);
  for (const FluidKernel kernel : {FluidKernel::isotropic, FluidKernel::anisotropic}) {
    FluidOptions options = options_of(1);
    options.kernel = kernel;
    const Mesh mesh = surface_of(cloud, options);
    for (std::size_t a = 0; a < 2; ++a) {
      const std::vector<std::int32_t>& labels = mesh.attributes[a].values.as<std::int32_t>();
      for (std::size_t v = 0; v < labels.size(); ++v) {
        const auto distance = [&](std::size_t i) {
          const Vec3f& p = cloud.positions[i];
          return std::hypot(p.x - mesh.vertices[v].x, p.y - mesh.vertices[v].y, p.z - mesh.vertices[v].z);
        };
        float best = std::numeric_limits<float>::infinity();
        for (std::size_t i = 0; i < ids.size(); ++i)
          if (!cloud.attributes[a].values.is_missing(i)) best = std::min(best, distance(i));
        ASSERT_FALSE(mesh.attributes[a].values.is_missing(v));
        const auto chosen = static_cast<std::size_t>(labels[v] - 1'000'000'001);
        ASSERT_FALSE(cloud.attributes[a].values.is_missing(chosen));
        ASSERT_LE(distance(chosen), best + 1e-4F);
      }
    }
    EXPECT_EQ(mesh.attributes[2].values, AttributeValues::missing(AttributeType::int16, mesh.vertices.size()));
  }
}

TEST(Fluid, DoublesAreMeansInTheirOwnRange) {
  Cloud cloud = ball_of_particles(1, 8, 0.2, kSeed);
  const auto time = [](const Vec3f& p) { return 4e8 + 1e-4 * p.x; };
  cloud.attributes = {test::attribute_of<double>("time", cloud.positions, time),
                      test::attribute_of<float>("x", cloud.positions, [](const Vec3f& p) { return p.x; })};
  cloud.attributes[0].values.set_missing(3);
  cloud.attributes[1].values.set_missing(3);
  const Mesh mesh = surface_of(cloud, options_of(1));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v)
    ASSERT_NEAR(mesh.attributes[0].values.at(v), 4e8 + 1e-4 * mesh.attributes[1].values.at(v), 2e-7);
}

TEST(Fluid, NormalsHaveUnitLengthAndPointOutwards) {
  const Mesh mesh = surface_of(ball_of_particles(1, 8, 0.2, kSeed), options_of(1));
  for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
    const Vec3f n = mesh.normals[v];
    const Vec3f p = mesh.vertices[v];
    EXPECT_NEAR(n.x * n.x + n.y * n.y + n.z * n.z, 1, 1e-5);
    EXPECT_GT(n.x * p.x + n.y * p.y + n.z * p.z, 0);
  }
}

TEST(Fluid, SmoothingFlattensTheBulkAndLeavesDrops) {
  Cloud cloud = ball_of_particles(1, 9, 0.3, kSeed);
  cloud.positions.push_back({20, 0, 0});
  const auto roughness = [](const Mesh& mesh) {  // spread of the ball's radius
    double sum = 0;
    double squares = 0;
    int count = 0;
    for (const Vec3f& v : mesh.vertices) {
      if (v.x > 15) continue;
      const double r = length(Vec3d{v.x, v.y, v.z});
      sum += r;
      squares += r * r;
      ++count;
    }
    return std::sqrt(squares / count - sum / count * sum / count);
  };
  const auto drop = [](const Mesh& mesh) {
    float widest = 0;
    for (const Vec3f& v : mesh.vertices)
      if (v.x > 15) widest = std::max(widest, std::abs(v.y));
    return widest;
  };
  FluidOptions options = options_of(1, 0.5);
  const Mesh rough = surface_of(cloud, options);
  options.smoothing_iterations = 25;
  const Mesh smoothed = surface_of(cloud, options);
  EXPECT_LT(roughness(smoothed), 0.8 * roughness(rough));
  EXPECT_NEAR(drop(smoothed), drop(rough), 0.01);
  options.smoothing_weights = false;
  EXPECT_LT(drop(surface_of(cloud, options)), 0.5 * drop(rough));
}

TEST(Fluid, FramesCanFollowEachOther) {
  FluidSurfacer surfacer(Device::cpu(2));
  Mesh mesh;
  std::int64_t peak = 0;
  for (int frame = 0; frame < 5; ++frame) {
    Cloud cloud = ball_of_particles(1, 8, 0.2, kSeed);
    for (Vec3f& p : cloud.positions) p.x += 0.37F * static_cast<float>(frame);
    surfacer.surface(cloud, options_of(1), mesh);
    EXPECT_TRUE(mesh.vertices == surface_of(cloud, options_of(1)).vertices);
    if (frame > 0) {
      EXPECT_LT(surfacer.report().device_peak_bytes, 2 * peak);
    }
    peak = surfacer.report().device_peak_bytes;
  }
}

TEST(Fluid, ErrorsSayWhatIsWrong) {
  const auto code_of = [](const Cloud& cloud, const FluidOptions& options) {
    try {
      surface_of(cloud, options);
    } catch (const Error& error) {
      return error.code();
    }
    return ErrorCode::internal;
  };
  Cloud cloud;
  EXPECT_EQ(code_of(cloud, options_of(1)), ErrorCode::empty_result);
  cloud.positions = {{0, 0, 0}, {1, 0, 0}};
  EXPECT_EQ(code_of(cloud, options_of(0)), ErrorCode::usage);
  EXPECT_EQ(code_of(cloud, options_of(-1)), ErrorCode::usage);
  EXPECT_EQ(code_of(cloud, options_of(std::numeric_limits<double>::quiet_NaN())), ErrorCode::usage);
  EXPECT_EQ(code_of(cloud, options_of(1, 0.01)), ErrorCode::usage);
  EXPECT_EQ(code_of(cloud, options_of(1, 5)), ErrorCode::usage);
  cloud.positions[1].x = 1e7F;
  EXPECT_EQ(code_of(cloud, options_of(1)), ErrorCode::over_limit);
  cloud.positions[1].x = std::numeric_limits<float>::infinity();
  EXPECT_EQ(code_of(cloud, options_of(1)), ErrorCode::invalid_input);
  cloud.positions[1].x = 3;
  cloud.attributes.push_back({"short", std::vector<float>{1}});
  EXPECT_EQ(code_of(cloud, options_of(1)), ErrorCode::invalid_input);
}

TEST(Fluid, FarApartDropsCostNoMoreThanNearOnes) {
  Cloud cloud;
  cloud.positions = {{0, 0, 0}, {3e4F, 2e4F, 1e4F}};  // 2^17 cells apart: bitmaps would take all memory
  const MeshReport report = expect_watertight(surface_of(cloud, options_of(1, 0.5)));
  EXPECT_EQ(report.components, 2);
}

}  // namespace
}  // namespace pointskin::test
