// Editing what is in front: removals and flips of the front layer, parts by a lasso, and previews of all of them.
#include <gtest/gtest.h>

#include <pointskin/edit.hpp>
#include <pointskin/error.hpp>

#include <cmath>
#include <cstdint>
#include <memory>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/shapes.hpp"
#include "support/two_fingers.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::front_camera;
using test::pixel_at;

EditOptions cold_options() {
  EditOptions options;
  options.reconstruction.depth = 6;
  options.warm_start = false;
  return options;
}

/// Of half width w around the middle.
Area square(double w) { return {{pixel_at(-w, -w), pixel_at(w, -w), pixel_at(w, w), pixel_at(-w, w)}}; }

bool in_square(const Vec3f& p, double w) { return std::abs(p.x) < w && std::abs(p.y) < w; }

TEST(RemovalOfTheFrontLayer, LeavesTheFarSide) {
  const Cloud sphere = test::sphere_cloud(30'000, 1);
  EditSession session(sphere, cold_options(), Device::cpu(2));
  Remove remove{front_camera(), square(0.5), true, true};
  std::int64_t front = 0;
  for (const Vec3f& p : sphere.positions)
    if (in_square(p, 0.5) && p.z > 0) ++front;
  EXPECT_EQ(session.apply(remove).removed, front);
  for (const Vec3f& p : session.cloud().positions) EXPECT_FALSE(in_square(p, 0.5) && p.z > 0);
  session.undo();
  remove.front_layer = false;
  EXPECT_GT(session.apply(remove).removed, front + front / 2) << "both sides";
}

TEST(RemovalOfTheFrontLayer, IsTheSameForAnyNumberOfThreads) {
  const Cloud torus = test::torus_cloud(30'000, 2);
  EditSession one(torus, cold_options(), Device::cpu(1));
  EditSession many(torus, cold_options(), Device::cpu(16));
  Camera camera;
  camera.width = camera.height = 400;
  const double c = 0.8;
  const double s = 0.6;
  camera.view = {1, 0, 0, 0, 0, s, c, 0, 0, -c, s, -4, 0, 0, 0, 1};
  camera.projection = {2, 0, 0, 0, 0, 2, 0, 0, 0, 0, -1, -0.2, 0, 0, -1, 0};
  const Remove remove{camera, {{{120, 40}, {280, 40}, {280, 360}, {120, 360}}}, true, true};
  EXPECT_GT(one.apply(remove).removed, 1'000);
  many.apply(remove);
  EXPECT_TRUE(test::same_bytes(one.cloud().positions, many.cloud().positions));
  expect_same_bytes(one.mesh(), many.mesh());
}

/// A sphere whose normals are wrong in a square of the front.
Cloud sphere_with_a_wrong_patch(const Cloud& sphere) {
  Cloud wrong = sphere;
  for (std::size_t i = 0; i < wrong.positions.size(); ++i)
    if (in_square(wrong.positions[i], 0.3) && wrong.positions[i].z > 0) wrong.normals[i] = -1.0F * wrong.normals[i];
  return wrong;
}

TEST(AFlip, TurnsNormalsAndTheyTurnBack) {
  const Cloud sphere = test::sphere_cloud(20'000, 3);
  EditSession session(sphere, cold_options(), Device::cpu(2));
  const Mesh before = session.mesh();
  const StepReport step = session.apply(Flip{front_camera(), square(0.3)});
  std::int64_t chosen = 0;
  const Cloud turned = session.cloud();
  for (std::size_t i = 0; i < sphere.positions.size(); ++i) {
    const bool is_chosen = in_square(sphere.positions[i], 0.3);
    chosen += is_chosen ? 1 : 0;
    EXPECT_EQ(turned.normals[i], (is_chosen ? -1.0F : 1.0F) * sphere.normals[i]);
  }
  EXPECT_EQ(step.operation, "flip");
  EXPECT_EQ(step.flipped, chosen);
  EXPECT_EQ(step.added, 0);
  EXPECT_EQ(step.removed, 0);
  EXPECT_EQ(step.points, 20'000);
  EXPECT_NE(session.mesh().vertices, before.vertices) << "a flip is a change";
  session.apply(Flip{front_camera(), square(0.3)});
  expect_same_bytes(session.mesh(), before);
  ASSERT_TRUE(session.undo());
  ASSERT_TRUE(session.undo());
  expect_same_bytes(session.mesh(), before);
}

TEST(AFlip, OfNothingChangesNothing) {
  EditSession session(test::sphere_cloud(5'000, 4), cold_options(), Device::cpu(2));
  const Mesh before = session.mesh();
  Flip beside{front_camera(), {{pixel_at(1.5, 1.5), pixel_at(1.9, 1.5), pixel_at(1.9, 1.9)}}};
  EXPECT_EQ(session.apply(beside).flipped, 0);
  expect_same_bytes(session.mesh(), before);
  beside.area.clear();
  EXPECT_EQ(error_of([&] { session.apply(beside); }), ErrorCode::usage);
}

std::int64_t different_normals(const Cloud& a, const Cloud& b) {
  std::int64_t count = 0;
  for (std::size_t i = 0; i < a.normals.size(); ++i) count += a.normals[i] == b.normals[i] ? 0 : 1;
  return count;
}

TEST(AFlipOfTheFrontLayer, MendsAPatchAndLeavesTheFarSide) {
  const Cloud sphere = test::sphere_cloud(20'000, 5);
  EditSession session(sphere_with_a_wrong_patch(sphere), cold_options(), Device::cpu(2));
  const EditSession right(sphere, cold_options(), Device::cpu(2));
  const std::int64_t wrong = different_normals(session.cloud(), sphere);
  ASSERT_GT(wrong, 500);
  session.apply(Flip{front_camera(), square(0.3), true});
  EXPECT_LT(different_normals(session.cloud(), sphere), wrong / 30) << "but for a few at the rim of the patch";
  const double cell = 2 * 1.1 / 64;
  EXPECT_LT(compare(session.mesh(), right.mesh(), {.samples = 20'000}).two_sided.rms, 0.1 * cell);
}

TEST(AFlipOfTheFrontLayer, TurnsTheFrontOfASoundSurfaceExactly) {
  const Cloud sphere = test::sphere_cloud(20'000, 6);
  EditSession session(sphere, cold_options(), Device::cpu(2));
  const Cloud turned = sphere_with_a_wrong_patch(sphere);
  session.apply(Flip{front_camera(), square(0.3), true});
  EXPECT_TRUE(test::same_bytes(session.cloud().normals, turned.normals));
}

Insert lassoed_part(const Cloud& part) {
  Insert insert;
  insert.part = std::make_shared<const Cloud>(part);
  insert.camera = front_camera();
  insert.area = square(0.5);
  insert.lower = {-9, -9, 0};
  insert.placement.translation = {0, 0, 0.5};
  return insert;
}

TEST(AnInsertedPart, IsWhatItsViewShowsInTheArea) {
  EditSession session(test::sphere_cloud(20'000, 6), cold_options(), Device::cpu(2));
  Cloud part = test::sphere_cloud(10'000, 7);
  std::vector<Vec3f> expected;
  for (const Vec3f& p : part.positions)
    if (in_square(p, 0.5) && p.z >= 0) expected.push_back({p.x, p.y, p.z + 0.5F});
  part.origin = {100, 200, 300};
  Insert insert = lassoed_part(part);
  insert.camera.view[3] = -100;  // looks at the part where it is in its own world
  insert.camera.view[7] = -200;
  insert.lower = {0, 0, 300};
  insert.placement.translation = {-100, -200, -299.5};
  EXPECT_EQ(session.apply(insert).added, static_cast<std::int64_t>(expected.size()));
  const Cloud cloud = session.cloud();
  for (std::size_t i = 0; i < expected.size(); ++i) {
    EXPECT_NEAR(cloud.positions[20'000 + i].x, expected[i].x, 1e-4);
    EXPECT_NEAR(cloud.positions[20'000 + i].z, expected[i].z, 1e-4);
  }
  insert.camera.view[3] = 0;
  EXPECT_EQ(error_of([&] { session.apply(insert); }), ErrorCode::usage) << "the view shows none of it";
  insert.area = {{pixel_at(0, 0), pixel_at(1, 1)}};
  EXPECT_EQ(error_of([&] { session.apply(insert); }), ErrorCode::usage) << "an area of two corners";
}

/// Points of the first that are not in the second, which has the others in the same order.
Cloud missing_from(const Cloud& all, const Cloud& some) {
  Cloud missing;
  std::size_t next = 0;
  for (std::size_t i = 0; i < all.positions.size(); ++i) {
    if (next < some.positions.size() && all.positions[i] == some.positions[next]) {
      ++next;
      continue;
    }
    missing.positions.push_back(all.positions[i]);
    missing.normals.push_back(all.normals[i]);
  }
  EXPECT_EQ(next, some.positions.size());
  return missing;
}

void expect_same_points(const Cloud& a, const Cloud& b) {
  EXPECT_TRUE(test::same_bytes(a.positions, b.positions));
  EXPECT_TRUE(test::same_bytes(a.normals, b.normals));
}

class Preview : public testing::Test {
 protected:
  Preview() {
    guide_.camera = front_camera();
    guide_.stroke = {pixel_at(-0.8, 0.3), pixel_at(0.8, 0.3)};
    insert_ = lassoed_part(test::sphere_cloud(10'000, 8));
    insert_.snap = true;
    session_.apply(guide_);
  }

  Guide guide_;
  Insert insert_;
  EditSession session_{test::sphere_cloud(20'000, 9), cold_options(), Device::cpu(2)};
};

TEST_F(Preview, ShowsThePointsThatAreThenAdded) {
  for (const Operation& operation : std::vector<Operation>{guide_, insert_}) {
    const EditPreview preview = session_.preview(operation);
    const std::int64_t added = session_.apply(operation).added;
    EXPECT_GT(added, 100);
    const Cloud after = session_.cloud();
    EXPECT_TRUE(preview.removed.positions.empty());
    EXPECT_EQ(preview.added.origin, after.origin);
    Cloud tail;
    tail.positions.assign(after.positions.end() - added, after.positions.end());
    tail.normals.assign(after.normals.end() - added, after.normals.end());
    expect_same_points(preview.added, tail);
  }
}

TEST_F(Preview, ShowsThePointsThatAreThenRemoved) {
  for (const bool originals : {false, true})
    for (const bool front : {false, true}) {
      const Remove remove{front_camera(), square(0.5), originals, front};
      const Cloud before = session_.cloud();
      const EditPreview preview = session_.preview(remove);
      const std::int64_t removed = session_.apply(remove).removed;
      EXPECT_TRUE(preview.added.positions.empty());
      EXPECT_EQ(preview.removed.size(), removed);
      expect_same_points(preview.removed, missing_from(before, session_.cloud()));
      session_.undo();
    }
}

TEST_F(Preview, ShowsFlippedPointsAsTheyAreAndTurned) {
  const Flip flip{front_camera(), square(0.5), true};
  const EditPreview preview = session_.preview(flip);
  const Cloud before = session_.cloud();
  const std::int64_t flipped = session_.apply(flip).flipped;
  ASSERT_GT(flipped, 100);
  ASSERT_EQ(preview.added.size(), flipped);
  const Cloud after = session_.cloud();
  std::size_t next = 0;
  for (std::size_t i = 0; i < before.positions.size(); ++i) {
    if (before.normals[i] == after.normals[i]) continue;
    ASSERT_LT(next, preview.added.positions.size());
    EXPECT_EQ(preview.removed.positions[next], before.positions[i]);
    EXPECT_EQ(preview.removed.normals[next], before.normals[i]);
    EXPECT_EQ(preview.added.positions[next], after.positions[i]);
    EXPECT_EQ(preview.added.normals[next], after.normals[i]);
    ++next;
  }
}

TEST_F(Preview, LeavesTheSessionAsItIs) {
  const Mesh mesh = session_.mesh();
  const Cloud cloud = session_.cloud();
  (void)session_.preview(insert_);
  const EditPreview all = session_.preview(Remove{front_camera(), square(9), true});
  EXPECT_EQ(all.removed.size(), cloud.size()) << "a removal of everything is shown";
  EXPECT_EQ(error_of([&] { session_.apply(Remove{front_camera(), square(9), true}); }), ErrorCode::empty_result);
  EXPECT_EQ(error_of([&] { (void)session_.preview(Guide{}); }), ErrorCode::usage);
  expect_same_bytes(session_.mesh(), mesh);
  expect_same_points(session_.cloud(), cloud);
  EXPECT_EQ(session_.steps().size(), 1U);
}

}  // namespace
}  // namespace pointskin
