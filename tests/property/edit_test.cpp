// Editing: strokes that part what was joined, removal, copied parts; undo, redo and replay byte by byte.
#include <gtest/gtest.h>

#include <pointskin/edit.hpp>
#include <pointskin/error.hpp>

#include <cmath>
#include <limits>
#include <numbers>
#include <vector>

#include "property/reconstruction.hpp"
#include "support/option_sets.hpp"
#include "support/shapes.hpp"
#include "support/two_fingers.hpp"

namespace pointskin {
namespace {

using test::error_of;
using test::expect_same_bytes;
using test::front_camera;
using test::pixel_at;
using test::two_fingers_cloud;

EditOptions options_at(int depth) {
  EditOptions options;
  options.reconstruction.depth = depth;
  return options;
}

EditSession session_of(const Cloud& cloud, int depth, int threads = 2) {
  return EditSession(cloud, options_at(depth), Device::cpu(threads));
}

class PartingStrokes : public testing::TestWithParam<int> {};

TEST_P(PartingStrokes, SeparateFingersThatTheAutomaticSurfaceJoins) {
  EditSession session = session_of(two_fingers_cloud(40'000, 1), GetParam());
  ASSERT_EQ(measure(session.mesh()).components, 1) << "the gap must be closed without help";
  for (const Operation& stroke : test::parting_strokes()) {
    const StepReport& step = session.apply(stroke);
    EXPECT_EQ(step.operation, "guide");
    EXPECT_GT(step.added, 100);
    EXPECT_EQ(step.removed, 0);
    EXPECT_TRUE(step.warm);
  }
  const MeshReport parted = measure(session.mesh());
  EXPECT_EQ(parted.components, 2);
  EXPECT_EQ(parted.euler, 4);
  EXPECT_TRUE(parted.watertight());
  const std::vector<StepReport> steps = session.steps();
  ASSERT_EQ(steps.size(), 2U);
  EXPECT_EQ(steps[0].before.components, 1);
  EXPECT_EQ(steps[0].after.components, 2) << "one stroke parts them";
  EXPECT_EQ(steps[1].after.components, 2);
  EXPECT_EQ(steps[1].after.genus, 0);
  EXPECT_EQ(steps[1].points, 40'000 + steps[0].added + steps[1].added);
}

INSTANTIATE_TEST_SUITE_P(AtDepth, PartingStrokes, testing::Values(6, 7, 8));

TEST(ASession, StartsWithTheBytesOfAReconstructionAndEditsUnderAnyOptions) {
  const Cloud cloud = two_fingers_cloud(8'000, 2);
  for (const auto& [name, options] : test::option_sets(5, false)) {
    SCOPED_TRACE(name);
    EditSession session(cloud, {.reconstruction = options}, Device::cpu(2));
    const Mesh plain = test::reconstructed(cloud, options);
    expect_same_bytes(session.mesh(), plain);
    session.apply(test::parting_strokes().front());
    EXPECT_GT(session.steps().back().added, 0);
    EXPECT_TRUE(session.mesh().vertices != plain.vertices);
    ASSERT_TRUE(session.undo());
    expect_same_bytes(session.mesh(), plain);
  }
}

TEST(Undo, BringsTheOldBytesBackAndRedoTheNewOnes) {
  EditSession session = session_of(two_fingers_cloud(20'000, 2), 6);
  std::vector<Mesh> meshes{session.mesh()};
  for (const Operation& stroke : test::parting_strokes()) {
    session.apply(stroke);
    meshes.push_back(session.mesh());
  }
  EXPECT_FALSE(session.redo());
  for (std::size_t i = meshes.size() - 1; i-- > 0;) {
    EXPECT_TRUE(session.undo());
    expect_same_bytes(session.mesh(), meshes[i]);
    EXPECT_EQ(session.operations().size(), i);
  }
  EXPECT_FALSE(session.undo());
  for (std::size_t i = 1; i < meshes.size(); ++i) {
    EXPECT_TRUE(session.redo());
    expect_same_bytes(session.mesh(), meshes[i]);
  }
}

TEST(Undo, MakesStatesAgainThatAreNoLongerKept) {
  EditOptions few = options_at(6);
  few.states_kept = 1;
  const Cloud cloud = two_fingers_cloud(20'000, 3);
  EditSession session(cloud, few, Device::cpu(2));
  EditSession keeps_all = session_of(cloud, 6);
  const std::vector<Operation> strokes = test::parting_strokes();
  for (int i = 0; i < 4; ++i) {
    session.apply(strokes[static_cast<std::size_t>(i % 2)]);
    keeps_all.apply(strokes[static_cast<std::size_t>(i % 2)]);
  }
  for (int i = 0; i < 4; ++i) {
    EXPECT_TRUE(session.undo());
    EXPECT_TRUE(keeps_all.undo());
    expect_same_bytes(session.mesh(), keeps_all.mesh());
  }
}

TEST(Undo, InLittleMemoryGivesTheSameBytes) {
  EditOptions little = options_at(6);
  little.undo_bytes = 0;
  const Cloud cloud = two_fingers_cloud(20'000, 3);
  EditSession session(cloud, little, Device::cpu(2));
  EditSession keeps_all = session_of(cloud, 6);
  const std::vector<Operation> strokes = test::parting_strokes();
  const auto both = [&](const auto& act) {
    act(session);
    act(keeps_all);
    expect_same_bytes(session.mesh(), keeps_all.mesh());
    for (const Operation& stroke : strokes)
      EXPECT_TRUE(test::same_bytes(session.preview(stroke).added.normals, keeps_all.preview(stroke).added.normals));
  };
  const auto stroke = [&](std::size_t i) { return [&strokes, i](EditSession& s) { s.apply(strokes[i]); }; };
  const auto undo = [](EditSession& s) { EXPECT_TRUE(s.undo()); };
  const auto redo = [](EditSession& s) { EXPECT_TRUE(s.redo()); };
  for (const std::size_t i : {0, 1, 1}) both(stroke(i));
  for (int i = 0; i < 3; ++i) both(undo);
  both(redo);
  both(redo);
  both(undo);
  both(stroke(0));
  both(stroke(1));
  both(undo);
  EXPECT_TRUE(test::same_bytes(session.cloud().positions, keeps_all.cloud().positions));
}

TEST(Replay, GivesTheSameBytesWhateverHappenedBetween) {
  const Cloud cloud = two_fingers_cloud(20'000, 4);
  const std::vector<Operation> strokes = test::parting_strokes();
  EditSession wandering = session_of(cloud, 6, 1);
  wandering.apply(strokes[1]);
  wandering.undo();
  wandering.apply(strokes[0]);
  wandering.apply(strokes[0]);
  wandering.undo();
  wandering.apply(strokes[1]);
  EXPECT_FALSE(wandering.redo()) << "a new operation forgets those that were undone";
  EditSession straight = session_of(cloud, 6, 16);
  for (const Operation& operation : wandering.operations()) straight.apply(operation);
  expect_same_bytes(straight.mesh(), wandering.mesh());
  EXPECT_TRUE(test::same_bytes(straight.cloud().positions, wandering.cloud().positions));
}

TEST(AnOperationThatFails, LeavesTheSessionAsItWas) {
  EditSession session = session_of(two_fingers_cloud(20'000, 5), 6);
  const Mesh before = session.mesh();
  Remove all;
  all.camera = front_camera();
  all.area = {{pixel_at(-2, -2), pixel_at(2, -2), pixel_at(2, 2), pixel_at(-2, 2)}};
  all.originals = true;
  EXPECT_EQ(error_of([&] { session.apply(all); }), ErrorCode::empty_result);
  Guide bad;
  bad.camera = front_camera();
  EXPECT_EQ(error_of([&] { session.apply(bad); }), ErrorCode::usage) << "neither stroke nor area";
  expect_same_bytes(session.mesh(), before);
  EXPECT_TRUE(session.operations().empty());
}

/// Takes all points with x > 0 that the front camera shows.
Remove removal_of_right_half() {
  Remove right_half;
  right_half.camera = front_camera();
  right_half.area = {{pixel_at(0, -2), pixel_at(2, -2), pixel_at(2, 2), pixel_at(0, 2)}};
  right_half.originals = true;
  return right_half;
}

TEST(Removal, TakesAddedPointsOnlyUnlessToldOtherwise) {
  EditSession session = session_of(two_fingers_cloud(20'000, 6), 6);
  const std::int64_t added = session.apply(test::parting_strokes()[0]).added;
  Remove everywhere;
  everywhere.camera = front_camera();
  everywhere.area = {{pixel_at(-2, -2), pixel_at(2, -2), pixel_at(2, 2), pixel_at(-2, 2)}};
  const StepReport removed = session.apply(everywhere);
  EXPECT_EQ(removed.removed, added);
  EXPECT_EQ(removed.points, 20'000);

  session.apply(removal_of_right_half());
  EXPECT_EQ(measure(session.mesh()).components, 1);
  for (const Vec3f& p : session.cloud().positions) EXPECT_LT(p.x, 0);
}

TEST(Removal, LeavesHolesOfTheAreaAlone) {
  const Cloud sphere = test::sphere_cloud(20'000, 7);
  EditSession session = session_of(sphere, 5);
  Remove ring;
  ring.camera = front_camera();
  ring.area = {{pixel_at(-0.6, -0.6), pixel_at(0.6, -0.6), pixel_at(0.6, 0.6), pixel_at(-0.6, 0.6)},
               {pixel_at(-0.3, -0.3), pixel_at(0.3, -0.3), pixel_at(0.3, 0.3), pixel_at(-0.3, 0.3)}};
  ring.originals = true;
  const std::int64_t left = session.apply(ring).points;
  std::int64_t expected = 0;
  for (const Vec3f& p : sphere.positions) {
    const float far = std::max(std::abs(p.x), std::abs(p.y));
    if (far > 0.6F || far < 0.3F) ++expected;
  }
  EXPECT_EQ(left, expected);
}

/// A camera on the z axis that looks at the origin.
Camera perspective_camera(double distance) {
  Camera camera;
  camera.width = 600;
  camera.height = 400;
  camera.view[11] = -distance;
  camera.projection = {2, 0, 0, 0, 0, 3, 0, 0, 0, 0, -1, -0.2, 0, 0, -1, 0};
  return camera;
}

/// Where it shows a point.
Pixel shown(const Camera& camera, const Vec3f& p) {
  const double depth = -(p.z + camera.view[11]);
  return {(camera.projection[0] * p.x / depth + 1) * camera.width / 2,
          (1 - camera.projection[5] * p.y / depth) * camera.height / 2};
}

TEST(AStroke, IsExtrudedAlongThePerspectiveViewAtItsInterval) {
  EditSession session = session_of(test::sphere_cloud(20'000, 8), 6);
  const Camera camera = perspective_camera(5);
  Guide guide;
  guide.camera = camera;
  guide.stroke = {{280, 200}, {320, 190}, {330, 160}};
  guide.interval = 0.05;
  guide.normals = GuideNormals::stroke;
  const std::int64_t added = session.apply(guide).added;
  const Cloud cloud = session.cloud();
  ASSERT_EQ(cloud.size(), 20'000 + added);
  // The stroke is 72.9 pixels long; at depth 5, 120 pixels are one unit; the sphere is almost 2 deep there.
  EXPECT_NEAR(static_cast<double>(added), 2 / 0.05 * 72.9 / 120 / 0.05, 30);
  for (std::size_t i = 20'000; i < cloud.positions.size(); ++i) {
    const Vec3f& p = cloud.positions[i];
    EXPECT_LT(std::hypot(p.x, p.y, p.z), 1.03) << "outside of the surface";
    EXPECT_NEAR(std::remainder(5.0 - p.z - (5.0 - 1.0), 0.05), 0, 2e-3) << "between layers";
    const Pixel at = shown(camera, p);
    const double first = std::abs(-10 * (at[0] - 280) - 40 * (at[1] - 200)) / std::hypot(10, 40);
    const double second = std::abs(-30 * (at[0] - 320) - 10 * (at[1] - 190)) / std::hypot(10, 30);
    EXPECT_LT(std::min(first, second), 1e-3) << "off the stroke";
    const Vec3f& n = cloud.normals[i];
    EXPECT_NEAR(std::hypot(n.x, n.y, n.z), 1, 1e-6);
    EXPECT_NEAR(n.x * p.x + n.y * p.y + n.z * (p.z - 5), 0, 1e-5) << "not orthogonal to the line of sight";
    EXPECT_TRUE(first < 1e-3 ? n.y < 0 : n.x > 0) << "not to the right";
  }
}

TEST(AnArea, IsFilledInVolumeAroundItsHole) {
  EditSession session = session_of(test::sphere_cloud(20'000, 9), 6);
  Guide guide;
  guide.camera = front_camera();
  guide.area = {{pixel_at(-0.5, -0.5), pixel_at(0.5, -0.5), pixel_at(0.5, 0.5), pixel_at(-0.5, 0.5)},
                {pixel_at(-0.2, -0.2), pixel_at(0.2, -0.2), pixel_at(0.2, 0.2), pixel_at(-0.2, 0.2)}};
  guide.interval = 0.05;
  guide.inside_only = false;
  const std::int64_t added = session.apply(guide).added;
  // Step 4 is off: (1 - 0.16) area over a depth of 2, in points of 0.05^3, give or take a layer.
  EXPECT_NEAR(static_cast<double>(added), 0.84 * 2 / (0.05 * 0.05 * 0.05), 500);
  const Cloud cloud = session.cloud();
  for (std::size_t i = 20'000; i < cloud.positions.size(); ++i) {
    const double far = std::max(std::abs(cloud.positions[i].x), std::abs(cloud.positions[i].y));
    EXPECT_GT(far, 0.2 - 1e-6);
    EXPECT_LT(far, 0.5 + 1e-6);
  }
}

TEST(InterpolatedNormals, AreThoseOfTheCloudAround) {
  // Just inside of a sphere the nearest samples' normals point away from the centre.
  EditSession session = session_of(test::sphere_cloud(50'000, 10), 6);
  Guide guide;
  guide.camera = front_camera();
  guide.stroke = {pixel_at(-0.8, 0.3), pixel_at(0.8, 0.3)};
  session.apply(guide);
  const Cloud cloud = session.cloud();
  int near_surface = 0;
  for (std::size_t i = 50'000; i < cloud.positions.size(); ++i) {
    const Vec3f& p = cloud.positions[i];
    const Vec3f& n = cloud.normals[i];
    const double r = std::hypot(p.x, p.y, p.z);
    EXPECT_NEAR(std::hypot(n.x, n.y, n.z), 1, 1e-5);
    if (r < 0.9) continue;
    ++near_surface;
    EXPECT_GT((n.x * p.x + n.y * p.y + n.z * p.z) / r, 0.99);
  }
  EXPECT_GT(near_surface, 20);
}

TEST(TheIsovalue, IsThatOfTheOriginalPointsAlone) {
  // Points added all over the inside would pull the mean up and the surface inwards.
  const Cloud sphere = test::sphere_cloud(50'000, 11);
  EditSession session = session_of(sphere, 6);
  const double before = measure(session.mesh()).volume;
  Guide filling;
  filling.camera = front_camera();
  filling.area = {{pixel_at(-0.3, -0.3), pixel_at(0.3, -0.3), pixel_at(0.3, 0.3), pixel_at(-0.3, 0.3)}};
  session.apply(filling);
  double outermost = 0;
  for (const Vec3f& v : session.mesh().vertices) outermost = std::max<double>(outermost, std::hypot(v.x, v.y, v.z));
  EXPECT_NEAR(outermost, 1, 0.02);
  EXPECT_GT(before, 4.1);
}

Insert part_of(Cloud part) {
  Insert insert;
  insert.part = std::make_shared<const Cloud>(std::move(part));
  return insert;
}

TEST(AnInsertedPart, IsPlacedByItsSimilarity) {
  EditSession session = session_of(test::sphere_cloud(30'000, 12), 6);
  Cloud small = test::sphere_cloud(10'000, 13, 1, {0.25, 0, 0});
  small.origin = {1000, 0, 0};
  Insert insert = part_of(std::move(small));
  insert.placement.scale = 0.5;
  insert.placement.rotation = {0, -1, 0, 1, 0, 0, 0, 0, 1};  // x becomes y
  insert.placement.translation = {0, -500, 2};               // of the part's origin at x = 1000
  const StepReport& step = session.apply(insert);
  EXPECT_EQ(step.added, 10'000);
  EXPECT_FALSE(step.warm) << "the part is outside of the cube";
  const MeshReport report = measure(session.mesh());
  EXPECT_EQ(report.components, 2);
  EXPECT_TRUE(report.watertight());
  EXPECT_NEAR(report.volume, 4 / 3.0 * std::numbers::pi * (1 + 0.125), 0.05);
  const Cloud cloud = session.cloud();
  for (std::size_t i = 30'000; i < cloud.positions.size(); ++i) {
    const Vec3f& p = cloud.positions[i];
    EXPECT_NEAR(std::hypot(p.x, p.y - 0.125, p.z - 2), 0.5, 1e-4);
    EXPECT_NEAR(cloud.normals[i].x, p.x / 0.5, 1e-3);
  }
}

TEST(AnInsertedPart, SnapsOntoThePointsThatAreThere) {
  const Cloud torus = test::torus_cloud(60'000, 14);
  EditSession session = session_of(torus, 7);
  // Another scan of a part of the torus, a little out of place.
  Cloud part;
  const Cloud again = test::torus_cloud(60'000, 15);
  const double angle = 0.03;
  for (std::size_t i = 0; i < again.positions.size(); ++i) {
    const Vec3f p = again.positions[i];
    const Vec3f n = again.normals[i];
    if (p.x < 0.2F) continue;
    const auto turned = [&](const Vec3f& v) {
      return Vec3f{static_cast<float>(std::cos(angle) * v.x + std::sin(angle) * v.z), v.y,
                   static_cast<float>(std::cos(angle) * v.z - std::sin(angle) * v.x)};
    };
    const Vec3f moved = turned(p);
    part.positions.push_back({moved.x + 0.02F, moved.y + 0.01F, moved.z - 0.02F});
    part.normals.push_back(turned(n));
  }
  const auto worst_distance = [](const Cloud& cloud, std::size_t from) {
    double worst = 0;
    for (std::size_t i = from; i < cloud.positions.size(); ++i) {
      const Vec3f& p = cloud.positions[i];
      worst = std::max(worst, std::abs(std::hypot(std::hypot(p.x, p.y) - 1.0, p.z) - 0.35));
    }
    return worst;
  };
  EXPECT_GT(worst_distance(part, 0), 0.03);
  Insert insert = part_of(part);
  insert.snap = true;
  EXPECT_TRUE(session.apply(insert).snapped);
  EXPECT_LT(worst_distance(session.cloud(), 60'000), 2e-3);
}

TEST(AnInsertedPart, StaysWhereItIsIfNothingIsNear) {
  EditSession session = session_of(test::sphere_cloud(20'000, 16), 5);
  Insert insert = part_of(test::sphere_cloud(1'000, 17, 0.2, {3, 0, 0}));
  insert.snap = true;
  EXPECT_FALSE(session.apply(insert).snapped);
  EXPECT_EQ(measure(session.mesh()).components, 2);
}

TEST(Attributes, HaveNoValueAtAddedPointsThatLackThem) {
  Cloud cloud = two_fingers_cloud(20'000, 18);
  cloud.attributes.push_back({"red", std::vector<std::uint8_t>(20'000, 200)});
  EditOptions options = options_at(6);
  options.reconstruction.attributes = true;
  EditSession session(cloud, options, Device::cpu(2));
  session.apply(test::parting_strokes()[0]);
  for (const std::uint8_t red : session.mesh().attributes.at(0).values.as<std::uint8_t>()) EXPECT_EQ(red, 200);
  const Cloud edited = session.cloud();
  ASSERT_EQ(edited.attributes.size(), 2U);
  EXPECT_EQ(edited.attributes[0].type(), AttributeType::uint8);
  EXPECT_FALSE(edited.attributes[0].values.is_missing(0));
  EXPECT_TRUE(edited.attributes[0].values.is_missing(edited.positions.size() - 1));
  EXPECT_EQ(edited.attributes[1].name, "added");
  EXPECT_EQ(edited.attributes[1].values.as<std::uint8_t>().front(), 0);
  EXPECT_EQ(edited.attributes[1].values.as<std::uint8_t>().back(), 1);
}

TEST(Attributes, EndWithTheLastPointThatHasThem) {
  Cloud cloud = test::sphere_cloud(5'000, 18, 0.2, {1, 0, 0});
  test::append(cloud, test::sphere_cloud(5'000, 19, 0.2, {-1, 0, 0}));
  AttributeValues heat(std::vector<float>(5'000, 20));
  heat.append(AttributeValues::missing(AttributeType::float32, 5'000));
  cloud.attributes.push_back({"heat", heat});
  EditOptions options = options_at(6);
  options.reconstruction.attributes = true;
  EditSession session(cloud, options, Device::cpu(2));
  for (const float v : session.mesh().attributes.at(0).values.as<float>()) EXPECT_EQ(v, 20);
  session.apply(removal_of_right_half());
  EXPECT_EQ(measure(session.mesh()).components, 1);
  EXPECT_TRUE(session.mesh().attributes.empty());
  session.undo();
  EXPECT_EQ(session.mesh().attributes.size(), 1U);
}

TEST(AWarmStart, EndsNearTheSurfaceOfAColdOne) {
  const Cloud cloud = two_fingers_cloud(40'000, 19);
  EditOptions cold = options_at(7);
  cold.warm_start = false;
  EditSession warm_session = session_of(cloud, 7);
  EditSession cold_session(cloud, cold, Device::cpu(2));
  for (const Operation& stroke : test::parting_strokes()) {
    warm_session.apply(stroke);
    EXPECT_FALSE(cold_session.apply(stroke).warm);
  }
  const MeshComparison difference = compare(warm_session.mesh(), cold_session.mesh(), {.samples = 50'000});
  const double cell = 1.8 * 1.1 / 128;
  EXPECT_LT(difference.two_sided.rms, 0.05 * cell);
  EXPECT_LT(difference.two_sided.max, 0.5 * cell);
}

TEST(Cameras, AreRefusedUnlessTheyAreViews) {
  const auto refused = [](const auto& change) {
    Camera camera = front_camera();
    change(camera);
    return error_of([&] { validate(camera); }) == ErrorCode::usage;
  };
  EXPECT_FALSE(refused([](Camera&) {}));
  EXPECT_TRUE(refused([](Camera& c) { c.width = 0; }));
  EXPECT_TRUE(refused([](Camera& c) { c.view[0] = 2; }));
  EXPECT_TRUE(refused([](Camera& c) { c.view[0] = -1; }));
  EXPECT_TRUE(refused([](Camera& c) { c.view[12] = 1; }));
  EXPECT_TRUE(refused([](Camera& c) { c.projection[0] = 0; }));
  EXPECT_TRUE(refused([](Camera& c) { c.projection[1] = 0.5; }));
  EXPECT_TRUE(refused([](Camera& c) { c.projection[15] = 0; }));
  EXPECT_TRUE(refused([](Camera& c) { c.projection[5] = std::numeric_limits<double>::quiet_NaN(); }));
}

}  // namespace
}  // namespace pointskin
