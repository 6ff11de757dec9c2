// What a look at a run counts, and what that is taken for.
#include <gtest/gtest.h>

#include <pointskin/reconstruct.hpp>

#include <cmath>
#include <cstdint>

#include "diagnose/verdict.hpp"
#include "diagnose/warnings.hpp"
#include "reconstruct/engine.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using diagnose::Findings;
using diagnose::NormalsVerdict;

/// Of a whole run.
Findings findings(const Cloud& cloud, const Options& options = {{.depth = 7}}) {
  RunReport report;
  const auto field = detail::Engine(Device::cpu(2)).solve(cloud, options, false, report);
  Mesh mesh;
  field->extract_and_release(mesh, report);
  return diagnose::findings_of(field->seen());
}

NormalsVerdict verdict(const Cloud& cloud, const Options& options = {{.depth = 7}}) {
  return diagnose::judge_normals(findings(cloud, options), options.boundary == Boundary::free);
}

void turn(Vec3f& n) { n = {-n.x, -n.y, -n.z}; }

Cloud with_flips(Cloud cloud, double share, std::uint64_t seed) {
  test::Random random(seed);
  for (Vec3f& n : cloud.normals)
    if (random.unit() < share) turn(n);
  return cloud;
}

/// All normals beyond x = `from` turned.
Cloud with_flipped_part(Cloud cloud, float from) {
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)
    if (cloud.positions[i].x > from) turn(cloud.normals[i]);
  return cloud;
}

/// So many more points in the box around the cloud, with random normals.
Cloud with_outliers(Cloud cloud, std::int64_t count, std::uint64_t seed) {
  test::Random random(seed);
  for (std::int64_t i = 0; i < count; ++i) {
    const Vec3d n = random.direction();
    cloud.positions.push_back({static_cast<float>(random.in(-1.35, 1.35)), static_cast<float>(random.in(-1.35, 1.35)),
                               static_cast<float>(random.in(-0.35, 0.35))});
    cloud.normals.push_back({static_cast<float>(n.x), static_cast<float>(n.y), static_cast<float>(n.z)});
  }
  return cloud;
}

TEST(Look, FindsNothingWrongWithClosedShapes) {
  for (const Cloud& cloud :
       {test::sphere_cloud(20'000, 1), test::linked_tori_cloud(30'000, 2), test::box_cloud(20'000, 3),
        test::thin_plate_cloud(20'000, 4, 0.02), test::two_spheres_cloud(30'000, 5, 0.02)}) {
    const Findings seen = findings(cloud);
    EXPECT_LT(seen.opposed, 0.001);
    EXPECT_EQ(seen.faces_inside, 0);
    EXPECT_LT(seen.openness, 0.03);
    EXPECT_GT(seen.volume, 0);
    EXPECT_LT(seen.off, 0.01);
    EXPECT_EQ(seen.far, 0);
    EXPECT_EQ(seen.caps, 0);
    EXPECT_EQ(diagnose::judge_normals(seen, true), NormalsVerdict::consistent);
  }
}

TEST(Look, CountsFlippedNormals) {
  const Cloud torus = test::torus_cloud(50'000, 6);
  for (const double share : {0.02, 0.1, 0.3, 0.5}) {
    const Findings seen = findings(with_flips(torus, share, 7));
    // 24,000 pairs: a share s of flips opposes 2 s (1 - s) of them, so s is known to about 0.003 / (1 - 2 s).
    EXPECT_NEAR(seen.opposed, 2 * share * (1 - share), 0.02) << share;
    if (share < 0.4) {
      EXPECT_NEAR(seen.flipped, share, 0.03) << share;
    }
    EXPECT_TRUE(seen.is_chance);
    const NormalsVerdict verdict = diagnose::judge_normals(seen, true);
    EXPECT_EQ(verdict, share < 0.05 ? NormalsVerdict::suspicious : NormalsVerdict::wrong);
  }
}

TEST(Look, AsksNoOutliersForTheirNormals) {
  const Cloud torus = test::torus_cloud(50'000, 22);
  const Findings seen = findings(with_outliers(torus, 2'500, 23));
  EXPECT_LT(seen.opposed, 0.0015);
  EXPECT_EQ(diagnose::judge_normals(seen, true), NormalsVerdict::consistent);
  const Findings flips = findings(with_outliers(with_flips(torus, 0.1, 24), 2'500, 23));
  EXPECT_NEAR(flips.flipped, 0.1, 0.01);  // those of the surface are still seen
  EXPECT_EQ(diagnose::judge_normals(flips, true), NormalsVerdict::wrong);
}

TEST(Look, TellsTheSidesOfThinWallsFromFlips) {
  // A third of a spacing thick: most neighbours lie on the other side.
  const Cloud plate = test::thin_plate_cloud(10'000, 8, 0.01);
  EXPECT_EQ(verdict(plate), NormalsVerdict::consistent);
  EXPECT_LT(findings(plate).flipped, 0.01);
  EXPECT_EQ(verdict(with_flips(plate, 0.3, 9)), NormalsVerdict::wrong);
}

TEST(Look, SeesThatACloudIsInsideOut) {
  for (const Options& options :
       {Options{{.depth = 6}}, Options{{.depth = 6, .boundary = Boundary::dirichlet}},
        Options{{.depth = 6, .field = FieldKind::distance}}, Options{{.depth = 6, .screening = 0}}}) {
    for (const Cloud& cloud : {test::sphere_cloud(10'000, 10), test::linked_tori_cloud(20'000, 11)}) {
      EXPECT_EQ(verdict(cloud, options), NormalsVerdict::consistent);
      EXPECT_EQ(verdict(test::flipped(cloud), options), NormalsVerdict::inside_out);
    }
  }
}

TEST(Look, SuspectsPartsThatAreTurned) {
  const Cloud torus = test::torus_cloud(30'000, 12);
  for (const float from : {0.0F, 0.5F, 0.9F})
    EXPECT_EQ(verdict(with_flipped_part(torus, from)), NormalsVerdict::suspicious)
        << from << ": opposed " << findings(with_flipped_part(torus, from)).opposed << ", faces "
        << findings(with_flipped_part(torus, from)).faces_inside;
  Cloud apart = test::sphere_cloud(20'000, 13);  // no neighbour disagrees here
  test::append(apart, test::flipped(test::sphere_cloud(20'000, 14, 1, {3, 0, 0})));
  EXPECT_EQ(verdict(apart), NormalsVerdict::suspicious);
}

TEST(Look, LeavesOpenSurfacesInPeace) {
  const Findings seen = findings(test::plane_cloud(30'000, 15));
  EXPECT_EQ(diagnose::judge_normals(seen, true), NormalsVerdict::consistent);
  EXPECT_GT(seen.openness, 0.99);
  EXPECT_GT(seen.faces_inside, 0.1);
  EXPECT_GT(seen.caps, 0.2);
}

TEST(Look, MeasuresSpacing) {
  // n samples of a sphere of radius 1 in a cube of side 2.2: sqrt(4 pi / n) apart.
  for (const std::int64_t n : {5'000, 80'000}) {
    const double cell = 2.2 / 128;
    EXPECT_NEAR(findings(test::sphere_cloud(n, 16)).spacing * cell,
                std::sqrt(4 * 3.14159265358979 / static_cast<double>(n)),
                0.15 * std::sqrt(12.6 / static_cast<double>(n)));
  }
}

TEST(Look, IsTheSameForAnyOrderAndThreads) {
  const Cloud cloud = with_flips(test::torus_cloud(20'000, 17), 0.1, 18);
  const auto seen = [](const Cloud& points, int threads) {
    RunReport report;
    return detail::Engine(Device::cpu(threads)).solve(points, {{.depth = 7}}, false, report)->seen();
  };
  const diagnose::Counts one = seen(cloud, 1);
  const diagnose::Counts other = seen(test::shuffled(cloud, 19), 5);
  for (int i = 0; i < diagnose::kSums; ++i) EXPECT_EQ(one.sums[i], other.sums[i]) << i;
  for (int i = 0; i < diagnose::kDensityBins; ++i) EXPECT_EQ(one.densities[i], other.densities[i]) << i;
}

TEST(Look, BinsDensitiesByQuarterOctaves) {
  for (const float density : {1e-12F, 0.001F, 0.24F, 1.0F, 3.7F, 1e5F}) {
    const int bin = diagnose::DensityBin::of(density);
    EXPECT_LE(diagnose::DensityBin::value(bin), density);
    EXPECT_GT(diagnose::DensityBin::value(bin + 1), density);
    EXPECT_LE(diagnose::DensityBin::value(bin + 1), 1.3 * diagnose::DensityBin::value(bin));
  }
  EXPECT_EQ(diagnose::DensityBin::of(0), 0);
  EXPECT_EQ(diagnose::DensityBin::of(1e30F), diagnose::kDensityBins - 1);
}

TEST(SupportedDepth, HasCellsAsWideAsSpacingAndTwiceTheNoise) {
  EXPECT_EQ(diagnose::supported_depth(1, std::ldexp(1, -8) / std::sqrt(0.75), 0), 8);
  EXPECT_EQ(diagnose::supported_depth(1, 1e-9, std::ldexp(1, -8)), 7);
  EXPECT_EQ(diagnose::supported_depth(1, 1e-9, 0), 16);
  EXPECT_EQ(diagnose::supported_depth(1, 1, 1), 4);
}

}  // namespace
}  // namespace pointskin
