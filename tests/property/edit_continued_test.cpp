// Sessions that go on from the cloud of another: the kinds of its points decide as they did there.
#include <gtest/gtest.h>

#include <pointskin/edit.hpp>
#include <pointskin/error.hpp>

#include <algorithm>
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
using test::two_fingers_cloud;

EditOptions cold_options() {
  EditOptions options;
  options.reconstruction.depth = 6;
  options.warm_start = false;
  return options;
}

EditSession continued(const EditSession& session, EditOptions options) {
  options.continued = true;
  options.reconstruction.keep_strays = true;
  return EditSession(session.cloud(), options, Device::cpu(3));
}

Area everything() { return {{pixel_at(-9, -9), pixel_at(9, -9), pixel_at(9, 9), pixel_at(-9, 9)}}; }

std::vector<std::uint8_t> kinds_of(const Cloud& cloud) {
  std::vector<std::uint8_t> kinds;
  for (const Attribute& attribute : cloud.attributes)
    if (attribute.name == "added") {
      EXPECT_TRUE(kinds.empty()) << "the kinds are there twice";
      kinds = attribute.values.as<std::uint8_t>();
    }
  return kinds;
}

void expect_same_points(const Cloud& a, const Cloud& b) {
  EXPECT_TRUE(test::same_bytes(a.positions, b.positions));
  EXPECT_TRUE(test::same_bytes(a.normals, b.normals));
  EXPECT_EQ(kinds_of(a), kinds_of(b));
}

TEST(AContinuedSession, HasTheBytesOfTheOneItGoesOnFrom) {
  EditSession whole(two_fingers_cloud(20'000, 1), cold_options(), Device::cpu(2));
  const std::vector<Operation> strokes = test::parting_strokes();
  whole.apply(strokes[0]);
  EditSession second = continued(whole, cold_options());
  expect_same_points(second.cloud(), whole.cloud());
  expect_same_bytes(second.mesh(), whole.mesh());
  const std::int64_t added = whole.apply(strokes[1]).added;
  EXPECT_EQ(second.apply(strokes[1]).added, added) << "guides reach through the depth of the original points";
  expect_same_points(second.cloud(), whole.cloud());
  expect_same_bytes(second.mesh(), whole.mesh());
}

TEST(AContinuedSession, HasTheBytesWithEveryKindOfField) {
  for (const FieldKind field : {FieldKind::poisson, FieldKind::distance}) {
    EditOptions options = cold_options();
    options.reconstruction.field = field;
    options.reconstruction.confidence = true;
    Cloud cloud = two_fingers_cloud(20'000, 2);
    for (std::size_t i = 0; i < cloud.normals.size(); i += 2) cloud.normals[i] = 3.0F * cloud.normals[i];
    EditSession whole(cloud, options, Device::cpu(2));
    whole.apply(test::parting_strokes()[0]);
    EditSession second = continued(whole, options);
    expect_same_bytes(second.mesh(), whole.mesh());
    whole.apply(test::parting_strokes()[1]);
    second.apply(test::parting_strokes()[1]);
    expect_same_points(second.cloud(), whole.cloud());
    expect_same_bytes(second.mesh(), whole.mesh());
  }
}

TEST(AContinuedSession, HasTheCubeAndTheDepthOfTheOriginalPoints) {
  EditSession whole(two_fingers_cloud(20'000, 10), cold_options(), Device::cpu(2));
  Guide longer;  // than the fingers, which end at 0.9; the cube at 0.99
  longer.camera = front_camera();
  longer.stroke = {pixel_at(0, -0.93), pixel_at(0, 0.93)};
  longer.inside_only = false;
  whole.apply(longer);
  EditSession second = continued(whole, cold_options());
  expect_same_bytes(second.mesh(), whole.mesh());
  Guide from_above;
  from_above.camera = front_camera();
  from_above.camera.view = {1, 0, 0, 0, 0, 0, -1, 0, 0, 1, 0, 0, 0, 0, 0, 1};
  from_above.stroke = {pixel_at(-0.1, 0), pixel_at(0.1, 0)};
  from_above.inside_only = false;
  whole.apply(from_above);
  second.apply(from_above);
  expect_same_points(second.cloud(), whole.cloud());
  expect_same_bytes(second.mesh(), whole.mesh());
}

TEST(AContinuedSession, KeepsTheCubeThatAnInsertedPartHasWidened) {
  EditSession whole(test::sphere_cloud(20'000, 3), cold_options(), Device::cpu(2));
  Insert insert;
  insert.part = std::make_shared<const Cloud>(test::sphere_cloud(5'000, 4, 0.4, {2.5, 0.2, 0}));
  whole.apply(insert);
  EditSession second = continued(whole, cold_options());
  expect_same_bytes(second.mesh(), whole.mesh());
}

TEST(AContinuedSession, RemovesWhatWasAddedBeforeIt) {
  const Cloud cloud = two_fingers_cloud(20'000, 5);
  EditSession first(cloud, cold_options(), Device::cpu(2));
  const Cloud before = first.cloud();
  const Mesh joined = first.mesh();
  const std::int64_t added = first.apply(test::parting_strokes()[0]).added;
  EditSession second = continued(first, cold_options());
  const StepReport& step = second.apply(Remove{front_camera(), everything()});
  EXPECT_EQ(step.removed, added);
  expect_same_points(second.cloud(), before);
  expect_same_bytes(second.mesh(), joined);
}

TEST(AContinuedSession, TakesTheIsovalueAtOriginalPointsOnly) {
  EditSession whole(test::sphere_cloud(20'000, 6), cold_options(), Device::cpu(2));
  Guide filling;
  filling.camera = front_camera();
  filling.area = {{pixel_at(-0.5, -0.5), pixel_at(0.5, -0.5), pixel_at(0.5, 0.5), pixel_at(-0.5, 0.5)}};
  ASSERT_GT(whole.apply(filling).added, 1'000);
  expect_same_bytes(continued(whole, cold_options()).mesh(), whole.mesh());
  const EditSession begun_anew(whole.cloud(), cold_options(), Device::cpu(2));
  EXPECT_NE(begun_anew.mesh().vertices, whole.mesh().vertices) << "kinds are not looked at unless asked for";
}

TEST(AContinuedSession, OfAWarmOneEndsNearIt) {
  EditOptions warm = cold_options();
  warm.warm_start = true;
  EditSession whole(two_fingers_cloud(20'000, 7), warm, Device::cpu(2));
  whole.apply(test::parting_strokes()[0]);
  const EditSession second = continued(whole, warm);
  const MeshComparison difference = compare(second.mesh(), whole.mesh(), {.samples = 20'000});
  // A warm session and one that goes on from its cloud are two approximations of one field: 0.055 cells apart.
  EXPECT_LT(difference.two_sided.rms, 0.06 * 1.8 * 1.1 / 64);
}

TEST(AContinuedSession, CarriesTheOtherAttributesAndTheKindsOnce) {
  EditOptions options = cold_options();
  options.reconstruction.attributes = true;
  Cloud cloud = two_fingers_cloud(20'000, 8);
  cloud.attributes.push_back({"red", std::vector<std::uint8_t>(20'000, 90)});
  EditSession whole(cloud, options, Device::cpu(2));
  whole.apply(test::parting_strokes()[0]);
  const EditSession second = continued(whole, options);
  ASSERT_EQ(second.mesh().attributes.size(), 1U);
  EXPECT_EQ(second.mesh().attributes[0].name, "red");
  expect_same_bytes(second.mesh(), whole.mesh());
  const Cloud edited = second.cloud();
  ASSERT_EQ(edited.attributes.size(), 2U);
  EXPECT_TRUE(edited.attributes[0].values.is_missing(edited.positions.size() - 1));
  expect_same_points(edited, whole.cloud());
  const EditSession begun_anew(whole.cloud(), options, Device::cpu(2));
  EXPECT_EQ(kinds_of(begun_anew.cloud()), std::vector<std::uint8_t>(edited.positions.size(), 0));
}

TEST(AContinuedSession, RefusesCloudsThatDoNotSayWhatTheirPointsAre) {
  EditOptions options = cold_options();
  options.continued = true;
  const auto error_with = [&](std::vector<Attribute> attributes) {
    Cloud cloud = test::sphere_cloud(1'000, 9);
    cloud.attributes = std::move(attributes);
    return error_of([&] { EditSession(cloud, options, Device::cpu(2)); });
  };
  EXPECT_EQ(error_with({}), ErrorCode::invalid_input);
  EXPECT_EQ(error_with({{"added", std::vector<float>(1'000, 0)}}), ErrorCode::invalid_input);
  EXPECT_EQ(error_with({{"added", std::vector<std::uint8_t>(999, 0)}}), ErrorCode::invalid_input);
  EXPECT_EQ(error_with({{"added", std::vector<std::uint8_t>(1'000, 3)}}), ErrorCode::invalid_input);
  EXPECT_EQ(error_with({{"added", std::vector<std::uint8_t>(1'000, 1)}}), ErrorCode::invalid_input);
  EXPECT_EQ(error_with({{"added", AttributeValues::missing(AttributeType::uint8, 1'000)}}), ErrorCode::invalid_input);
  EXPECT_EQ(error_with({{"added", std::vector<std::uint8_t>(1'000, 0)}}), std::nullopt);
}

}  // namespace
}  // namespace pointskin
