// Distances to the surface of a fitted field, against a sphere and against the field's values.
#include <gtest/gtest.h>

#include <pointskin/reconstruct.hpp>

#include <cmath>
#include <memory>
#include <vector>

#include "field/evaluate.hpp"
#include "field/surface_distance.hpp"
#include "reconstruct/fit_field.hpp"
#include "support/shapes.hpp"
#include "support/spaces.hpp"

namespace pointskin::field {
namespace {

class SurfaceDistances : public testing::Test {
 protected:
  SurfaceDistances() {
    Options options;
    options.depth = 6;
    detail::PointBuffers points = detail::upload(ex_, test::sphere_cloud(20'000, 1));
    RunReport report;
    field_ = detail::fit_field(ex_, points, {}, options, report);
    cell_ = field_.frame.size / 64;
  }

  std::vector<SurfaceDistance> measured(const std::vector<Vec3f>& world) {
    std::vector<Vec3f> unit;
    for (const Vec3f& p : world) unit.push_back(field_.frame.to_unit(p));
    unit_ = test::upload(ex_, unit);
    auto out = exec::make_buffer<SurfaceDistance>(ex_, unit_.size());
    measure_distances(ex_, field_.view(DomainFaces::closed), unit_.cview(), out.view());
    return test::to_host(ex_, out);
  }

  exec::Cpu ex_{2};
  detail::FieldData field_;
  exec::Buffer<Vec3f> unit_;
  double cell_ = 0;
};

TEST_F(SurfaceDistances, AreThoseOfTheSphereNearIt) {
  test::Random random(3);
  std::vector<Vec3f> points;
  std::vector<double> radii;
  for (int i = 0; i < 2000; ++i) {
    const Vec3d n = random.direction();
    radii.push_back(1 + random.in(-0.5, 0.5) * cell_);
    const double r = radii.back();
    points.push_back({static_cast<float>(r * n[0]), static_cast<float>(r * n[1]), static_cast<float>(r * n[2])});
  }
  const std::vector<SurfaceDistance> distances = measured(points);
  for (std::size_t i = 0; i < points.size(); ++i) {
    const double expected = (radii[i] - 1) / cell_;
    EXPECT_NEAR(distances[i].cells, expected, 0.05 + 0.4 * std::abs(expected)) << i;  // too large rather than too small
    EXPECT_GE(std::abs(distances[i].cells), 0.9 * std::abs(expected) - 0.05) << i;
    const Vec3f& n = distances[i].normal;
    const double cosine = (n.x * points[i].x + n.y * points[i].y + n.z * points[i].z) / radii[i];
    EXPECT_GT(cosine, 0.99) << i;
    EXPECT_GT(distances[i].steepness, 0.05F);
  }
}

TEST_F(SurfaceDistances, HaveTheSideOfTheFieldsValuesEverywhere) {
  test::Random random(4);
  std::vector<Vec3f> points;
  const auto any = [&] { return static_cast<float>(random.in(-1.09, 1.09)); };
  for (int i = 0; i < 5000; ++i) points.push_back({any(), any(), any()});
  const std::vector<SurfaceDistance> distances = measured(points);
  auto values = exec::make_buffer<float>(ex_, unit_.size());
  const FieldView f = field_.view(DomainFaces::closed);
  evaluate(ex_, f, unit_.cview(), values.view());
  for (std::int64_t i = 0; i < values.size(); ++i) {
    const SurfaceDistance& d = distances[static_cast<std::size_t>(i)];
    EXPECT_EQ(d.cells > 0, values.data()[i] < f.isovalue) << i;
    EXPECT_LE(std::abs(d.cells), kFarCells);
  }
}

}  // namespace
}  // namespace pointskin::field
