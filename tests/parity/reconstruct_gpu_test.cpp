// The GPU against the CPU through the public API: the same bytes.
#include <gtest/gtest.h>

#include <pointskin/components.hpp>
#include <pointskin/device.hpp>
#include <pointskin/device_data.hpp>
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <cstdint>
#include <limits>
#include <memory>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

#include "parity/gpu_test.hpp"
#include "property/reconstruction.hpp"
#include "support/io_files.hpp"
#include "support/shapes.hpp"
#include "support/stray_clouds.hpp"

namespace pointskin {
namespace {

using test::expect_same_bytes;

class Gpu : public test::GpuTest {
 protected:
  /// Compares both devices' meshes, isovalues and levels.
  void expect_parity(const Cloud& cloud, const Options& options) {
    Reconstructor on_cpu(Device::cpu());
    Reconstructor on_gpu(gpu_);
    const Mesh expected = on_cpu.reconstruct(cloud, options);
    expect_same_bytes(on_gpu.reconstruct(cloud, options), expected);
    EXPECT_EQ(on_gpu.report().isovalue, on_cpu.report().isovalue);
    EXPECT_EQ(on_gpu.report().nodes, on_cpu.report().nodes);
    const EnvelopeReport& within = on_gpu.report().envelope;
    EXPECT_EQ(within.samples_outside, on_cpu.report().envelope.samples_outside);
    EXPECT_EQ(within.vertices_moved, on_cpu.report().envelope.vertices_moved);
    EXPECT_EQ(within.farthest_move, on_cpu.report().envelope.farthest_move);
    EXPECT_EQ(on_gpu.report().depth, on_cpu.report().depth);
    EXPECT_EQ(on_gpu.report().normals_done, on_cpu.report().normals_done);
    ASSERT_EQ(on_gpu.report().warnings.size(), on_cpu.report().warnings.size());
    for (std::size_t i = 0; i < on_cpu.report().warnings.size(); ++i)
      EXPECT_EQ(on_gpu.report().warnings[i].text, on_cpu.report().warnings[i].text);
    EXPECT_EQ(on_gpu.report().pieces.triangles_removed, on_cpu.report().pieces.triangles_removed);
    const TrimReport& trimmed = on_gpu.report().trim;
    EXPECT_EQ(trimmed.quantile, on_cpu.report().trim.quantile);
    EXPECT_EQ(trimmed.density, on_cpu.report().trim.density);
    EXPECT_EQ(trimmed.area_removed, on_cpu.report().trim.area_removed);
    EXPECT_EQ(trimmed.triangles_split, on_cpu.report().trim.triangles_split);
    EXPECT_EQ(trimmed.islands_removed, on_cpu.report().trim.islands_removed);
    EXPECT_EQ(trimmed.holes_filled, on_cpu.report().trim.holes_filled);
    ASSERT_EQ(on_gpu.report().levels.size(), on_cpu.report().levels.size());
    for (std::size_t d = 0; d < on_cpu.report().levels.size(); ++d) {
      EXPECT_EQ(on_gpu.report().levels[d].nodes, on_cpu.report().levels[d].nodes) << "level " << d;
      EXPECT_EQ(on_gpu.report().levels[d].unknowns, on_cpu.report().levels[d].unknowns) << "level " << d;
      EXPECT_EQ(on_gpu.report().levels[d].residual_after, on_cpu.report().levels[d].residual_after) << "level " << d;
    }
  }
};

struct NamedCloud {
  std::string name;
  Cloud cloud;
};
/// Samples that neighbours of neighbours decide on: outliers all around, and a part that was seen sparsely.
Cloud cloud_with_outliers() {
  Cloud cloud = test::sphere_cloud(20'000, 10);
  test::append(cloud, test::jittered(test::sphere_cloud(1'500, 11), 12, 0.8));
  test::append(cloud, test::sphere_cloud(300, 13, 0.5, {2.5, 0, 0}));
  return test::shuffled(cloud, 14);
}

NamedCloud cloud_number(int i) {
  switch (i) {
    case 0:
      return {"sphere", test::sphere_cloud(20'000, 1)};
    case 1:
      return {"linked tori", test::linked_tori_cloud(30'000, 2)};
    case 2:
      return {"box", test::box_cloud(20'000, 3)};
    case 3:
      return {"thin plate", test::thin_plate_cloud(30'000, 4, 0.05)};
    case 4:
      return {"plane", test::plane_cloud(10'000, 5)};
    case 5:
      return {"noisy sphere", test::jittered(test::sphere_cloud(20'000, 6), 7, 0.03)};
    case 6:
      return {"outliers and a sparse part", cloud_with_outliers()};
    default:
      break;
  }
  Cloud repeated = test::sphere_cloud(3'000, 8);
  test::append(repeated, test::sphere_cloud(3'000, 8));
  return {"repeated points", test::shuffled(repeated, 9)};
}
constexpr int kClouds = 8;

/// Small tests of their own, so that slow checkers can run many at once.
class GpuOnCloud : public Gpu, public testing::WithParamInterface<std::tuple<int, int>> {};

TEST_P(GpuOnCloud, GivesTheSameBytesAsTheCpu) {
  const auto& [number, level] = GetParam();
  const int depth = level;  // lambdas of C++20 capture no structured binding before clang 16
  const NamedCloud c = cloud_number(number);
  SCOPED_TRACE(c.name + ", depth " + std::to_string(depth));
  // Depth 1 resolves no surface of some: the same error then.
  const auto cpu_error = test::error_of([&] { (void)test::reconstructed(c.cloud, {{.depth = depth}}); });
  const auto gpu_error = test::error_of([&] { (void)Reconstructor(gpu_).reconstruct(c.cloud, {{.depth = depth}}); });
  EXPECT_EQ(gpu_error, cpu_error);
  EXPECT_TRUE(!cpu_error || depth == 1);
  if (!cpu_error) expect_parity(c.cloud, {{.depth = depth}});
}

INSTANTIATE_TEST_SUITE_P(EveryShapeAndDepth, GpuOnCloud,
                         testing::Combine(testing::Range(0, kClouds), testing::Values(1, 2, 4, 5, 7, 9)));

std::vector<Options> options_to_try() {
  std::vector<Options> all;
  for (const double screening : {0.0, 50.0}) all.push_back({{.depth = 7, .screening = screening}});
  for (const int iterations : {1, 7, 40}) all.push_back({{.depth = 7, .iterations = iterations}});
  for (const double scale : {1.0, 2.5}) all.push_back({{.depth = 7, .scale = scale}});
  for (const double samples : {0.0, 20.0}) all.push_back({{.depth = 7, .samples_per_node = samples}});
  all.push_back({{.depth = 7, .confidence = true}});
  all.push_back({{.depth = 7}, {.linear_fit = true}});
  all.push_back({{.depth = 7}, {.density = true}});
  all.push_back({{.depth = 7}, {.normals = false}});
  all.push_back({{.depth = 7}, {.domain_faces = DomainFaces::open}});
  all.push_back({{.depth = 7, .boundary = Boundary::dirichlet}});
  all.push_back({{.depth = 7}, {}, {.residuals = true}});
  all.push_back({{.depth = 7}, {.trim = 0.3}});
  all.push_back({{.depth = 7}, {.weakness = true}});
  all.push_back({{.depth = 7, .field = FieldKind::distance}});
  all.push_back({{.depth = 7, .field = FieldKind::distance, .confidence = true}, {.trim = 0.1, .density = true}});
  for (const double offset : {0.1, -0.03}) {
    all.push_back({{.depth = 6, .offset = offset}});
    all.push_back({{.depth = 6, .field = FieldKind::distance, .offset = offset}});
  }
  all.push_back({{.depth = 7}, {.normals = false, .trim = 0.9, .island_ratio = 0, .density = true}});
  all.push_back({{.depth = Options::kAutomaticDepth}});
  all.push_back({{.depth = 7}, {.trim = Options::kAutomaticTrim}});
  all.push_back({{.depth = 7}, {.largest = true}});
  all.push_back({{.depth = 7}, {.min_component = 0.1}});
  return all;
}
constexpr int kOptions = 29;

class GpuWithOptions : public Gpu, public testing::WithParamInterface<int> {};

TEST_P(GpuWithOptions, GivesTheSameBytesAsTheCpu) {
  const std::vector<Options> all = options_to_try();
  ASSERT_EQ(all.size(), kOptions);
  expect_parity(test::jittered(test::torus_cloud(20'000, 10), 11, 0.01), all[static_cast<std::size_t>(GetParam())]);
}

INSTANTIATE_TEST_SUITE_P(EveryOption, GpuWithOptions, testing::Range(0, kOptions));

TEST_F(Gpu, LeavesOutTheSamePiecesAsTheCpu) {
  Cloud cloud = test::sphere_cloud(20'000, 30);
  test::append(cloud, test::sphere_cloud(3'000, 31, 0.4, {1.8, 0, 0}));
  test::append(cloud, test::sphere_cloud(1'000, 32, 0.1, {1.8, 0.8, 0}));
  expect_parity(cloud, {{.depth = 7}, {.largest = true}});
  for (const double least : {0.02, 0.3, 2000.0}) expect_parity(cloud, {{.depth = 7}, {.min_component = least}});
}

TEST_F(Gpu, DoesTheSameAboutNormalsAsTheCpu) {
  const Cloud torus = test::torus_cloud(20'000, 33);
  Cloud flips = torus;
  test::Random random(34);
  for (Vec3f& n : flips.normals)
    if (random.below(2) == 0) n = {-n.x, -n.y, -n.z};
  Cloud part = torus;
  for (std::size_t i = 0; i < part.positions.size(); ++i)
    if (part.positions[i].x > 0) part.normals[i] = {-part.normals[i].x, -part.normals[i].y, -part.normals[i].z};
  for (const Cloud& cloud : {test::flipped(torus), flips, part, test::plane_cloud(20'000, 35)}) {
    for (const PointNormals policy : {PointNormals::automatic, PointNormals::given, PointNormals::repair})
      expect_parity(cloud, {{.depth = 6, .point_normals = policy}});
    expect_parity(cloud, {{.depth = 6}, {.trim = Options::kAutomaticTrim}});
  }
}

TEST_P(GpuOnCloud, StaysInsideOfAnEnvelopeWithTheSameBytesAsTheCpu) {
  const auto& [number, level] = GetParam();
  const int depth = level;  // lambdas of C++20 capture no structured binding before clang 16
  const NamedCloud c = cloud_number(number);
  SCOPED_TRACE(c.name + ", depth " + std::to_string(depth));
  const auto sphere = std::make_shared<const Mesh>(test::icosphere_mesh(4, 0.98));
  for (const Boundary boundary : {Boundary::free, Boundary::dirichlet}) {
    const Options options{{.depth = depth, .boundary = boundary, .envelope = sphere}};
    const auto cpu_error = test::error_of([&] { (void)test::reconstructed(c.cloud, options); });
    const auto gpu_error = test::error_of([&] { (void)Reconstructor(gpu_).reconstruct(c.cloud, options); });
    EXPECT_EQ(gpu_error, cpu_error);
    if (cpu_error) continue;
    expect_parity(c.cloud, options);
    Options trimmed = options;
    trimmed.trim = 0.2;
    if (!test::error_of([&] { (void)test::reconstructed(c.cloud, trimmed); })) expect_parity(c.cloud, trimmed);
  }
}

TEST_P(GpuOnCloud, TrimsToTheSameBytesAsTheCpu) {
  const auto& [number, level] = GetParam();
  const int depth = level;  // lambdas of C++20 capture no structured binding before clang 16
  const NamedCloud c = cloud_number(number);
  SCOPED_TRACE(c.name + ", depth " + std::to_string(depth));
  const auto cpu_error = test::error_of([&] {
    (void)test::reconstructed(c.cloud, {{.depth = depth}, {.trim = 0.2, .island_ratio = 0.01}});
  });
  const auto gpu_error = test::error_of([&] {
    (void)Reconstructor(gpu_).reconstruct(c.cloud, {{.depth = depth}, {.trim = 0.2, .island_ratio = 0.01}});
  });
  EXPECT_EQ(gpu_error, cpu_error);
  if (!cpu_error) expect_parity(c.cloud, {{.depth = depth}, {.trim = 0.2, .island_ratio = 0.01}});
}

/// Attributes of all kinds, of which points lack some, and points that differ in nothing else.
Cloud coloured(Cloud cloud, std::uint64_t seed) {
  test::append(cloud, Cloud(cloud));
  test::Random random(seed);
  const auto add = [&](const char* name, AttributeType type, double lowest, double highest) {
    AttributeValues values(AttributeType::float64, cloud.positions.size());
    for (double& v : values.edit<double>()) v = random.in(lowest, highest);
    cloud.attributes.push_back({name, values.converted(type)});
  };
  for (const char* name : {"red", "green", "blue"}) add(name, AttributeType::uint8, 0, 255);
  for (const char* name : {"x", "y"}) add(name, AttributeType::float32, -1e6, 1e6);
  add("gps_time", AttributeType::float64, 4e8, 4e8 + 1);
  add("intensity", AttributeType::uint16, 0, 65535);
  add("label", AttributeType::int32, -2147483648.0, 2147483647.0);
  add("segment", AttributeType::uint8, 0, 4);
  add("id", AttributeType::uint64, 0, 1e18);
  for (const std::size_t a : {3U, 6U, 8U, 9U})  // the last two lack other points each
    for (std::size_t i = 0; i < cloud.positions.size(); ++i)
      if (random.below(2) == 0) cloud.attributes[a].values.set_missing(i);
  return cloud;
}

TEST_F(Gpu, GivesVerticesTheSameAttributesAsTheCpu) {
  const Cloud cloud = coloured(test::jittered(test::linked_tori_cloud(30'000, 21), 22, 0.01), 23);
  for (const int depth : {2, 4, 7, 9}) {
    SCOPED_TRACE("depth " + std::to_string(depth));
    expect_parity(cloud, {{.depth = depth}, {.attributes = true}});
    expect_parity(cloud, {{.depth = depth, .confidence = true}, {.density = true, .attributes = true}});
  }
  Reconstructor r(gpu_);
  const Mesh expected = r.reconstruct(cloud, {{.depth = 7}, {.attributes = true}});
  expect_same_bytes(r.solve(cloud, {.depth = 7}).extract({.attributes = true}), expected);
  const UploadedCloud points = upload(r.workspace(), cloud);
  expect_same_bytes(download(r.workspace(), r.reconstruct(points, {{.depth = 7}, {.attributes = true}})), expected);
  expect_same_bytes(r.reconstruct(test::shuffled(cloud, 24), {{.depth = 7}, {.attributes = true}}), expected);
}

TEST_F(Gpu, EndsTinyCloudsAsTheCpuDoes) {
  for (std::uint64_t seed = 1; seed <= 40; ++seed) {
    test::Random random(seed);
    Cloud cloud;
    for (std::int64_t i = 1 + random.below(40); i > 0; --i) {
      const Vec3d p = random.direction();
      const Vec3d n = random.direction();
      cloud.positions.push_back({static_cast<float>(p[0]), static_cast<float>(p[1]), static_cast<float>(p[2])});
      cloud.normals.push_back({static_cast<float>(n[0]), static_cast<float>(n[1]), static_cast<float>(n[2])});
    }
    const Options options{{.depth = 1 + static_cast<int>(random.below(9))}};
    SCOPED_TRACE("seed " + std::to_string(seed));
    Mesh on_cpu;
    Mesh on_gpu;
    const auto cpu_error = test::error_of([&] { on_cpu = Reconstructor(Device::cpu(1)).reconstruct(cloud, options); });
    const auto gpu_error = test::error_of([&] { on_gpu = Reconstructor(gpu_).reconstruct(cloud, options); });
    EXPECT_EQ(cpu_error, gpu_error);
    expect_same_bytes(on_cpu, on_gpu);
  }
}

TEST_F(Gpu, LeavesOutTheStraysThatTheCpuLeavesOut) {
  const Cloud clean = test::torus_cloud(30'000, 21, 0.7, 0.3);
  for (const test::NamedPlaces& strays : test::stray_places()) {
    SCOPED_TRACE(strays.name);
    const Cloud cloud = test::with_points_at(clean, strays.places);
    expect_parity(cloud, {{.depth = 7}, {.density = true}});
    expect_parity(cloud, {{.depth = 6, .keep_strays = true}});
    Reconstructor on_gpu(gpu_);
    Reconstructor on_cpu(Device::cpu());
    expect_same_bytes(on_gpu.reconstruct(cloud, {{.depth = 6}}), on_cpu.reconstruct(clean, {{.depth = 6}}));
    (void)on_cpu.reconstruct(cloud, {{.depth = 6}});
    EXPECT_EQ(on_gpu.report().points, clean.size());
    EXPECT_EQ(on_gpu.report().strays, std::ssize(strays.places));
    EXPECT_EQ(on_gpu.report().farthest_strays, on_cpu.report().farthest_strays);
    const UploadedCloud points = upload(on_gpu.workspace(), cloud);
    expect_same_bytes(download(on_gpu.workspace(), on_gpu.reconstruct(points, {{.depth = 6}})),
                      on_cpu.reconstruct(clean, {{.depth = 6}}));
  }
}

TEST_F(Gpu, CopiesManyBytesBothWays) {
  Cloud cloud = test::sphere_cloud(1'500'007, 31);  // arrays of no whole number of parts
  ASSERT_GT(cloud.positions.size() * sizeof(Vec3f), std::size_t{16} << 20);
  cloud.origin = {1, 2, 3};
  const Workspace workspace(gpu_);
  const UploadedCloud there = upload(workspace, cloud);
  const Cloud back = download(workspace, there);
  EXPECT_EQ(back.positions, cloud.positions);
  EXPECT_EQ(back.normals, cloud.normals);
  EXPECT_EQ(back.origin, cloud.origin);
}

TEST_F(Gpu, WritesFilesOfMeshesThatItHolds) {
  const Cloud cloud = test::linked_tori_cloud(60'000, 32);
  const test::TemporaryFolder folder;
  Reconstructor r(gpu_);
  const DeviceMesh mesh = r.reconstruct_on_device(cloud, {{.depth = 8}});
  const Mesh on_cpu = Reconstructor(Device::cpu()).reconstruct(cloud, {{.depth = 8}});
  ASSERT_GT(mesh.vertices.size, 1 << 15);
  for (const char* name : {"a.ply", "a.obj"}) {
    write_mesh(folder.file(name), r.workspace(), mesh);
    const std::string written = test::bytes_of_file(folder.file(name));
    write_mesh(folder.file(name), on_cpu);
    EXPECT_TRUE(written == test::bytes_of_file(folder.file(name))) << name;
  }
  const MeshGlance there = glance_at(r.workspace(), mesh);
  const MeshGlance here = glance_at(on_cpu);
  EXPECT_EQ(there.components, here.components);
  EXPECT_TRUE(there.closed && there.oriented);
}

TEST_F(Gpu, GivesTheSameBytesRunAfterRun) {
  Reconstructor r(gpu_);
  const Cloud sphere = test::sphere_cloud(50'000, 12);
  const Cloud torus = test::torus_cloud(30'000, 13);
  const Mesh first = r.reconstruct(sphere, {{.depth = 8}, {.density = true}});
  const Mesh other = r.reconstruct(torus, {{.depth = 7}});
  for (int i = 0; i < 5; ++i) {
    expect_same_bytes(r.reconstruct(sphere, {{.depth = 8}, {.density = true}}), first);
    expect_same_bytes(r.reconstruct(torus, {{.depth = 7}}), other);
  }
  expect_same_bytes(r.reconstruct(test::shuffled(sphere, 14), {{.depth = 8}, {.density = true}}), first);
}

/// A third of 60 clouds, so that a sanitizer ends with each in minutes; more than there are streams.
class GpuManyClouds : public Gpu, public testing::WithParamInterface<int> {};

TEST_P(GpuManyClouds, AreReconstructedAsOneByOne) {
  constexpr int kClouds = 20;
  std::vector<Cloud> clouds{test::sphere_cloud(250'000, 1)};  // alone
  for (int i = GetParam(); i < 3 * kClouds; i += 3)
    clouds.push_back(test::torus_cloud(500 + 331 * i, static_cast<std::uint64_t>(i)));
  clouds.emplace_back();
  Options options;
  options.depth = 6;
  Reconstructor on_cpu(Device::cpu());
  Reconstructor on_gpu(gpu_);
  for (int round = 0; round < 3; ++round) {
    const std::vector<Reconstruction> results = on_gpu.reconstruct_many(clouds, options);
    for (std::size_t i = 0; i + 1 < clouds.size(); ++i) {
      ASSERT_FALSE(results[i].error) << results[i].error->what();
      expect_same_bytes(results[i].mesh, on_cpu.reconstruct(clouds[i], options));
    }
    ASSERT_TRUE(results.back().error);
    EXPECT_EQ(results.back().error->code(), ErrorCode::empty_result);
  }
}

INSTANTIATE_TEST_SUITE_P(Thirds, GpuManyClouds, testing::Range(0, 3));

TEST_F(Gpu, KeepsAFieldAliveAfterItsReconstructor) {
  const Cloud cloud = test::torus_cloud(20'000, 15);
  auto r = std::make_unique<Reconstructor>(gpu_);
  const Field field = r->solve(cloud, {.depth = 7});
  const Mesh expected = r->reconstruct(cloud, {{.depth = 7}});
  r.reset();
  expect_same_bytes(field.extract(), expected);
  const Field on_cpu = Reconstructor(Device::cpu()).solve(cloud, {.depth = 7});
  std::vector<Vec3d> at;
  test::Random random(16);
  for (int i = 0; i < 1000; ++i) at.push_back({random.in(-2, 2), random.in(-2, 2), random.in(-1, 1)});
  EXPECT_TRUE(test::same_bytes(field.values(at), on_cpu.values(at)));
  EXPECT_EQ(field.isovalue(), on_cpu.isovalue());
}

TEST_F(Gpu, RunsTwoReconstructorsSideBySide) {
  const Cloud sphere = test::sphere_cloud(20'000, 17);
  const Cloud torus = test::torus_cloud(20'000, 18);
  Reconstructor a(gpu_);
  Reconstructor b(gpu_);
  const Field field_a = a.solve(sphere, {.depth = 7});
  const Field field_b = b.solve(torus, {.depth = 7});
  const Mesh mesh_a = field_a.extract();
  const Mesh mesh_b = field_b.extract();
  expect_same_bytes(a.reconstruct(torus, {{.depth = 7}}), mesh_b);
  expect_same_bytes(b.reconstruct(sphere, {{.depth = 7}}), mesh_a);
}

TEST_F(Gpu, GivesTheSameBytesFromResidentPointsAgainAndAgain) {
  Reconstructor r(gpu_);
  const Cloud cloud = test::sphere_cloud(20'000, 19);
  const Mesh before = r.reconstruct(cloud, {{.depth = 7}});
  const UploadedCloud points = upload(r.workspace(), cloud);
  for (int i = 0; i < 4; ++i) expect_same_bytes(download(r.workspace(), r.reconstruct(points, {{.depth = 7}})), before);
  expect_same_bytes(r.reconstruct(cloud, {{.depth = 7}}), before);
}

TEST_F(Gpu, ReportsErrorsAsTheCpuDoes) {
  Reconstructor r(gpu_);
  const auto code = [&](const Cloud& cloud) {
    return test::error_of([&] { (void)r.reconstruct(cloud, {{.depth = 6}}); });
  };
  Cloud same;
  same.positions.assign(1000, {1, 2, 3});
  EXPECT_EQ(code({}), ErrorCode::empty_result);
  EXPECT_EQ(code(same), ErrorCode::no_normals);
  same.normals.assign(1000, {0, 0, 0});
  EXPECT_EQ(code(same), ErrorCode::no_normals);
  same.normals.assign(1000, {0, 0, 1});
  EXPECT_EQ(code(same), ErrorCode::empty_result);
  EXPECT_TRUE(measure(r.reconstruct(test::sphere_cloud(5'000, 20), {{.depth = 6}})).watertight());
}

class GpuOnScan : public Gpu, public testing::WithParamInterface<std::tuple<std::string, int>> {};

TEST_P(GpuOnScan, GivesTheSameBytesAsTheCpu) {
  const auto [name, depth] = GetParam();
  const auto cloud = test::shared_cloud(name);
  if (!cloud) GTEST_SKIP() << "no " << name << " in " << POINTSKIN_SOURCE_DIR << "/../shared/data";
  expect_parity(*cloud, {{.depth = depth}});
}

TEST_P(GpuOnScan, TrimsToTheSameBytesAsTheCpu) {
  const auto [name, depth] = GetParam();
  const auto cloud = test::shared_cloud(name);
  if (!cloud) GTEST_SKIP() << "no " << name << " in " << POINTSKIN_SOURCE_DIR << "/../shared/data";
  expect_parity(*cloud, {{.depth = depth}, {.trim = 0.1}});
}

INSTANTIATE_TEST_SUITE_P(PublicScans, GpuOnScan,
                         testing::Combine(testing::Values("bunny_scans", "armadillo_oriented", "srb_anchor", "srb_dc"),
                                          testing::Values(6, 8, 9)));

}  // namespace
}  // namespace pointskin
