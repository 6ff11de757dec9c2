// The map of a deformation at single points: weights, transforms, lattices and Jacobians, against closed forms.
#include <gtest/gtest.h>

#include <pointskin/deform.hpp>
#include <pointskin/error.hpp>

#include <array>
#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "deform/deform_map.hpp"
#include "deform/prepare_deformation.hpp"
#include "deform/rotation.hpp"
#include "property/reconstruction.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using deform::Mapped;
using test::Random;

constexpr double kPi = std::numbers::pi;

/// A deformation that can be asked point by point.
class Map {
 public:
  explicit Map(const Deformation& deformation) : prepared_(deform::prepare(deformation, {})) {
    validate(deformation, 0);
  }
  Mapped operator()(const Vec3d& x) const {
    const deform::MapView view{{prepared_.handles.data(), static_cast<std::int64_t>(prepared_.handles.size())},
                               {prepared_.lattices.data(), static_cast<std::int64_t>(prepared_.lattices.size())},
                               {prepared_.moves.data(), static_cast<std::int64_t>(prepared_.moves.size())},
                               {},
                               0};
    return view(x, 0);
  }

 private:
  deform::PreparedDeformation prepared_;
};

void expect_near(const Vec3d& a, const Vec3d& b, double tolerance) {
  EXPECT_NEAR(a.x, b.x, tolerance);
  EXPECT_NEAR(a.y, b.y, tolerance);
  EXPECT_NEAR(a.z, b.z, tolerance);
}

Vec3d random_point(Random& random) { return {random.in(-2, 2), random.in(-2, 2), random.in(-2, 2)}; }

/// Compares the Jacobian with central differences at random points.
void expect_jacobian(const Deformation& deformation, std::uint64_t seed) {
  const Map map(deformation);
  Random random(seed);
  SCOPED_TRACE("seed " + std::to_string(seed));
  constexpr double kStep = 1e-5;
  for (int i = 0; i < 200; ++i) {
    const Vec3d x = random_point(random);
    const Matrix3 jacobian = map(x).jacobian;
    const auto slope = [&](const Vec3d& step) {
      return (map(x + step).position - map(x - step).position) * (0.5 / kStep);
    };
    expect_near(jacobian.x, slope({kStep, 0, 0}), 2e-7);
    expect_near(jacobian.y, slope({0, kStep, 0}), 2e-7);
    expect_near(jacobian.z, slope({0, 0, kStep}), 2e-7);
  }
}

TEST(SineAndCosine, AreWithinFourUnitsOfTheLastPlaceOfOne) {
  for (int i = 0; i <= 100000; ++i) {
    const double angle = 0.01 * i;
    const deform::SineCosine got = deform::sine_cosine(angle);
    ASSERT_NEAR(got.sine, std::sin(angle), 4e-16) << angle;
    ASSERT_NEAR(got.cosine, std::cos(angle), 4e-16) << angle;
  }
}

TEST(RotationTerms, AgreeWithTheirClosedFormsWhereTheseAreGood) {
  for (const double f : {0.3, 0.7, 0.999, 1.001, 2.0, 3.1, 6.0, 50.0}) {
    const deform::RotationTerms got = deform::rotation_terms(f * f);
    EXPECT_NEAR(got.one, std::sin(f) / f, 1e-14) << f;
    EXPECT_NEAR(got.two, (1 - std::cos(f)) / (f * f), 1e-14) << f;
    EXPECT_NEAR(got.three, (f - std::sin(f)) / (f * f * f), 1e-14) << f;
  }
}

TEST(PolarParts, GiveBackTheMatrixTheyWereMadeFrom) {
  Random random(11);
  for (int i = 0; i < 100; ++i) {
    const Vec3d axis = random.direction();
    const deform::Rotation rotation(axis * random.in(-3.1, 3.1));
    const Symmetric3 e{random.in(-0.5, 2),   random.in(-0.5, 2),   random.in(-0.5, 2),
                       random.in(-0.1, 0.1), random.in(-0.1, 0.1), random.in(-0.1, 0.1)};
    const auto image = [&](const Vec3d& v) { return rotation * (v + e * v); };
    const Vec3d x = image({1, 0, 0});
    const Vec3d y = image({0, 1, 0});
    const Vec3d z = image({0, 0, 1});
    const deform::PolarParts parts = deform::polar_parts({x.x, y.x, z.x, x.y, y.y, z.y, x.z, y.z, z.z});
    expect_near(parts.rotation, rotation.vector, 1e-12);
    EXPECT_NEAR(parts.stretch.xx, e.xx, 1e-12);
    EXPECT_NEAR(parts.stretch.yz, e.yz, 1e-12);
    EXPECT_NEAR(parts.stretch.xy, e.xy, 1e-12);
  }
}

TEST(PolarParts, OfTheIdentityAreExactlyNothing) {
  const deform::PolarParts parts = deform::polar_parts({1, 0, 0, 0, 1, 0, 0, 0, 1});
  EXPECT_EQ(dot(parts.rotation, parts.rotation), 0);
  EXPECT_EQ(parts.stretch.xx, 0);
  EXPECT_EQ(parts.stretch.yz, 0);
}

TEST(Handles, TwoOfThemBlendByTheShareOfTheDistances) {
  const RigidMotion up{.translation = {0, 0, 1}};
  const Map map({{{HalfSpace{{0, 0, 0}, {-1, 0, 0}}, RigidMotion{}}, {HalfSpace{{1, 0, 0}, {1, 0, 0}}, up}}, {}});
  for (const double t : {0.1, 0.25, 0.5, 0.8}) {
    const Mapped at = map({t, 3, 5});  // d0 / (d0 + d1) = t
    expect_near(at.position, {t, 3, 5 + t * t * (3 - 2 * t)}, 1e-15);
    EXPECT_NEAR(at.jacobian.x.z, 6 * t * (1 - t), 1e-14);
  }
  expect_near(map({-3, 0, 0}).position, {-3, 0, 0}, 0);
  expect_near(map({2, 0, 0}).position, {2, 0, 1}, 0);
}

TEST(Handles, BendBetweenHalfSpacesAlongAnArc) {
  // The middle of the zone turns by half of the angle, whatever the angle.
  for (const double angle : {0.5, kPi / 2, kPi, 5.0, 7 * kPi}) {
    const RigidMotion turn{.axis = {0, 0, 2}, .point = {0.5, 1, 0}, .angle = angle};
    const Map map({{{HalfSpace{{0, 0, 0}, {-1, 0, 0}}}, {HalfSpace{{1, 0, 0}, {1, 0, 0}}, turn}}, {}});
    const Mapped at = map({0.5, 0, 0});
    expect_near(at.position, {0.5 + std::sin(angle / 2), 1 - std::cos(angle / 2), 0}, 1e-13);
    const Mapped whole = map({2, 0, 0});
    expect_near(whole.position,
                {0.5 + 1.5 * std::cos(angle) + std::sin(angle), 1 + 1.5 * std::sin(angle) - std::cos(angle), 0}, 1e-13);
  }
}

TEST(Handles, WithOneTransformMoveEverythingByIt) {
  const RigidMotion turn{.axis = {1, 2, 3}, .point = {0.3, -0.2, 0.1}, .angle = 2.2, .translation = {1, -1, 0.5}};
  const Map one({{{Ball{{0, 0, 0}, 0.1}, turn}}, {}});
  const Map three({{{Ball{{0, 0, 0}, 0.1}, turn},
                    {Capsule{{1, 0, 0}, {1, 1, 0}, 0.2}, turn},
                    {AxisBox{{-2, -2, -2}, {-1, -1, -1}}, turn}},
                   {}});
  Random random(5);
  for (int i = 0; i < 100; ++i) {
    const Vec3d x = random_point(random);
    expect_near(three(x).position, one(x).position, 1e-13);
    const Matrix3 j = three(x).jacobian;
    EXPECT_NEAR(dot(j.x, cross(j.y, j.z)), 1, 1e-12);
    EXPECT_NEAR(dot(j.x, j.y), 0, 1e-12);
  }
}

TEST(Handles, OverlappingRegionsShareAlike) {
  const RigidMotion up{.translation = {0, 0, 1}};
  const Map map({{{Ball{{0, 0, 0}, 1}}, {Ball{{1, 0, 0}, 1}, up}}, {}});
  expect_near(map({0.5, 0, 0}).position, {0.5, 0, 0.5}, 1e-15);
}

TEST(Handles, RegionsMeasureDistances) {
  const auto distance = [](const HandleRegion& region, const Vec3d& x) {
    // Two equal shares lie where both distances are equal, so the other half-space tells the distance.
    const deform::PreparedDeformation prepared =
        deform::prepare({{{region, RigidMotion{.translation = {1, 0, 0}}}}, {}}, {});
    return deform::distance_to(prepared.handles[0], x, {}).distance;
  };
  EXPECT_DOUBLE_EQ(distance(HalfSpace{{0, 0, 1}, {0, 0, 7}}, {5, 5, -1}), 2);
  EXPECT_DOUBLE_EQ(distance(Ball{{1, 0, 0}, 0.5}, {1, 3, 0}), 2.5);
  EXPECT_DOUBLE_EQ(distance(AxisBox{{0, 0, 0}, {1, 1, 1}}, {4, 5, 0.5}), 5);
  EXPECT_DOUBLE_EQ(distance(Capsule{{0, 0, 0}, {2, 0, 0}, 0.5}, {1, 2, 0}), 1.5);
  EXPECT_DOUBLE_EQ(distance(Capsule{{0, 0, 0}, {2, 0, 0}, 0.5}, {5, 4, 0}), 4.5);
  EXPECT_DOUBLE_EQ(distance(AxisBox{{0, 0, 0}, {1, 1, 1}}, {0.5, 0.5, 0.5}), 0);
}

TEST(Jacobian, OfHandlesAgreesWithDifferences) {
  const RigidMotion turn{.axis = {0, 1, 1}, .point = {0.2, 0, -0.3}, .angle = 1.9, .translation = {0.2, 0.1, 0}};
  const AffineMap stretch{.matrix = {1.5, 0.2, 0, 0.3, -0.1, 0.7, 0.1, 0, 0, 0.3, 1.1, -0.2}, .pivot = {1, 1, 0}};
  expect_jacobian({{{Ball{{3, 0, 0}, 0.5}, turn}, {Ball{{-3, 0, 0}, 0.5}}}, {}}, 1);
  expect_jacobian({{{Ball{{3, 0, 0}, 0.5}, stretch}, {Ball{{-3, 0, 0}, 0.5}}}, {}}, 2);
  expect_jacobian({{{Ball{{3, 0, 0}, 0.5}, turn},
                    {HalfSpace{{0, -3, 0}, {0, -1, 0}}},
                    {Ball{{-3, 0.5, 0}, 0.5}, stretch},
                    {Ball{{0, 0, 4}, 1}, RigidMotion{.axis = {1, 0, 0}, .angle = -0.7}}},
                   {}},
                  3);
}

Lattice lattice_around(std::array<int, 3> spans) {
  Lattice lattice;
  lattice.origin = {-1, -1.5, -1};
  lattice.axes = {{{2, 0.1, 0}, {0, 3, 0.2}, {0.1, 0, 2}}};
  lattice.spans = spans;
  lattice.reset();
  return lattice;
}

void move_at_random(Lattice& lattice, std::uint64_t seed, double amount) {
  Random random(seed);
  for (Vec3d& point : lattice.control)
    for (std::size_t a = 0; a < 3; ++a) point[a] += random.in(-amount, amount);
}

TEST(Lattices, UnmovedAreExactlyTheIdentity) {
  const deform::PreparedDeformation prepared = deform::prepare({{}, {lattice_around({3, 2, 4})}}, {1, 2, 3});
  EXPECT_TRUE(prepared.identity);
}

TEST(Lattices, ReproduceAffineMapsInsideAndOut) {
  Lattice lattice = lattice_around({3, 2, 4});
  const auto affine = [](const Vec3d& p) {
    return Vec3d{1.2 * p[0] + 0.3 * p[1] + 0.5, 0.9 * p[1] - 0.2 * p[2], 0.1 * p[0] + 1.5 * p[2] - 1};
  };
  for (Vec3d& point : lattice.control) point = affine(point);
  const Map map({{}, {lattice}});
  Random random(17);
  for (int i = 0; i < 100; ++i) {
    const Vec3d x = random_point(random);
    const Vec3d expected = affine(x);
    expect_near(map(x).position, expected, 1e-12);
  }
}

TEST(Lattices, OfOneSpanAreTrilinear) {
  Lattice lattice;
  lattice.reset();
  lattice.control[lattice.index(1, 1, 1)] = {1, 1, 2};
  const Map map({{}, {lattice}});
  expect_near(map({0.5, 0.25, 0.75}).position, {0.5, 0.25, 0.75 + 0.5 * 0.25 * 0.75}, 1e-15);
}

TEST(Lattices, OutsidePointsStayWhereAskedTo) {
  Lattice lattice;
  lattice.reset();
  for (Vec3d& point : lattice.control) point[2] += 1;
  lattice.outside = Lattice::Outside::stay;
  const Map map({{}, {lattice}});
  expect_near(map({1.5, 0.5, 0.5}).position, {1.5, 0.5, 0.5}, 0);
  expect_near(map({0.5, 0.5, 0.5}).position, {0.5, 0.5, 1.5}, 1e-15);
}

TEST(Jacobian, OfLatticesAndChainsAgreesWithDifferences) {
  Lattice lattice = lattice_around({3, 2, 4});
  move_at_random(lattice, 23, 0.4);
  expect_jacobian({{}, {lattice}}, 4);
  Lattice second = lattice_around({1, 5, 2});
  move_at_random(second, 29, 0.3);
  const RigidMotion turn{.axis = {0, 1, 1}, .angle = 0.9};
  expect_jacobian({{{Ball{{3, 0, 0}, 0.5}, turn}, {Ball{{-3, 0, 0}, 0.5}}}, {lattice, second}}, 5);
}

TEST(Scaled, HalfOfADeformationTurnsAndStretchesByHalf) {
  Lattice lattice = lattice_around({1, 1, 1});
  lattice.control[0][0] += 1;
  const RigidMotion turn{.axis = {0, 0, 1}, .point = {1, 0, 0}, .angle = kPi, .translation = {0, 0, 2}};
  // Turned by 90 degrees about z, stretched by 3 along x.
  const AffineMap affine{.matrix = {0, -1, 0, 0, 3, 0, 0, 0, 0, 0, 1, 0}};
  const Deformation half = scaled({{{Ball{}, turn}, {Ball{}, affine}}, {lattice}}, 0.5);
  const auto& half_turn = std::get<RigidMotion>(half.handles[0].transform);
  EXPECT_DOUBLE_EQ(half_turn.angle, kPi / 2);
  EXPECT_DOUBLE_EQ(half_turn.translation[2], 1);
  const auto& half_affine = std::get<AffineMap>(half.handles[1].transform);
  EXPECT_NEAR(half_affine.matrix[0], 2 * std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(half_affine.matrix[4], 2 * std::sqrt(0.5), 1e-12);
  EXPECT_NEAR(half_affine.matrix[1], -std::sqrt(0.5), 1e-12);
  EXPECT_DOUBLE_EQ(half.lattices[0].control[0][0], lattice.rest_point(0, 0, 0)[0] + 0.5);
}

TEST(Validation, NamesWhatIsWrong) {
  const auto story = [](const Deformation& deformation) -> std::string {
    try {
      validate(deformation, 10);
    } catch (const Error& error) {
      EXPECT_EQ(error.code(), ErrorCode::usage);
      return error.what();
    }
    return "";
  };
  EXPECT_EQ(story({{{Ball{}}, {Ball{{}, -1}}}, {}}), "handles[1]: the radius must not be negative");
  EXPECT_NE(story({{{HalfSpace{{}, {0, 0, 0}}}}, {}}), "");
  EXPECT_NE(story({{{AxisBox{{1, 0, 0}, {0, 1, 1}}}}, {}}), "");
  EXPECT_NE(story({{{PointSet{}}}, {}}), "");
  EXPECT_NE(story({{{PointSet{{3, 10}}}}, {}}), "");
  EXPECT_EQ(story({{{PointSet{{3, 9}}}}, {}}), "");
  EXPECT_NE(story({{{Ball{}, RigidMotion{.axis = {0, 0, 0}, .angle = 1}}}, {}}), "");
  EXPECT_NE(story({{{Ball{}, RigidMotion{.angle = 2000}}}, {}}), "");
  EXPECT_NE(story({{{Ball{{std::numeric_limits<double>::quiet_NaN(), 0, 0}, 1}}}, {}}), "");
  EXPECT_NE(story({{{Ball{}, AffineMap{.matrix = {-1, 0, 0, 0, 0, 1, 0, 0, 0, 0, 1, 0}}}}, {}}), "");
  EXPECT_NE(story({{}, {Lattice{}}}), "");
  Lattice flat;
  flat.axes[2] = {1, 1, 0};
  flat.reset();
  EXPECT_NE(story({{}, {flat}}), "");
  EXPECT_NE(story({std::vector<Handle>(17, Handle{Ball{}, {}}), {}}), "");
}

}  // namespace
}  // namespace pointskin
