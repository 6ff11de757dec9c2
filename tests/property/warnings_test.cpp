// What a reconstruction says of its input and its result, and what it does about normals.
#include <gtest/gtest.h>

#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <string>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/option_sets.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::Outcome;
using test::run;

std::vector<WarningKind> kinds(const Outcome& outcome) {
  std::vector<WarningKind> all;
  for (const Warning& warning : outcome.report.warnings) {
    EXPECT_GE(warning.share, 0);
    EXPECT_LE(warning.share, 1);
    EXPECT_EQ(warning.text.find('\n'), std::string::npos);
    all.push_back(warning.kind);
  }
  return all;
}

const Warning& only(const Outcome& outcome, WarningKind kind) {
  static const Warning kNone{WarningKind::strays, -1, "there is none"};
  const auto& all = outcome.report.warnings;
  const auto is_it = [kind](const Warning& warning) { return warning.kind == kind; };
  EXPECT_EQ(std::count_if(all.begin(), all.end(), is_it), 1);
  const auto at = std::find_if(all.begin(), all.end(), is_it);
  return at == all.end() ? kNone : *at;
}

Cloud with_flips(Cloud cloud, double share, std::uint64_t seed) {
  test::Random random(seed);
  for (Vec3f& n : cloud.normals)
    if (random.unit() < share) n = {-n.x, -n.y, -n.z};
  return cloud;
}

TEST(PointNormalsAreJudged, ConsistentCloudsKeepTheirBytesWithoutAWord) {
  const Cloud cloud = test::jittered(test::torus_cloud(20'000, 1), 2, 0.01);
  for (const auto& [name, options] : test::option_sets(6, true)) {
    SCOPED_TRACE(name);
    Options given = options;
    given.point_normals = PointNormals::given;
    const Outcome judged = run(cloud, options);
    expect_same_bytes(judged.mesh, run(cloud, given).mesh);
    EXPECT_EQ(judged.report.normals_done, NormalsDone::kept);
    if (name != "trim") {
      EXPECT_TRUE(kinds(judged).empty());
    }
  }
}

TEST(PointNormalsAreJudged, ACloudThatIsInsideOutIsTurned) {
  const Cloud cloud = test::linked_tori_cloud(20'000, 3);
  for (const Options& options :
       {Options{{.depth = 6}}, Options{{.depth = 6, .boundary = Boundary::dirichlet}},
        Options{{.depth = 6, .field = FieldKind::distance}}, Options{{.depth = 6, .confidence = true}}}) {
    const Outcome turned = run(test::flipped(cloud), options);
    expect_same_bytes(turned.mesh, run(cloud, options).mesh);
    EXPECT_EQ(turned.report.normals_done, NormalsDone::turned);
    EXPECT_EQ(kinds(turned), std::vector{WarningKind::normals_inside_out});
    EXPECT_NE(only(turned, WarningKind::normals_inside_out).text.find("--normals given"), std::string::npos);
  }
}

TEST(PointNormalsAreJudged, GivenNormalsStayWithAWarning) {
  const Cloud inward = test::flipped(test::sphere_cloud(10'000, 4));
  const Outcome given = run(inward, {{.depth = 6, .point_normals = PointNormals::given}});
  EXPECT_EQ(given.report.normals_done, NormalsDone::kept);
  EXPECT_EQ(kinds(given), std::vector{WarningKind::normals_inside_out});
  EXPECT_EQ(measure(given.mesh).components, 2);  // the box, and the sphere within

  const Cloud flipped = with_flips(test::sphere_cloud(20'000, 5), 0.5, 6);
  const Outcome half = run(flipped, {{.depth = 6, .point_normals = PointNormals::given}});
  const Warning& warning = only(half, WarningKind::normals_disagree);
  EXPECT_NEAR(warning.share, 0.5, 0.1);
  EXPECT_NE(warning.text.find("--normals repair"), std::string::npos);
}

TEST(PointNormalsAreJudged, FlippedNormalsAreRepaired) {
  const Cloud cloud = test::torus_cloud(20'000, 7);
  for (const double share : {0.1, 0.3, 0.5}) {
    const Outcome repaired = run(with_flips(cloud, share, 8), {{.depth = 6}});
    EXPECT_EQ(repaired.report.normals_done, NormalsDone::repaired);
    EXPECT_NEAR(only(repaired, WarningKind::normals_disagree).share, share, 0.02);
    const MeshReport mesh = measure(repaired.mesh);
    EXPECT_TRUE(mesh.watertight());
    EXPECT_EQ(mesh.euler, 0);
    ASSERT_TRUE(repaired.report.normals.has_value());
    EXPECT_NEAR(static_cast<double>(repaired.report.normals->flipped), share * 20'000, 300);
  }
}

TEST(PointNormalsAreJudged, PartsThatAreTurnedAreFound) {
  Cloud cloud = test::torus_cloud(20'000, 9);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)
    if (cloud.positions[i].x > 0.3F) cloud.normals[i] = {-cloud.normals[i].x, -cloud.normals[i].y, -cloud.normals[i].z};
  Cloud apart = test::sphere_cloud(10'000, 10);
  test::append(apart, test::flipped(test::sphere_cloud(10'000, 11, 1, {3, 0, 0})));
  for (const Cloud& parts : {cloud, apart}) {
    for (const PointNormals policy : {PointNormals::automatic, PointNormals::repair}) {
      const Outcome repaired = run(parts, {{.depth = 6, .point_normals = policy}});
      EXPECT_EQ(repaired.report.normals_done, NormalsDone::repaired);
      const MeshReport mesh = measure(repaired.mesh);
      EXPECT_TRUE(mesh.watertight());
      EXPECT_EQ(mesh.components, &parts == &cloud ? 1 : mesh.components);
      EXPECT_LT(mesh.volume, 9);  // two unit spheres: 8.4; with the box around them far more
    }
  }
}

TEST(PointNormalsAreJudged, ARepairedCloudHasTheSameBytesInAnyOrder) {
  const Cloud cloud = with_flips(test::torus_cloud(15'000, 12), 0.4, 13);
  const Mesh mesh = run(cloud, {{.depth = 6}}, 1).mesh;
  expect_same_bytes(mesh, run(test::shuffled(cloud, 14), {{.depth = 6}}, 3).mesh);
}

TEST(PointNormalsAreJudged, NormalsAreMadeWhereTheyAreAskedFor) {
  Cloud bare = test::sphere_cloud(10'000, 15);
  bare.normals.clear();
  const Outcome made = run(bare, {{.depth = 6, .point_normals = PointNormals::estimate}});
  EXPECT_EQ(made.report.normals_done, NormalsDone::estimated);
  EXPECT_NEAR(measure(made.mesh).volume, 4.18879, 0.05);
  for (const PointNormals policy : {PointNormals::automatic, PointNormals::given, PointNormals::repair})
    EXPECT_EQ(error_of([&] { (void)run(bare, {{.depth = 6, .point_normals = policy}}); }), ErrorCode::no_normals);
  // Given ones that point inwards are turned, too.
  const Cloud inward = test::flipped(test::sphere_cloud(10'000, 16));
  EXPECT_NEAR(measure(run(inward, {{.depth = 6, .point_normals = PointNormals::estimate}}).mesh).volume, 4.18879, 0.05);
}

TEST(PointNormalsAreJudged, ARoomSeenFromItsSensorStaysOne) {
  Cloud bare = test::box_cloud(30'000, 17);
  bare.normals.clear();
  Options options{{.depth = 6, .point_normals = PointNormals::estimate}};
  options.normal_estimation.sensors = {{0.1, 0.2, 0}};
  const Outcome room = run(bare, options);
  EXPECT_EQ(kinds(room), std::vector{WarningKind::normals_inside_out});
  EXPECT_EQ(measure(room.mesh).components, 2);
  options.trim = Options::kAutomaticTrim;
  const MeshReport walls = measure(run(bare, options).mesh);  // without the box around them
  EXPECT_EQ(walls.components, 1);
  EXPECT_NEAR(walls.volume, -8, 0.1);
}

TEST(PointNormalsAreJudged, NothingIsRepairedBeyondTheMemoryAllowed) {
  const Cloud cloud = with_flips(test::sphere_cloud(40'000, 18), 0.5, 19);
  Options options{{.depth = 5}};
  options.max_memory_bytes = estimate_device_bytes(cloud, options);
  ASSERT_LT(options.max_memory_bytes, estimate_normals_device_bytes(cloud));
  const Outcome kept = run(cloud, options);
  EXPECT_EQ(kept.report.normals_done, NormalsDone::kept);
  EXPECT_LE(kept.report.device_peak_bytes, 1.15 * static_cast<double>(options.max_memory_bytes));
  only(kept, WarningKind::normals_disagree);
}

TEST(PointNormalsAreJudged, ProgressNeverGoesBack) {
  for (const Cloud& cloud : {test::torus_cloud(10'000, 20), test::flipped(test::torus_cloud(10'000, 20)),
                             with_flips(test::torus_cloud(10'000, 20), 0.5, 21)}) {
    double last = 0;
    Options options{{.depth = 6}};
    options.progress = [&last](const Progress& progress) {
      EXPECT_GE(progress.fraction, last);
      EXPECT_LE(progress.fraction, 1);
      last = progress.fraction;
      return true;
    };
    (void)run(cloud, options);
    EXPECT_GE(last, 0.8);
  }
}

TEST(Warnings, OfOpenScansNameATrimThatCuts) {
  const Cloud cloud = test::plane_cloud(30'000, 22);
  const Outcome closed = run(cloud, {{.depth = 7}});
  EXPECT_EQ(kinds(closed), (std::vector{WarningKind::at_domain_faces, WarningKind::far_from_points}));
  // The plane of area 4 in a cube of side 2.2 parts it in two; one half is closed by five of its faces, some in part.
  EXPECT_NEAR(only(closed, WarningKind::at_domain_faces).share, 0.67, 0.1);
  const Warning& far = only(closed, WarningKind::far_from_points);
  const std::size_t at = far.text.find("--trim ");
  ASSERT_NE(at, std::string::npos);
  const double value = std::stod(far.text.substr(at + 7));
  const Outcome trimmed = run(cloud, {{.depth = 7}, {.trim = value}});
  EXPECT_TRUE(kinds(trimmed).empty());
  EXPECT_NEAR(measure(trimmed.mesh).area, 4.3, 0.3);  // two or three samples beyond the last, 0.012 apart
}

TEST(Warnings, AnAutomaticTrimTakesThatValue) {
  const Outcome trimmed = run(test::plane_cloud(30'000, 23), {{.depth = 7}, {.trim = Options::kAutomaticTrim}});
  EXPECT_TRUE(kinds(trimmed).empty());
  EXPECT_GT(trimmed.report.trim.quantile, 0);
  EXPECT_NEAR(measure(trimmed.mesh).area, 4.3, 0.3);
  EXPECT_TRUE(measure(trimmed.mesh).manifold());
}

TEST(Warnings, AnAutomaticTrimLeavesClosedSurfacesAlone) {
  for (const Cloud& cloud : {test::sphere_cloud(20'000, 24), test::linked_tori_cloud(30'000, 25)}) {
    const Outcome kept = run(cloud, {{.depth = 7}, {.trim = Options::kAutomaticTrim}});
    expect_same_bytes(kept.mesh, run(cloud, {{.depth = 7}}).mesh);
    EXPECT_EQ(kept.report.trim.quantile, 0);
  }
}

TEST(Warnings, SayThatPointsHoldMoreThanTheDepthShows) {
  const Cloud cloud = test::torus_cloud(100'000, 26);
  const Outcome coarse = run(cloud, {{.depth = 5}});
  ASSERT_EQ(kinds(coarse), std::vector{WarningKind::coarse_depth});
  EXPECT_NE(only(coarse, WarningKind::coarse_depth).text.find("--depth 8"), std::string::npos);
  EXPECT_TRUE(kinds(run(cloud, {{.depth = 7}})).empty());
  // Noise of a cell of depth 5 hides what is finer.
  EXPECT_TRUE(kinds(run(test::jittered(cloud, 27, 0.08), {{.depth = 5}})).empty());
}

/// A sphere of radius 10 around (place, 0, 0), as a file with float32 has it, or one with double.
Cloud far_sphere(double place, bool in_float, const Vec3d& origin) {
  Cloud cloud = test::sphere_cloud(20'000, 29);
  cloud.origin = origin;
  for (Vec3f& p : cloud.positions) {
    const double x = place + 10 * static_cast<double>(p.x);
    p = {static_cast<float>((in_float ? static_cast<double>(static_cast<float>(x)) : x) - origin[0]), 10 * p.y,
         10 * p.z};
  }
  return cloud;
}

TEST(Warnings, OfCoordinatesWithTooFewDigits) {
  for (const Vec3d& origin : {Vec3d{1e6, 0, 0}, Vec3d{0, 0, 0}}) {
    const Outcome far = run(far_sphere(1e6, true, origin), {{.depth = 6}});
    const Warning& warning = only(far, WarningKind::coarse_coordinates);
    EXPECT_NE(warning.text.find("steps of 0.0625 "), std::string::npos) << warning.text;
    EXPECT_NEAR(warning.share, 0.25, 0.1);  // points of a sphere of area 1257, about 0.25 apart
  }
  const auto says = [](const Outcome& outcome) {
    const auto all = kinds(outcome);
    return std::find(all.begin(), all.end(), WarningKind::coarse_coordinates) != all.end();
  };
  EXPECT_FALSE(says(run(far_sphere(1e6, false, {1e6, 0, 0}), {{.depth = 6}})));
  EXPECT_FALSE(says(run(far_sphere(1e5, true, {1e5, 0, 0}), {{.depth = 6}})));
  EXPECT_FALSE(says(run(far_sphere(0, true, {0, 0, 0}), {{.depth = 6}})));
}

TEST(Warnings, OfAnOriginFarFromThePoints) {
  Cloud cloud = test::sphere_cloud(20'000, 29);
  for (Vec3f& p : cloud.positions) p.x = static_cast<float>(static_cast<double>(p.x) - 1e6);
  cloud.origin = {1e6, 0, 0};  // what --shift 1e6,0,0 makes of a sphere around 0
  const Outcome far = run(cloud, {{.depth = 6}});
  const Warning& warning = only(far, WarningKind::coarse_coordinates);
  EXPECT_NE(warning.text.find("relative to 1000000 0 0, in steps of 0.0625 "), std::string::npos) << warning.text;
}

TEST(Warnings, OfStraysComeFirst) {
  Cloud cloud = test::flipped(test::sphere_cloud(10'000, 28));
  cloud.positions.push_back({100, 0, 0});
  cloud.normals.push_back({1, 0, 0});
  EXPECT_EQ(kinds(run(cloud, {{.depth = 6}})), (std::vector{WarningKind::normals_inside_out, WarningKind::strays}));
}

}  // namespace
}  // namespace pointskin
