// Set operations on shapes whose volume, topology and crease are known.
#include <gtest/gtest.h>

#include <pointskin/boolean.hpp>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <optional>
#include <string>
#include <utility>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

constexpr double kPi = std::numbers::pi;
constexpr BooleanOp kOps[] = {BooleanOp::unite, BooleanOp::intersect, BooleanOp::subtract,
                              BooleanOp::symmetric_difference};
constexpr Vec3d kFirst{0.01, 0.02, -0.013};
constexpr Vec3d kSecond{0.81, 0.62, -0.012};  // 1 apart, to 5e-7

BooleanResult combined(const BooleanOperand& a, const BooleanOperand& b, BooleanOp op, const BooleanOptions& options,
                       int threads = 2) {
  return Booleans(Device::cpu(threads)).combine(a, b, op, options);
}

BooleanOptions at_depth(int depth, Creases creases = Creases::sampled) {
  BooleanOptions options;
  options.reconstruction.depth = depth;
  options.creases = creases;
  return options;
}

void expect_solid(const Mesh& mesh, std::int64_t components, std::int64_t euler) {
  const MeshReport report = measure(mesh);
  EXPECT_TRUE(report.watertight());
  EXPECT_EQ(report.components, components);
  EXPECT_EQ(report.euler, euler);
}

double distance(const Vec3d& a, const Vec3d& b) { return std::hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]); }

/// Two unit spheres whose centres are 1 apart.
class TwoSpheres {
 public:
  explicit TwoSpheres(std::int64_t points)
      : a_(test::sphere_cloud(points, 1, 1, kFirst)), b_(test::sphere_cloud(points, 2, 1, kSecond)) {}

  [[nodiscard]] const Cloud& a() const { return a_; }
  [[nodiscard]] const Cloud& b() const { return b_; }
  /// Of the lens that both share: two caps of height 1/2.
  static double lens() { return 2 * kPi * 0.25 * (3 - 0.5) / 3; }
  static double volume(BooleanOp op) {
    const double ball = 4 * kPi / 3;
    switch (op) {
      case BooleanOp::unite:
        return 2 * ball - lens();
      case BooleanOp::intersect:
        return lens();
      case BooleanOp::subtract:
        return ball - lens();
      case BooleanOp::symmetric_difference:
        break;
    }
    return 2 * (ball - lens());
  }
  static double curve_radius() { return std::sqrt(0.75); }
  static double from_curve(const Vec3d& p) {
    const Vec3d axis{kSecond[0] - kFirst[0], kSecond[1] - kFirst[1], kSecond[2] - kFirst[2]};
    double along = -0.5;
    for (std::size_t k = 0; k < 3; ++k) along += axis[k] * (p[k] - kFirst[k]);
    const double to_middle = distance(p, {kFirst[0] + axis[0] / 2, kFirst[1] + axis[1] / 2, kFirst[2] + axis[2] / 2});
    return std::hypot(along, std::sqrt(std::max(0.0, to_middle * to_middle - along * along)) - curve_radius());
  }
  /// To the exact surface of the result.
  static double from_surface(const Vec3d& p, BooleanOp op) {
    const auto to_sphere = [&](const Vec3d& own, const Vec3d& other, bool is_first) {
      const double r = distance(p, own);
      const Vec3d foot{own[0] + (p[0] - own[0]) / r, own[1] + (p[1] - own[1]) / r, own[2] + (p[2] - own[2]) / r};
      const bool outside = distance(foot, other) >= 1;
      const bool kept = op == BooleanOp::unite       ? outside
                        : op == BooleanOp::intersect ? !outside
                        : op == BooleanOp::subtract  ? outside == is_first
                                                     : true;
      return kept ? std::abs(r - 1) : 1e9;
    };
    return std::min({from_curve(p), to_sphere(kFirst, kSecond, true), to_sphere(kSecond, kFirst, false)});
  }
  static double cell(int depth) { return 1.1 * 2.8 / (1 << depth); }

 private:
  Cloud a_, b_;
};

/// Farthest vertex from the exact surface near the curve, and the rms of all others, in cells.
std::pair<double, double> errors_of(const Mesh& mesh, BooleanOp op, double cell) {
  double near = 0, squares = 0;
  std::int64_t others = 0;
  for (const Vec3f& v : mesh.vertices) {
    const Vec3d p{v.x, v.y, v.z};
    const double error = TwoSpheres::from_surface(p, op) / cell;
    if (TwoSpheres::from_curve(p) < 4 * cell) {
      near = std::max(near, error);
    } else {
      squares += error * error;
      ++others;
    }
  }
  return {near, std::sqrt(squares / static_cast<double>(others))};
}

TEST(Booleans, OfTwoSpheresHaveTheVolumesTheTopologyAndTheCrease) {
  const TwoSpheres spheres(60'000);
  const Mesh plain = test::reconstructed(spheres.a(), {{.depth = 7}});
  double plain_squares = 0;
  for (const Vec3f& v : plain.vertices) plain_squares += std::pow(distance({v.x, v.y, v.z}, kFirst) - 1, 2);
  const double plain_rms = std::sqrt(plain_squares / static_cast<double>(plain.vertices.size()));
  const double cell = TwoSpheres::cell(7);
  for (const BooleanOp op : kOps) {
    SCOPED_TRACE(static_cast<int>(op));
    const BooleanResult result = combined(spheres.a(), spheres.b(), op, at_depth(7));
    const bool apart = op == BooleanOp::symmetric_difference;
    expect_solid(result.mesh, apart ? 2 : 1, apart ? 4 : 2);
    EXPECT_NEAR(measure(result.mesh).volume / TwoSpheres::volume(op), 1, 0.005);
    const auto [near, rms] = errors_of(result.mesh, op, cell);
    EXPECT_LT(near, 1);
    EXPECT_LT(rms * cell, 1.1 * plain_rms + 0.002 * cell);
    EXPECT_NEAR(result.report.curve_length, 2 * kPi * TwoSpheres::curve_radius(), 0.05);
    EXPECT_GT(result.report.added, 3 * kPi * TwoSpheres::curve_radius() / cell);
    EXPECT_EQ(result.report.a.kept + result.report.b.kept + result.report.added, result.cloud.size());
    EXPECT_EQ(result.report.a.points, 60'000);
    EXPECT_EQ(result.report.a.kept + result.report.a.dropped, 60'000);
  }
}

TEST(Booleans, PointsAreThoseOfTheExactSurface) {
  const TwoSpheres spheres(20'000);
  for (const BooleanOp op : kOps) {
    const BooleanResult result = combined(spheres.a(), spheres.b(), op, at_depth(6));
    const Cloud& cloud = result.cloud;
    ASSERT_TRUE(cloud.has_normals());
    std::int64_t wrong = 0;
    for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
      const Vec3f& p = cloud.positions[i];
      const Vec3f& n = cloud.normals[i];
      const Vec3d at{p.x, p.y, p.z};
      const double cell = TwoSpheres::cell(6);
      if (TwoSpheres::from_surface(at, op) > 0.2 * cell) ++wrong;
      if (TwoSpheres::from_curve(at) < cell) continue;
      // Just inside along the normal the result is there, just outside it is not.
      const auto belongs = [&](double t) {
        const Vec3d q{at[0] + t * n.x, at[1] + t * n.y, at[2] + t * n.z};
        const bool a = distance(q, kFirst) < 1;
        const bool b = distance(q, kSecond) < 1;
        return op == BooleanOp::unite       ? a || b
               : op == BooleanOp::intersect ? a && b
               : op == BooleanOp::subtract  ? a && !b
                                            : a != b;
      };
      if (!belongs(-0.3 * cell) || belongs(0.3 * cell)) ++wrong;
    }
    EXPECT_EQ(wrong, 0) << static_cast<int>(op);
  }
}

TEST(Booleans, SamplesAlongTheCreaseMakeItSharper) {
  const TwoSpheres spheres(8'000);  // about one a cell
  const double cell = TwoSpheres::cell(7);
  for (const BooleanOp op : {BooleanOp::unite, BooleanOp::intersect, BooleanOp::subtract}) {
    const auto near = [&](Creases creases) {
      return errors_of(combined(spheres.a(), spheres.b(), op, at_depth(7, creases)).mesh, op, cell).first;
    };
    const double sampled = near(Creases::sampled);
    EXPECT_LT(sampled, 0.9 * near(Creases::none)) << static_cast<int>(op);
    EXPECT_LT(sampled, 1) << static_cast<int>(op);
  }
}

std::optional<ErrorCode> error_of(const BooleanOperand& a, const BooleanOperand& b, BooleanOp op, int depth = 6) {
  return test::error_of([&] { (void)combined(a, b, op, at_depth(depth)); });
}

TEST(Booleans, OfASolidWithItselfAreItOrNothing) {
  const Cloud torus = test::torus_cloud(20'000, 3);
  const Cloud noisy = test::jittered(torus, 4, 0.03);
  for (const Cloud* a : {&torus, &noisy}) {
    const Cloud again = test::shuffled(*a, 5);
    const Mesh plain = test::reconstructed(*a, {{.depth = 6}});
    for (const BooleanOp op : {BooleanOp::unite, BooleanOp::intersect}) {
      const BooleanResult result = combined(*a, again, op, at_depth(6));
      EXPECT_EQ(result.report.a.kept, a->size());
      EXPECT_EQ(result.report.b.kept, 0);
      EXPECT_EQ(result.report.added, 0);
      test::expect_same_bytes(result.mesh, plain);
    }
    EXPECT_EQ(error_of(*a, again, BooleanOp::subtract), ErrorCode::empty_result);
    EXPECT_EQ(error_of(*a, again, BooleanOp::symmetric_difference), ErrorCode::empty_result);
  }
}

TEST(Booleans, OfTwoSamplingsOfOneSolidAreItOrNothing) {
  const Cloud a = test::torus_cloud(20'000, 3);
  const Cloud b = test::torus_cloud(30'000, 9);
  expect_solid(combined(a, b, BooleanOp::unite, at_depth(6)).mesh, 1, 0);
  expect_solid(combined(a, b, BooleanOp::intersect, at_depth(6)).mesh, 1, 0);
  EXPECT_EQ(error_of(a, b, BooleanOp::subtract), ErrorCode::empty_result);
  EXPECT_EQ(error_of(a, b, BooleanOp::symmetric_difference), ErrorCode::empty_result);
}

TEST(Booleans, OfDisjointSolids) {
  const Cloud a = test::sphere_cloud(10'000, 1, 1, {-1.5, 0, 0});
  const Cloud b = test::sphere_cloud(10'000, 2, 1, {1.5, 0, 0});
  expect_solid(combined(a, b, BooleanOp::unite, at_depth(6)).mesh, 2, 4);
  expect_solid(combined(a, b, BooleanOp::symmetric_difference, at_depth(6)).mesh, 2, 4);
  const BooleanResult difference = combined(a, b, BooleanOp::subtract, at_depth(6));
  expect_solid(difference.mesh, 1, 2);
  EXPECT_EQ(difference.report.curve_length, 0);
  EXPECT_EQ(error_of(a, b, BooleanOp::intersect), ErrorCode::empty_result);
}

TEST(Booleans, OfNestedSolids) {
  const Cloud outer = test::sphere_cloud(20'000, 1, 1);
  const Cloud inner = test::sphere_cloud(5'000, 2, 0.5, {0.1, 0, 0});
  EXPECT_EQ(combined(outer, inner, BooleanOp::unite, at_depth(6)).report.b.kept, 0);
  EXPECT_EQ(combined(outer, inner, BooleanOp::intersect, at_depth(6)).report.a.kept, 0);
  EXPECT_EQ(error_of(inner, outer, BooleanOp::subtract), ErrorCode::empty_result);
  const BooleanResult hollow = combined(outer, inner, BooleanOp::subtract, at_depth(6));
  EXPECT_EQ(hollow.report.b.flipped, 5'000);
  expect_solid(hollow.mesh, 2, 4);
  EXPECT_NEAR(measure(hollow.mesh).volume, 4 * kPi / 3 * (1 - 0.125), 0.02);
}

TEST(Booleans, OfABoxAndASphereByPointsOrByMesh) {
  const Cloud box = test::box_cloud(60'000, 1);
  const Mesh box_mesh = test::box_mesh({-1, -1, -1}, {1, 1, 1});
  const Cloud ball = test::sphere_cloud(60'000, 2, 0.8, {1, 0, 0});
  const Mesh ball_mesh = test::icosphere_mesh(5, 0.8, {1, 0, 0});
  const double half_ball = 2 * kPi / 3 * std::pow(0.8, 3);
  const BooleanOperand boxes[] = {box, box_mesh};
  const BooleanOperand balls[] = {ball, ball_mesh};
  for (const BooleanOperand& a : boxes)
    for (const BooleanOperand& b : balls) {
      const BooleanResult difference = combined(a, b, BooleanOp::subtract, at_depth(7));
      expect_solid(difference.mesh, 1, 2);
      EXPECT_NEAR(measure(difference.mesh).volume / (8 - half_ball), 1, 0.005);
    }
  const BooleanResult both = combined(box_mesh, ball, BooleanOp::unite, at_depth(7));
  expect_solid(both.mesh, 1, 2);
  EXPECT_NEAR(measure(both.mesh).volume / (8 + half_ball), 1, 0.005);
  EXPECT_NEAR(both.report.curve_length, 1.6 * kPi, 0.05);
}

TEST(Booleans, OfTouchingAndFlushBoxesHaveNoShreds) {
  const Cloud a = test::box_cloud(40'000, 1, {-1, -1, -1}, {0, 1, 1});
  const Cloud touching = test::box_cloud(40'000, 2, {0, -1, -1}, {1, 1, 1});  // shares a whole face from outside
  const BooleanResult joined = combined(a, touching, BooleanOp::unite, at_depth(6));
  expect_solid(joined.mesh, 1, 2);
  EXPECT_NEAR(measure(joined.mesh).volume, 8, 0.15);
  const BooleanResult apart = combined(a, touching, BooleanOp::subtract, at_depth(6));
  expect_solid(apart.mesh, 1, 2);
  EXPECT_NEAR(measure(apart.mesh).volume, 4, 0.1);

  const Cloud flush = test::box_cloud(40'000, 3, {-0.5, -1, -1}, {1, 1, 1});  // four faces in common planes
  expect_solid(combined(a, flush, BooleanOp::unite, at_depth(6)).mesh, 1, 2);
  const BooleanResult cut = combined(a, flush, BooleanOp::subtract, at_depth(6));
  expect_solid(cut.mesh, 1, 2);
  EXPECT_NEAR(measure(cut.mesh).volume, 2, 0.1);
}

TEST(Booleans, GiveTheSameBytesForAnyThreadsAndOrder) {
  const TwoSpheres spheres(8'000);
  for (const BooleanOp op : kOps) {
    const BooleanResult expected = combined(spheres.a(), spheres.b(), op, at_depth(6), 1);
    const BooleanResult result =
        combined(test::shuffled(spheres.a(), 7), test::shuffled(spheres.b(), 8), op, at_depth(6), 3);
    test::expect_same_bytes(result.mesh, expected.mesh);
    EXPECT_EQ(result.report.curve_length, expected.report.curve_length);
    EXPECT_EQ(result.report.added, expected.report.added);
  }
}

TEST(Booleans, TakeCloudsWithOtherOrigins) {
  const Cloud a = test::sphere_cloud(8'000, 1, 1, {});
  Cloud b = test::sphere_cloud(8'000, 2, 1, {});  // the same place as 1 unit along x from A
  b.origin = {5, 0, 0};
  for (Vec3f& p : b.positions) p.x -= 4;
  const BooleanResult result = combined(a, b, BooleanOp::intersect, at_depth(6));
  EXPECT_EQ(result.mesh.origin, a.origin);
  EXPECT_NEAR(measure(result.mesh).volume / TwoSpheres::lens(), 1, 0.02);
}

TEST(Booleans, RefuseWhatTheyCannotTake) {
  const Cloud a = test::sphere_cloud(1'000, 1);
  const auto code = [&](const BooleanOptions& options) {
    return test::error_of([&] { (void)combined(a, a, BooleanOp::unite, options); });
  };
  BooleanOptions options = at_depth(5);
  options.coincidence_cells = -1;
  EXPECT_EQ(code(options), ErrorCode::usage);
  options = at_depth(21);
  EXPECT_EQ(code(options), ErrorCode::usage);
  options = at_depth(5);
  options.reconstruction.attributes = true;
  EXPECT_EQ(code(options), ErrorCode::usage);
  options = at_depth(5);
  options.reconstruction.offset = 0.1;
  EXPECT_EQ(code(options), ErrorCode::usage);
  options = at_depth(5);
  options.reconstruction.field = FieldKind::distance;
  EXPECT_EQ(code(options), ErrorCode::usage);
  EXPECT_EQ(error_of(a, Cloud(), BooleanOp::unite), ErrorCode::empty_result);
  EXPECT_EQ(error_of(a, test::patch_mesh(4), BooleanOp::unite), ErrorCode::invalid_input);
  EXPECT_EQ(error_of(test::flipped(test::box_mesh()), a, BooleanOp::unite), ErrorCode::invalid_input);
  options = at_depth(5);
  options.reconstruction.progress = [](const Progress& p) { return p.fraction < 0.5; };
  EXPECT_EQ(code(options), ErrorCode::interrupted);
}

TEST(Booleans, ReportProgressThatNeverDecreases) {
  const Cloud a = test::sphere_cloud(1'000, 1);
  const Cloud b = test::sphere_cloud(1'000, 1, 1, {1, 0, 0});
  BooleanOptions options = at_depth(5);
  std::vector<double> fractions;
  options.reconstruction.progress = [&](const Progress& p) {
    fractions.push_back(p.fraction);
    return true;
  };
  (void)combined(a, b, BooleanOp::unite, options);
  EXPECT_TRUE(std::is_sorted(fractions.begin(), fractions.end()));
  EXPECT_GE(fractions.size(), 9);
  EXPECT_LE(fractions.back(), 1);
}

TEST(Booleans, OfScans) {
  const std::optional<Cloud> bunny = test::shared_cloud("bunny_scans");
  if (!bunny) GTEST_SKIP() << "needs ../shared/data/bunny_scans.ply";
  const Bounds box = bounds_of(bunny->positions);
  const float size = box.upper.x - box.lower.x;
  Cloud torus = test::scaled(test::torus_cloud(100'000, 3, 1, 0.3), 0.3F * size);
  torus = test::translated(test::axes_rotated(torus), {(box.lower.x + box.upper.x) / 2, (box.lower.y + box.upper.y) / 2,
                                                       (box.lower.z + box.upper.z) / 2});
  torus.origin = bunny->origin;
  const BooleanOptions options = at_depth(7);
  for (const BooleanOp op : kOps) {
    const MeshReport report = measure(combined(*bunny, torus, op, options).mesh);
    EXPECT_TRUE(report.watertight()) << static_cast<int>(op);
  }
  EXPECT_EQ(error_of(*bunny, *bunny, BooleanOp::subtract, 7), ErrorCode::empty_result);
  EXPECT_EQ(error_of(*bunny, *bunny, BooleanOp::symmetric_difference, 7), ErrorCode::empty_result);
}

}  // namespace
}  // namespace pointskin
