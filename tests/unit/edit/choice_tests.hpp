// Points that a view chooses, on every space.
#pragma once

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <vector>

#include "edit/choice.hpp"
#include "edit/view_frame.hpp"
#include "reconstruct/fit_field.hpp"
#include "reconstruct/points.hpp"
#include "support/shapes.hpp"
#include "support/spaces.hpp"

namespace pointskin::test {

/// Looks along -z from (0, 0, distance).
inline edit::ViewFrame perspective_from(double distance) {
  Camera camera;
  camera.width = camera.height = 400;
  camera.view[11] = -distance;
  camera.projection = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1, -0.2, 0, 0, -1, 0};
  return edit::frame_of(camera, {});
}

/// Looks along -z from infinitely far away, though its matrix has a place inside of everything.
inline edit::ViewFrame orthographic() {
  Camera camera;
  camera.width = camera.height = 400;
  return edit::frame_of(camera, {});
}

/// Which points of a cloud the surface of all of them leaves in sight.
struct Sights {
  std::vector<bool> seen;  ///< (points)
  double cell = 0;         ///< width of the finest cells, world units
};

template <exec::Space S>
Sights sights_on(S& ex, const Cloud& cloud, const edit::ViewFrame& view, Options options,
                 bool only_at_samples = false) {
  options.depth = 6;
  detail::PointBuffers points = detail::upload(ex, cloud);
  RunReport unused;
  const detail::FieldData field = fit_field(ex, points, {.keep_points = true}, options, unused);
  const exec::Buffer<std::int32_t> all = exec::iota(ex, points.positions.size());
  const exec::Buffer<std::int32_t> seen =
      not_hidden(ex, view, {field.view(options.domain_faces), field.frame, only_at_samples}, points.positions.cview(),
                 all.cview());
  Sights sights{std::vector<bool>(cloud.positions.size()), field.frame.size / 64};
  for (const std::int32_t i : to_host(ex, seen)) sights.seen[static_cast<std::size_t>(i)] = true;
  return sights;
}

template <exec::Space S>
class ChoiceOn : public OnSpace<S> {
 protected:
  /// On a sphere of radius 1 the line of sight of a point whose normal has the cosine c with it passes through the
  /// inside for the length of the chord, -2 c, and nothing else hides the point. The field is wrong by a tenth of a cell.
  /// A chord of 8 cells reaches more than twice that under the surface. With one of -1 cell, which is behind the point,
  /// the line is a tenth of a cell above the surface after 2 cells.
  void expect_those_of_a_sphere(const edit::ViewFrame& view, const Options& options, bool only_at_samples = false) {
    const Cloud sphere = sphere_cloud(30'000, 1);
    const Sights sights = sights_on(this->space(), sphere, view, options, only_at_samples);
    std::int64_t hidden = 0;
    for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
      const Vec3f& p = sphere.positions[i];
      double to_eye[3] = {view.back[0], view.back[1], view.back[2]};
      if (view.perspective) {
        const double d[3] = {view.eye[0] - p.x, view.eye[1] - p.y, view.eye[2] - p.z};
        for (int a = 0; a < 3; ++a) to_eye[a] = d[a] / std::hypot(d[0], d[1], d[2]);
      }
      const double chord = -2 * (p.x * to_eye[0] + p.y * to_eye[1] + p.z * to_eye[2]);
      if (chord < -1 * sights.cell) {
        EXPECT_TRUE(sights.seen[i]) << chord / sights.cell;
      }
      if (chord > 8 * sights.cell) {
        EXPECT_FALSE(sights.seen[i]) << chord / sights.cell;
      }
      if (!sights.seen[i]) ++hidden;
    }
    EXPECT_GT(hidden, 10'000) << "the far side of a sphere is nearly half of it, or more of it seen from near by";
  }
};
TYPED_TEST_SUITE_P(ChoiceOn);

TYPED_TEST_P(ChoiceOn, HidesTheFarSideOfASphereFromFarAndFromNear) {
  this->expect_those_of_a_sphere(orthographic(), {});
  this->expect_those_of_a_sphere(perspective_from(50), {});
  this->expect_those_of_a_sphere(perspective_from(1.5), {});
  this->expect_those_of_a_sphere(perspective_from(1.05), {});
}

TYPED_TEST_P(ChoiceOn, HidesTheFarSideInASignedDistanceAsWell) {
  Options distance;
  distance.field = FieldKind::distance;
  this->expect_those_of_a_sphere(perspective_from(3), distance);
}

TYPED_TEST_P(ChoiceOn, HidesTheFarSideByTheSurfaceAtSamplesAlone) {
  this->expect_those_of_a_sphere(orthographic(), {}, true);
  this->expect_those_of_a_sphere(perspective_from(1.5), {}, true);
}

TYPED_TEST_P(ChoiceOn, LetsPointsBeSeenThroughWhatTheirWrongNormalsMake) {
  Cloud sphere = sphere_cloud(30'000, 4);
  const auto is_wrong = [&](std::size_t i) {
    const Vec3f& p = sphere.positions[i];
    return std::hypot(p.x, p.y) < 0.3 && p.z > 0;
  };
  std::int64_t wrong = 0;
  for (std::size_t i = 0; i < sphere.positions.size(); ++i)
    if (is_wrong(i)) {
      sphere.normals[i] = -1.0F * sphere.normals[i];
      ++wrong;
    }
  const auto seen_of_wrong = [&](bool only_at_samples) {
    const Sights sights = sights_on(this->space(), sphere, orthographic(), {}, only_at_samples);
    std::int64_t seen = 0;
    for (std::size_t i = 0; i < sphere.positions.size(); ++i) seen += is_wrong(i) && sights.seen[i] ? 1 : 0;
    return seen;
  };
  EXPECT_GT(seen_of_wrong(true), wrong * 98 / 100);
  EXPECT_LT(seen_of_wrong(false), wrong / 2) << "the surface bulges before them";
}

TYPED_TEST_P(ChoiceOn, HidesWhatIsBehindAnotherSurfaceBetweenEyeAndPoint) {
  Cloud two = sphere_cloud(10'000, 2, 0.4, {0, 0, -1});
  const Cloud front = sphere_cloud(10'000, 3, 0.4, {0, 0, 1});
  two.positions.insert(two.positions.end(), front.positions.begin(), front.positions.end());
  two.normals.insert(two.normals.end(), front.normals.begin(), front.normals.end());
  const Sights from_outside = sights_on(this->space(), two, orthographic(), {});
  const Sights from_between = sights_on(this->space(), two, perspective_from(0), {});
  for (std::size_t i = 0; i < 10'000; ++i) {
    const Vec3f& p = two.positions[i];
    if (std::hypot(p.x, p.y) < 0.35) {
      EXPECT_FALSE(from_outside.seen[i]) << "behind the other sphere";
    }
    if (p.z > -0.9F && std::hypot(p.x, p.y) < 0.3) {
      EXPECT_TRUE(from_between.seen[i]) << "the other sphere is behind the eye";
    }
  }
}

TYPED_TEST_P(ChoiceOn, TakesCandidatesInTheAreaAndLeavesAllOthers) {
  auto& ex = this->space();
  const std::vector<Vec3f> positions = {{0, 0, 0}, {0.5F, 0, 3}, {2, 0, 0}, {0.5F, 0.5F, -9}, {-0.5F, 0, 0}};
  const exec::Buffer<Vec3f> on_device = upload(ex, positions);
  const std::vector<edit::PlaneEdge> square = {
      {{-0.1, -0.9}, {0.9, -0.9}}, {{0.9, -0.9}, {0.9, 0.9}}, {{0.9, 0.9}, {-0.1, 0.9}}, {{-0.1, 0.9}, {-0.1, -0.9}}};
  const exec::Buffer<edit::PlaneEdge> edges = upload(ex, square);
  const auto chosen = points_in(ex, orthographic(), {edges.cview()}, on_device.cview(), {});
  expect_same(to_host(ex, chosen), {0, 1, 3});
  const exec::Buffer<std::uint8_t> candidates = upload(ex, std::vector<std::uint8_t>{0, 2, 1, 1, 1});
  const auto fewer = points_in(ex, orthographic(), {edges.cview()}, on_device.cview(), candidates.cview());
  expect_same(to_host(ex, fewer), {1, 3});
  expect_same(to_host(ex, edit::all_but(ex, 5, fewer.cview())), {0, 2, 4});
}

REGISTER_TYPED_TEST_SUITE_P(ChoiceOn, HidesTheFarSideOfASphereFromFarAndFromNear,
                            HidesTheFarSideInASignedDistanceAsWell, HidesWhatIsBehindAnotherSurfaceBetweenEyeAndPoint,
                            HidesTheFarSideByTheSurfaceAtSamplesAlone, LetsPointsBeSeenThroughWhatTheirWrongNormalsMake,
                            TakesCandidatesInTheAreaAndLeavesAllOthers);

}  // namespace pointskin::test
