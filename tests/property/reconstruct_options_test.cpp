// Options, errors, and tiny clouds: every call ends with what its header promises or with the promised error.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <limits>
#include <map>
#include <numbers>
#include <string>
#include <utility>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::reconstructed;

// ---- Options

TEST(Options, DensityIsTheNumberOfSamplesPerArea) {
  const std::int64_t n = 60'000;
  const Mesh mesh = reconstructed(test::sphere_cloud(n, 1, 3), {{.depth = 7}, {.density = true}});
  ASSERT_EQ(mesh.attributes.size(), 1U);
  EXPECT_EQ(mesh.attributes[0].name, "density");
  ASSERT_EQ(mesh.attributes[0].values.size(), mesh.vertices.size());
  const double truth = static_cast<double>(n) / (4 * std::numbers::pi * 9);
  double mean = 0;
  std::int64_t off = 0;
  for (const float value : mesh.attributes[0].values.as<float>()) {
    mean += value / static_cast<double>(mesh.vertices.size());
    off += std::abs(value - truth) > 0.5 * truth ? 1 : 0;
  }
  EXPECT_NEAR(mean, truth, 0.2 * truth);
  EXPECT_LT(off, static_cast<std::int64_t>(mesh.vertices.size()) / 20);
}

TEST(Options, DensityIsLeftOutUnlessAskedFor) {
  EXPECT_TRUE(reconstructed(test::sphere_cloud(1000, 2), {{.depth = 5}}).attributes.empty());
}

Cloud with_normals_times(Cloud cloud, float factor) {
  for (Vec3f& n : cloud.normals) n = {factor * n.x, factor * n.y, factor * n.z};
  return cloud;
}

TEST(Options, LengthsOfNormalsDoNotMatterWithoutConfidence) {
  const Cloud cloud = test::torus_cloud(5'000, 3);
  expect_same_bytes(reconstructed(cloud, {{.depth = 6}}), reconstructed(with_normals_times(cloud, 4), {{.depth = 6}}));
}

TEST(Options, ACommonLengthOfAllNormalsKeepsTheSurfaceWithConfidence) {
  const Cloud cloud = test::torus_cloud(5'000, 4);
  const Options options{{.depth = 6, .confidence = true}};
  const Mesh once = reconstructed(cloud, options);
  const Mesh twice = reconstructed(with_normals_times(cloud, 2), options);  // a power of two: exact
  EXPECT_EQ(once.triangles, twice.triangles);
  EXPECT_EQ(once.vertices, twice.vertices);
}

TEST(Options, ConfidenceLetsShortNormalsCountLess) {
  Cloud cloud = test::sphere_cloud(10'000, 5);
  test::append(cloud, with_normals_times(test::sphere_cloud(10'000, 6, 1.2), 0.01F));  // a doubtful shell around it
  const double without = measure(reconstructed(cloud, {{.depth = 5}})).volume;
  const double with = measure(reconstructed(cloud, {{.depth = 5, .confidence = true}})).volume;
  const double inner = 4 * std::numbers::pi / 3;
  EXPECT_LT(std::abs(with - inner), std::abs(without - inner));
}

TEST(Options, MoreScreeningComesCloserToTheSamples) {
  const Cloud cloud = test::box_cloud(40'000, 7);  // sharp edges, which the unscreened problem rounds
  double last = 1e9;
  for (const double screening : {0.0, 2.0, 20.0}) {
    Reconstructor r(Device::cpu(2));
    const Field field = r.solve(cloud, {.depth = 6, .screening = screening, .iterations = 30});
    std::vector<Vec3d> at;
    for (const Vec3f& p : cloud.positions) at.push_back({p.x, p.y, p.z});
    double sum = 0;
    for (const float value : field.values(at)) sum += std::pow(value - field.isovalue(), 2);
    const double rms = std::sqrt(sum / static_cast<double>(cloud.size()));
    EXPECT_LT(rms, last) << "screening " << screening;
    last = rms;
  }
}

std::vector<std::array<std::int32_t, 2>> boundary_edges(const Mesh& mesh) {
  std::map<std::array<std::int32_t, 2>, int> uses;
  for (const Triangle& t : mesh.triangles)
    for (std::size_t k = 0; k < 3; ++k) ++uses[{std::min(t[k], t[(k + 1) % 3]), std::max(t[k], t[(k + 1) % 3])}];
  std::vector<std::array<std::int32_t, 2>> edges;
  for (const auto& [edge, count] : uses)
    if (count == 1) edges.push_back(edge);
  return edges;
}

TEST(Options, APlaneIsCappedByAClosedCubeAndEndsAtTheFacesOfAnOpenOne) {
  const Cloud cloud = test::plane_cloud(20'000, 8);
  for (const int depth : {4, 6, 7}) {
    const MeshReport closed = measure(reconstructed(cloud, {{.depth = depth}}));
    EXPECT_TRUE(closed.watertight()) << "depth " << depth;
    const Options open_options{{.depth = depth}, {.domain_faces = DomainFaces::open}};
    const Mesh open = reconstructed(cloud, open_options);
    const MeshReport report = measure(open);
    EXPECT_TRUE(report.manifold() && report.oriented()) << "depth " << depth;
    EXPECT_GT(report.boundary_edges, 0) << "depth " << depth;
    const Field field = Reconstructor(Device::cpu(1)).solve(cloud, open_options, {});
    const Vec3d lower = field.cube_lower_world();
    const double size = field.cube_size_world();
    for (const auto& edge : boundary_edges(open)) {
      bool on_face = false;
      const Vec3f& p = open.vertices[static_cast<std::size_t>(edge[0])];
      const Vec3f& q = open.vertices[static_cast<std::size_t>(edge[1])];
      const std::array<std::array<double, 2>, 3> ends{{{p.x, q.x}, {p.y, q.y}, {p.z, q.z}}};
      for (std::size_t a = 0; a < 3; ++a)
        for (const double face : {lower[a], lower[a] + size})
          on_face = on_face || (std::abs(ends[a][0] - face) < 1e-5 && std::abs(ends[a][1] - face) < 1e-5);
      ASSERT_TRUE(on_face) << "depth " << depth;
    }
  }
}

TEST(Options, LinearFitChangesPositionsButNotTopology) {
  const Cloud cloud = test::torus_cloud(10'000, 9);
  const Mesh quadratic = reconstructed(cloud, {{.depth = 6}});
  const Mesh linear = reconstructed(cloud, {{.depth = 6}, {.linear_fit = true}});
  EXPECT_EQ(quadratic.triangles.size(), linear.triangles.size());
  EXPECT_EQ(quadratic.vertices.size(), linear.vertices.size());
  EXPECT_EQ(measure(quadratic).euler, measure(linear).euler);
  EXPECT_NE(quadratic.vertices, linear.vertices);
}

/// Root mean square of | |v| - 1 | over the vertices.
double rms_off_unit_sphere(const Mesh& mesh) {
  double squares = 0;
  for (const Vec3f& v : mesh.vertices) {
    const double off = std::sqrt(double{v.x} * v.x + double{v.y} * v.y + double{v.z} * v.z) - 1;
    squares += off * off;
  }
  return std::sqrt(squares / static_cast<double>(mesh.vertices.size()));
}

TEST(Options, ScreeningThatFollowsTheNoiseIsNearerToCleanAndToNoisySpheres) {
  const Cloud clean = test::sphere_cloud(40'000, 21);
  Cloud noisy = clean;
  test::Random random(22);
  for (std::size_t i = 0; i < noisy.positions.size(); ++i) {
    const auto out = static_cast<float>(1 + random.in(-0.01, 0.01));  // 0.6 of a cell
    Vec3f& p = noisy.positions[i];
    p = {p.x * out, p.y * out, p.z * out};
  }
  for (const Cloud* cloud : {&clean, const_cast<const Cloud*>(&noisy)}) {
    const double fixed = rms_off_unit_sphere(reconstructed(*cloud, {{.depth = 7, .fixed_screening = true}}));
    const double adaptive = rms_off_unit_sphere(reconstructed(*cloud, {{.depth = 7}}));
    EXPECT_LT(adaptive, 0.95 * fixed) << (cloud == &clean ? "clean" : "noisy");
  }
}

TEST(Options, ScaleIsTheRatioOfTheCubeToTheBoundingCube) {
  Cloud cloud = test::box_cloud(1000, 10);
  cloud.positions.push_back({-1, -1, -1});
  cloud.positions.push_back({1, 1, 1});
  cloud.normals.push_back({-1, 0, 0});
  cloud.normals.push_back({1, 0, 0});
  cloud.origin = {100, 200, -300};
  for (const double scale : {1.0, 1.1, 3.0}) {
    const Field field = Reconstructor(Device::cpu(1)).solve(cloud, {.depth = 4, .scale = scale});
    EXPECT_NEAR(field.cube_size_world(), 2 * scale, 1e-6);
    for (std::size_t a = 0; a < 3; ++a) EXPECT_NEAR(field.cube_lower_world()[a], cloud.origin[a] - scale, 1e-5);
  }
}

TEST(Options, ProgressRisesThroughAllPhasesAndMayCancelAtEachOfThem) {
  const Cloud cloud = test::sphere_cloud(2'000, 11);
  std::vector<std::string> phases;
  double last = 0;
  Options options{{.depth = 6}};
  options.progress = [&](const Progress& p) {
    EXPECT_GE(p.fraction, last);
    EXPECT_LE(p.fraction, 1);
    last = p.fraction;
    if (phases.empty() || phases.back() != p.phase) phases.emplace_back(p.phase);
    return true;
  };
  Reconstructor r(Device::cpu(2));
  const Mesh expected = r.reconstruct(cloud, options);
  EXPECT_EQ(phases, (std::vector<std::string>{"octree", "splat", "solve", "extract"}));
  for (const std::string& stop : phases) {
    options.progress = [&](const Progress& p) { return p.phase != stop; };
    EXPECT_EQ(error_of([&] { (void)r.reconstruct(cloud, options); }), ErrorCode::interrupted) << stop;
  }
  options.progress = nullptr;
  expect_same_bytes(expected, r.reconstruct(cloud, options));
}

TEST(Options, LevelsThatTheSamplesDoNotResolveHaveNoUnknowns) {
  Reconstructor r(Device::cpu(2));
  const Mesh mesh = r.reconstruct(test::sphere_cloud(5'000, 12), {{.depth = 9}, {}, {.residuals = true}});
  EXPECT_GT(r.report().levels[5].unknowns, 0);
  EXPECT_EQ(r.report().levels[8].unknowns, 0);
  EXPECT_EQ(r.report().levels[9].unknowns, 0);
  EXPECT_TRUE(measure(mesh).watertight());
  // About as many vertices as samples, not the thirty times more that the cells of level 9 would give.
  EXPECT_LT(mesh.vertices.size(), 20'000U);
}

TEST(Options, ResidualsAreMeasuredWhenAskedFor) {
  Reconstructor r(Device::cpu(2));
  (void)r.reconstruct(test::sphere_cloud(40'000, 12), {{.depth = 7}, {}, {.residuals = true}});
  ASSERT_EQ(r.report().levels.size(), 8U);
  for (const LevelReport& level : r.report().levels) {
    EXPECT_GT(level.unknowns, 0);
    EXPECT_GT(level.residual_before, 0) << level.depth;
    EXPECT_LT(level.residual_after, level.residual_before) << level.depth;
  }
  EXPECT_EQ(r.report().points, 40'000);
  EXPECT_EQ(r.report().depth, 7);
  EXPECT_GT(r.report().device_peak_bytes, 0);
  EXPECT_NEAR(r.report().isovalue, 0.5, 0.05);
}

TEST(Options, MemoryEstimatesFromCountsHold) {
  for (const int depth : {5, 7, 9})
    for (const std::int64_t n : {2'000, 100'000}) {
      Reconstructor r(Device::cpu(2));
      const Options options{{.depth = depth}};
      (void)r.reconstruct(test::sphere_cloud(n, 13), options);
      EXPECT_LE(r.report().device_peak_bytes, estimate_device_bytes(n, options)) << "depth " << depth << ", " << n;
    }
}

TEST(FieldValues, AreAboveTheIsovalueInsideAndBelowItOutside) {
  const Cloud cloud = test::torus_cloud(30'000, 15);
  const Field field = Reconstructor(Device::cpu(2)).solve(cloud, {.depth = 7});
  std::vector<Vec3d> inside;
  std::vector<Vec3d> outside{{0, 0, 0}, {1.45, 0, 0}, {0, 0, 0.4}, {50, 0, 0}, {-1e9, 1e9, 3}};
  for (int i = 0; i < 100; ++i) {
    const double angle = 2 * std::numbers::pi * i / 100;
    inside.push_back({std::cos(angle), std::sin(angle), 0});
    outside.push_back({std::cos(angle), std::sin(angle), 0.45});
  }
  for (const float value : field.values(inside)) EXPECT_GT(value, field.isovalue() + 0.2);
  for (const float value : field.values(outside)) EXPECT_LT(value, field.isovalue() - 0.2);
  EXPECT_TRUE(field.values({}).empty());
}

TEST(FieldValues, AreTheIsovalueAtTheVerticesUpToTheFit) {
  Reconstructor r(Device::cpu(2));
  const Field field = r.solve(test::sphere_cloud(30'000, 16), {.depth = 6});
  const Mesh mesh = field.extract({.linear_fit = true});
  std::vector<Vec3d> at;
  for (const Vec3f& v : mesh.vertices) at.push_back({v.x, v.y, v.z});
  for (const float value : field.values(at)) ASSERT_NEAR(value, field.isovalue(), 0.005);
}

// ---- Errors

ErrorCode reconstruct_error(const Cloud& cloud, const Options& options = {{.depth = 6}}) {
  return error_of([&] { (void)reconstructed(cloud, options); }).value_or(ErrorCode{0});
}

Cloud cloud_of(std::vector<Vec3f> positions, std::vector<Vec3f> normals) {
  Cloud cloud;
  cloud.positions = std::move(positions);
  cloud.normals = std::move(normals);
  return cloud;
}

TEST(Errors, NameWhatIsMissing) {
  EXPECT_EQ(reconstruct_error({}), ErrorCode::empty_result);
  EXPECT_EQ(reconstruct_error(cloud_of({{0, 0, 0}, {1, 1, 1}}, {})), ErrorCode::no_normals);
  EXPECT_EQ(reconstruct_error(cloud_of({{0, 0, 0}, {1, 1, 1}}, {{0, 0, 1}})), ErrorCode::no_normals);
  EXPECT_EQ(reconstruct_error(cloud_of({{0, 0, 0}, {1, 1, 1}}, {{}, {}})), ErrorCode::no_normals);
  EXPECT_EQ(reconstruct_error(cloud_of({{3, 2, 1}}, {{0, 0, 1}})), ErrorCode::empty_result);
  EXPECT_EQ(reconstruct_error(cloud_of(std::vector<Vec3f>(1000, {3, 2, 1}), std::vector<Vec3f>(1000, {0, 0, 1}))),
            ErrorCode::empty_result);
}

TEST(Errors, RefuseACubeThatFloatsDoNotReach) {
  const Cloud cloud = cloud_of({{9e37F, 0, 0}, {-9e37F, 0, 0}, {0, 9e37F, 0}, {0, 0, 9e37F}},
                               {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
  EXPECT_EQ(reconstruct_error(cloud, {{.depth = 5, .scale = 10}}), ErrorCode::invalid_input);
  const Mesh mesh = reconstructed(cloud, {{.depth = 5, .scale = 2}});
  for (const Vec3f& v : mesh.vertices) ASSERT_TRUE(std::isfinite(v.x) && std::isfinite(v.y) && std::isfinite(v.z));
}

TEST(Errors, NameOptionsThatAreOutOfRange) {
  constexpr double kNan = std::numeric_limits<double>::quiet_NaN();
  constexpr double kInfinity = std::numeric_limits<double>::infinity();
  std::vector<Options> bad;
  for (const int depth : {-1, 21, 1000}) bad.push_back({{.depth = depth}});
  for (const double w : {-1e-9, kNan, kInfinity}) bad.push_back({{.screening = w}});
  for (const int iterations : {-3, 0, 1001}) bad.push_back({{.iterations = iterations}});
  for (const double scale : {0.999, -1.0, 100.5, kNan, kInfinity}) bad.push_back({{.scale = scale}});
  for (const double samples : {-0.5, 101.0, kNan, kInfinity}) bad.push_back({{.samples_per_node = samples}});
  for (const double trim : {-0.5, -2.0, 1.0, kNan}) bad.push_back({{}, {.trim = trim}});
  for (const double least : {-1.0, 1.5, kNan, kInfinity}) bad.push_back({{}, {.min_component = least}});
  bad.push_back({{}, {}, {.max_memory_bytes = -1}});
  const Cloud cloud = test::sphere_cloud(100, 17);
  for (std::size_t i = 0; i < bad.size(); ++i) {
    EXPECT_EQ(error_of([&] { validate(bad[i]); }), ErrorCode::usage) << i;
    EXPECT_EQ(reconstruct_error(cloud, bad[i]), ErrorCode::usage) << i;
  }
  EXPECT_NO_THROW(validate({{.depth = 20, .screening = 0, .iterations = 1000, .scale = 100, .samples_per_node = 100}}));
  EXPECT_NO_THROW(validate({{.depth = Options::kAutomaticDepth}}));
  EXPECT_NO_THROW(validate({{.depth = 1, .screening = 1e6, .iterations = 1, .scale = 1, .samples_per_node = 0}}));
}

TEST(Errors, RefuseARunThatNeedsMoreMemoryThanAllowed) {
  const Cloud cloud = test::sphere_cloud(10'000, 18);
  EXPECT_EQ(reconstruct_error(cloud, {{.depth = 9}, {}, {.max_memory_bytes = 1000}}), ErrorCode::over_limit);
  EXPECT_NO_THROW((void)reconstructed(cloud, {{.depth = 6}, {}, {.max_memory_bytes = std::int64_t{1} << 40}}));
}

TEST(Errors, ToleratePointsWithoutANormalAmongOthers) {
  Cloud cloud = test::sphere_cloud(5'000, 19);
  for (std::size_t i = 0; i < cloud.normals.size(); i += 5) cloud.normals[i] = {};
  const MeshReport report = measure(reconstructed(cloud, {{.depth = 6}}));
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.euler, 2);
}

// ---- Tiny clouds

TEST(TinyClouds, EndInAWatertightMeshOrADefinedError) {
  std::map<std::string, int> outcomes;
  for (std::uint64_t seed = 1; seed <= 200; ++seed) {
    test::Random random(seed);
    Cloud cloud;
    const std::int64_t n = 1 + random.below(50);
    const bool flat = seed % 7 == 0;  // all in one plane
    const bool line = seed % 11 == 0;
    for (std::int64_t i = 0; i < n; ++i) {
      cloud.positions.push_back({static_cast<float>(random.in(-1, 1)), line ? 0 : static_cast<float>(random.in(-1, 1)),
                                 flat || line ? 0 : static_cast<float>(random.in(-1, 1))});
      const Vec3d d = random.direction();
      cloud.normals.push_back({static_cast<float>(d[0]), static_cast<float>(d[1]), static_cast<float>(d[2])});
    }
    const Options options{{.depth = 1 + static_cast<int>(random.below(9)),
                           .screening = seed % 3 == 0 ? 0.0 : 2.0,
                           .scale = seed % 5 == 0 ? 1.0 : 1.1,
                           .samples_per_node = seed % 2 == 0 ? 0.0 : 1.5}};
    SCOPED_TRACE("seed " + std::to_string(seed) + ", " + std::to_string(n) + " points, depth " +
                 std::to_string(options.depth));
    const auto code = error_of([&] {
      const MeshReport report = measure(reconstructed(cloud, options, 1));
      EXPECT_TRUE(report.closed());
      EXPECT_TRUE(report.manifold());
      EXPECT_TRUE(report.oriented());
      EXPECT_GT(report.volume, 0);
    });
    EXPECT_EQ(code.value_or(ErrorCode::empty_result), ErrorCode::empty_result);
    ++outcomes[code ? "empty_result" : "mesh"];
  }
  EXPECT_GT(outcomes["mesh"], 130);
}

}  // namespace
}  // namespace pointskin
