// Eigenvectors of matrices with known axes, and of any.
#include <gtest/gtest.h>

#include <cmath>

#include "core/eigen3.hpp"
#include "core/matrix3.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

TEST(Eigen3, GivesTheAxesOfARotatedEllipsoid) {
  test::Random random(9);
  for (int i = 0; i < 200; ++i) {
    // m = sum of values times outer products of an orthonormal frame
    const Vec3d a = random.direction();
    const Vec3d u{a[0], a[1], a[2]};
    const Vec3d b = random.direction();
    Vec3d v = cross(u, {b[0], b[1], b[2]});
    v = v * (1 / std::sqrt(dot(v, v)));
    const Vec3d w = cross(u, v);
    const double values[3] = {random.in(0, 1), random.in(1.1, 2), random.in(2.1, 3)};
    Symmetric3 m;
    const Vec3d axes[3] = {u, v, w};
    for (int k = 0; k < 3; ++k) m = m + outer(axes[k]) * values[k];
    const Eigen3 eigen = eigen_of(m);
    for (int k = 0; k < 3; ++k) {
      EXPECT_NEAR(eigen.values[k], values[k], 1e-12);
      EXPECT_NEAR(std::abs(dot(eigen.vectors[k], axes[k])), 1, 1e-12);
    }
  }
}

TEST(Eigen3, GivesOrthonormalVectorsAndTheMatrixBack) {
  test::Random random(10);
  for (int trial = 0; trial < 500; ++trial) {
    const auto entry = [&] { return trial % 3 == 0 ? 0.0 : random.in(-1, 1); };  // also diagonal ones
    const Symmetric3 m{random.in(-1, 1), random.in(-1, 1), random.in(-1, 1), entry(), entry(), entry()};
    const Eigen3 e = eigen_of(m);
    Symmetric3 back;
    for (int k = 0; k < 3; ++k) back = back + outer(e.vectors[k]) * e.values[k];
    for (const auto part :
         {&Symmetric3::xx, &Symmetric3::yy, &Symmetric3::zz, &Symmetric3::yz, &Symmetric3::xz, &Symmetric3::xy})
      ASSERT_NEAR(back.*part, m.*part, 1e-12);
    for (int a = 0; a < 3; ++a)
      for (int b = 0; b < 3; ++b) ASSERT_NEAR(dot(e.vectors[a], e.vectors[b]), a == b ? 1 : 0, 1e-12);
    ASSERT_LE(e.values[0], e.values[1]);
    ASSERT_LE(e.values[1], e.values[2]);
  }
}

TEST(Eigen3, OfZeroAreTheAxes) {
  const Eigen3 e = eigen_of({});
  for (int k = 0; k < 3; ++k) EXPECT_EQ(e.values[k], 0);
  EXPECT_EQ(std::abs(dot(e.vectors[0], cross(e.vectors[1], e.vectors[2]))), 1);
}

}  // namespace
}  // namespace pointskin
