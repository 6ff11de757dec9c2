// The virtual scanner: rays against brute force, and points, normals and faults that are what was asked for.
#include "scan.hpp"

#include <gtest/gtest.h>

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <string>

#include "core/vec3.hpp"
#include "random.hpp"

namespace pointskin::bench {
namespace {

constexpr ScanOptions kQuick{.views = 6, .resolution = 60};

Vec3d random_point(Random& random) {
  return {2 * random.uniform() - 1, 2 * random.uniform() - 1, 2 * random.uniform() - 1};
}

Mesh random_triangles(int count) {
  Mesh mesh;
  mesh.origin = {10, 20, 30};
  Random random(1, 0);
  for (std::int32_t i = 0; i < count; ++i) {
    const Vec3d centre = random_point(random);
    for (int corner = 0; corner < 3; ++corner) mesh.vertices.push_back(to_float(centre + 0.2 * random_point(random)));
    mesh.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
  }
  return mesh;
}

TEST(RayTree, FindsTheFirstTriangleOfMany) {
  const Mesh mesh = random_triangles(500);
  const RayTree tree(mesh);
  Random random(2, 0);
  int hits = 0;
  for (int i = 0; i < 2'000; ++i) {
    const Ray ray{mesh.origin + 3 * random_point(random), normalized(random_point(random))};
    double nearest = std::numeric_limits<double>::infinity();
    for (const Triangle& t : mesh.triangles) {  // a tree of one triangle has no boxes to go wrong
      Mesh alone;
      alone.origin = mesh.origin;
      for (const std::int32_t vertex : t) alone.vertices.push_back(mesh.vertices[static_cast<std::size_t>(vertex)]);
      alone.triangles = {{0, 1, 2}};
      if (const auto hit = RayTree(alone).first_hit(ray)) nearest = std::min(nearest, hit->range);
    }
    const auto hit = tree.first_hit(ray);
    ASSERT_EQ(hit.has_value(), std::isfinite(nearest)) << "ray " << i;
    if (!hit) continue;
    EXPECT_EQ(hit->range, nearest);
    ++hits;
  }
  EXPECT_GT(hits, 100);
}

TEST(RayTree, LetsNoRaySlipThroughEdgesAndCorners) {
  Mesh square;  // of four triangles around the origin, in the plane z = 0
  square.vertices = {{-1, -1, 0}, {1, -1, 0}, {1, 1, 0}, {-1, 1, 0}, {0, 0, 0}};
  square.triangles = {{0, 1, 4}, {1, 2, 4}, {2, 3, 4}, {3, 0, 4}};
  const RayTree tree(square);
  for (int i = -9; i <= 9; ++i) {
    for (const double sign : {-1.0, 1.0}) {
      const Vec3d target = {i / 10.0, sign * i / 10.0, 0}, from = {0.3, 0.2, 2};
      const auto hit = tree.first_hit({from, normalized(target - from)});
      ASSERT_TRUE(hit) << i;
      EXPECT_NEAR(hit->range, length(target - from), 1e-12);
      EXPECT_EQ(hit->normal, (Vec3d{0, 0, 1}));
    }
  }
  EXPECT_FALSE(tree.first_hit({{0, 0, 2}, {0, 0, 1}}));  // behind
}

TEST(Scene, TracesASphereAsTheFormulaHasIt) {
  const auto shape = make_shape("sphere");
  const auto scene = scene_of(*shape);
  Random random(3, 0);
  for (int i = 0; i < 2'000; ++i) {
    const Vec3d from = 4 * normalized(random_point(random));
    const Vec3d along = normalized(1.2 * random_point(random) - from);
    const double middle = -dot(from, along), under = 1 - (16 - middle * middle);
    const auto hit = scene->first_hit({from, along});
    if (std::abs(under) < 1e-3) continue;  // grazing
    ASSERT_EQ(hit.has_value(), under > 0);
    if (!hit) continue;
    EXPECT_NEAR(hit->range, middle - std::sqrt(under), 1e-6);
    EXPECT_GT(dot(hit->normal, from + hit->range * along), 1 - 1e-6);
  }
}

class ScanOf : public testing::TestWithParam<const char*> {
 protected:
  std::unique_ptr<Shape> shape_ = make_shape(GetParam());
  std::unique_ptr<Scene> scene_ = scene_of(*shape_);
};

TEST_P(ScanOf, LiesOnTheSurfaceWithoutNoise) {
  const Cloud cloud = scan(*scene_, kQuick);
  EXPECT_GT(cloud.size(), 500);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i)
    ASSERT_LT(std::abs(signed_distance(*shape_, to_double(cloud.positions[i]))), 3e-6);
}

TEST_P(ScanOf, HasNormalsThatFaceOutwards) {
  ScanOptions options = kQuick;
  options.normals = ScanNormals::exact;
  const Cloud cloud = scan(*scene_, options);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3d gradient = normalized(shape_->at(to_double(cloud.positions[i])).gradient);
    ASSERT_GT(dot(gradient, to_double(cloud.normals[i])), 0.99);
  }
}

TEST_P(ScanOf, IsTheSameForAnyNumberOfThreads) {
  ScanOptions one = kQuick;
  one.sigma = one.misregistration = 0.002, one.outliers = 0.05, one.threads = 1;
  ScanOptions three = one, other = one;
  three.threads = 3, other.seed = 2;
  const Cloud a = scan(*scene_, one), b = scan(*scene_, three), c = scan(*scene_, other);
  EXPECT_EQ(a.positions, b.positions);
  EXPECT_EQ(a.normals, b.normals);
  EXPECT_NE(a.positions, c.positions);
}

INSTANTIATE_TEST_SUITE_P(Bench, ScanOf, testing::Values("torus", "knot", "slab", "gyroid"),
                         [](const auto& info) { return std::string(info.param); });

/// The cloud of a unit sphere, and its points' distances from the centre.
class ScanOfSphere : public testing::Test {
 protected:
  std::unique_ptr<Shape> shape_ = make_shape("sphere");
  std::unique_ptr<Scene> scene_ = scene_of(*shape_);

  static double rms_height(const Cloud& cloud) {
    double sum = 0;
    for (const Vec3f& p : cloud.positions) sum += std::pow(length(to_double(p)) - 1, 2);
    return std::sqrt(sum / static_cast<double>(cloud.size()));
  }
};

TEST_F(ScanOfSphere, FitsNormalsToTheImage) {
  ScanOptions options = kQuick;
  options.resolution = 400;
  const auto mean_angle = [&](double sigma, int window) {
    options.sigma = sigma, options.window = window;
    const Cloud cloud = scan(*scene_, options);
    double sum = 0;
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      const double cosine = dot(normalized(to_double(cloud.positions[i])), to_double(cloud.normals[i]));
      sum += std::acos(std::min(1.0, cosine));
    }
    return sum / static_cast<double>(cloud.size());
  };
  const double noisy = mean_angle(0.001, 1);
  EXPECT_LT(mean_angle(0, 1), 0.01);
  EXPECT_GT(noisy, 0.05);  // noise of the ranges shows in the normals
  EXPECT_LT(mean_angle(0.001, 2), 0.6 * noisy);
}

TEST_F(ScanOfSphere, HasNoiseOfTheGivenSigmaAlongTheRays) {
  ScanOptions options = kQuick;
  options.normals = ScanNormals::exact, options.grazing = 20;  // rays along the normals, nearly
  options.sigma = 0.002, options.resolution = 300;
  // A ray at an angle a to the normal moves its point by cos a along the normal: mean square (1 + cos 20 + cos^2 20) /
  // 3 over a cap.
  EXPECT_NEAR(rms_height(scan(*scene_, options)) / (0.002 * scene_->diagonal()), 0.97, 0.02);
}

TEST_F(ScanOfSphere, MovesEachViewRigidlyByTheGivenSigma) {
  ScanOptions options = kQuick;
  options.views = 60, options.resolution = 20, options.misregistration = 0.01;
  // A turn leaves the sphere where it is. A shift s moves a point by s . n: one component of the three.
  EXPECT_NEAR(rms_height(scan(*scene_, options)), 0.01 * scene_->diagonal(), 0.004);
  options.views = 1;  // the mean motion is none
  EXPECT_LT(rms_height(scan(*scene_, options)), 1e-6);
}

TEST_F(ScanOfSphere, AddsTheShareOfOutliers) {
  ScanOptions options = kQuick;
  const auto clean = static_cast<double>(scan(*scene_, options).size());
  options.outliers = 0.1;
  const Cloud cloud = scan(*scene_, options);
  EXPECT_NEAR(static_cast<double>(cloud.size()) - clean, 0.1 * static_cast<double>(cloud.size()), 1);
  double far = 0;
  for (const Vec3f& p : cloud.positions) {
    EXPECT_LE(std::max({std::abs(p.x), std::abs(p.y), std::abs(p.z)}), 1.2001F);
    far += std::abs(length(to_double(p)) - 1) > 1e-3 ? 1 : 0;
  }
  EXPECT_NEAR(far, static_cast<double>(cloud.size()) - clean, 20);
}

TEST_F(ScanOfSphere, DropsGrazingPoints) {
  ScanOptions options = kQuick;
  options.views = 1, options.normals = ScanNormals::exact, options.spread = 0;
  options.grazing = 40;
  const Cloud cloud = scan(*scene_, options);
  // All seen points are within 40 degrees less the camera's parallax of the middle of the cap.
  Vec3d middle{0, 0, 0};
  for (const Vec3f& p : cloud.positions) middle += to_double(p);
  middle = normalized(middle);
  double widest = 1;
  for (const Vec3f& p : cloud.positions) widest = std::min(widest, dot(middle, to_double(p)));
  EXPECT_GT(widest, std::cos(40 * 3.14159 / 180));
  options.grazing = 80;
  EXPECT_GT(scan(*scene_, options).size(), cloud.size() * 3 / 2);
}

TEST_F(ScanOfSphere, IsDenserFromNearby) {
  ScanOptions near = kQuick, far = kQuick;
  near.spread = far.spread = 0;
  near.distance = 1;
  far.distance = 2;
  // With the same lens, twice the distance leaves about a quarter of the pixels; each lens fits its own scene here.
  far.spread = 0.5;
  EXPECT_GT(scan(*scene_, near).size(), scan(*scene_, far).size());
}

TEST(Scan, DoesNotSeeWhatIsHidden) {
  const auto shape = make_shape("nested");
  const Cloud cloud = scan(*scene_of(*shape), kQuick);
  for (const Vec3f& p : cloud.positions) EXPECT_NEAR(length(to_double(p)), 0.95, 1e-6);
}

TEST(Scan, OfAMeshIsThatOfItsTriangles) {
  Mesh box;
  for (int corner = 0; corner < 8; ++corner)
    box.vertices.push_back(
        {(corner & 1) != 0 ? 2.F : 0.F, (corner & 2) != 0 ? 1.F : 0.F, (corner & 4) != 0 ? 1.F : 0.F});
  box.triangles = {{0, 2, 1}, {1, 2, 3}, {4, 5, 6}, {5, 7, 6}, {0, 1, 4}, {1, 5, 4},
                   {2, 6, 3}, {3, 6, 7}, {0, 4, 2}, {2, 4, 6}, {1, 3, 5}, {3, 7, 5}};
  ScanOptions options = kQuick;
  options.normals = ScanNormals::exact;
  const Cloud cloud = scan(*scene_of(box), options);
  EXPECT_GT(cloud.size(), 1000);
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3d p = to_double(cloud.positions[i]);
    const double on_face = std::min(
        {std::abs(p[0]), std::abs(p[0] - 2), std::abs(p[1]), std::abs(p[1] - 1), std::abs(p[2]), std::abs(p[2] - 1)});
    EXPECT_LT(on_face, 1e-6);
    EXPECT_GT(dot(p - Vec3d{1, 0.5, 0.5}, to_double(cloud.normals[i])), 0);
  }
}

TEST(Scan, RefusesOptionsOutOfRange) {
  const auto shape = make_shape("sphere");
  const auto scene = scene_of(*shape);
  const auto refused = [&](auto change) {
    ScanOptions options = kQuick;
    change(options);
    EXPECT_THROW(scan(*scene, options), Error);
  };
  refused([](ScanOptions& o) { o.views = 0; });
  refused([](ScanOptions& o) { o.resolution = 2; });
  refused([](ScanOptions& o) { o.distance = 0.5; });
  refused([](ScanOptions& o) { o.spread = 1; });
  refused([](ScanOptions& o) { o.sigma = -1; });
  refused([](ScanOptions& o) { o.outliers = 1; });
  refused([](ScanOptions& o) { o.grazing = 0; });
  refused([](ScanOptions& o) { o.window = 0; });
  EXPECT_THROW(scene_of(Mesh{}), Error);
}

}  // namespace
}  // namespace pointskin::bench
