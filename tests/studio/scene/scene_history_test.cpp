// Scenes: operations of every kind, forth and back, replayed; what fails leaves no trace.
#include <algorithm>
#include <cstdint>
#include <random>
#include <set>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <pointskin/boolean.hpp>
#include <pointskin/deform.hpp>
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/reconstruct.hpp>

#include "studio/scene/scene_support.hpp"

namespace pointskin::test {
namespace {

using scene::Scene;
using scene::SceneOperation;

/// Numbers that are the same with every standard library.
class Dice {
 public:
  explicit Dice(std::uint64_t seed) : engine_(seed) {}
  int upto(int n) { return static_cast<int>(engine_() % static_cast<std::uint64_t>(n)); }
  double in(double lower, double upper) { return lower + (upper - lower) * upto(1000) / 1000; }

 private:
  std::mt19937_64 engine_;
};

std::string rectangle(Dice& dice, double size) {
  const double x = dice.in(60, 320), y = dice.in(60, 320);
  return fmt::format("[{}, {}, {}, {}]", x, y, x + size, y + size);
}

std::string random_edit(Dice& dice) {
  switch (dice.upto(4)) {
    case 0:
      return fmt::format(R"({{"op": "guide", "camera": {{}}, "stroke": [[{}, {}], [{}, {}]], "normals": "{}",
                             "inside_only": {}}})",
                         dice.in(60, 340), dice.in(60, 340), dice.in(60, 340), dice.in(60, 340),
                         dice.upto(2) == 0 ? "cloud" : "stroke", dice.upto(2) == 0);
    case 1:
      return fmt::format(R"({{"op": "remove", "camera": {{}}, "rectangle": {}, "originals": {}, "layers": "{}"}})",
                         rectangle(dice, 25), dice.upto(2) == 0, dice.upto(2) == 0 ? "front" : "through");
    case 2:
      return fmt::format(R"({{"op": "flip", "camera": {{}}, "rectangle": {}, "layers": "front"}})", rectangle(dice, 4));
    default:
      return fmt::format(R"({{"op": "insert", "shape": "sphere", "points": 300, "scale": {}, "snap": {},
                             "translation": [{}, {}, {}]}})",
                         dice.in(0.1, 0.3), dice.upto(3) == 0, dice.in(-1, 1), dice.in(-1, 1), dice.in(-0.3, 0.3));
  }
}

std::string random_stage(Dice& dice) {
  switch (dice.upto(8)) {
    case 0:
    case 1:
      return fmt::format(R"({{"op": "deform", "handles": [{{"region": {{"ball": {{"centre": [-1, 0, 0],
                             "radius": 0.3}}}}}}, {{"region": {{"ball": {{"centre": [1, 0, 0], "radius": 0.3}}}},
                             "rigid": {{"degrees": {}, "translation": [0.02, 0, 0]}}}}]}})",
                         dice.in(-8, 8));
    case 2:
    case 3:
      return fmt::format(R"({{"op": "boolean", "operation": "{}", "with": {{"shape": "sphere", "points": 600}},
                             "scale": 0.2, "translation": [{}, {}, 0.1], "creases": "{}"}})",
                         dice.upto(2) == 0 ? "union" : "difference", dice.in(-1, 1), dice.in(-1, 1),
                         dice.upto(2) == 0 ? "sampled" : "none");
    case 4:
      return R"({"op": "orient", "method": "repair"})";
    case 5:
      return R"({"op": "orient", "method": "turn"})";
    default:
      return fmt::format(R"({{"op": "options", "depth": {}, "screening": {}, "density": {}, "attributes": {}}})",
                         5 + dice.upto(2), dice.in(1, 4), dice.upto(2) == 0, dice.upto(2) == 0);
  }
}

/// A state as people would compare it.
std::string state_of(const Scene& scene) {
  return fmt::format("{} {} {}", scene.done(), digest(scene.mesh()), digest(scene.cloud()));
}

/// Applies random operations until `count` are done, and takes down every state, the first one included.
/// @returns how many were refused; each of them must leave the scene as it was
int apply_random(Scene& scene, Dice& dice, std::size_t count, std::vector<std::string>& states) {
  int refused = 0;
  states = {state_of(scene)};
  for (int tries = 0; scene.done() < count && tries < 1000; ++tries) {
    const SceneOperation operation = operation_from(dice.upto(5) == 0 ? random_stage(dice) : random_edit(dice));
    try {
      scene.apply(operation);
      states.push_back(state_of(scene));
    } catch (const Error&) {
      ++refused;
      EXPECT_EQ(state_of(scene), states.back());
    }
  }
  EXPECT_EQ(scene.done(), count);
  return refused;
}

void expect_states(Scene& scene, const std::vector<std::string>& states) {
  for (std::size_t i = states.size() - 1; i-- > 0;) {
    ASSERT_TRUE(scene.undo());
    ASSERT_EQ(state_of(scene), states[i]) << "after undoing to " << i;
  }
  EXPECT_FALSE(scene.undo());
  for (std::size_t i = 1; i < states.size(); ++i) {
    ASSERT_TRUE(scene.redo());
    ASSERT_EQ(state_of(scene), states[i]) << "after redoing to " << i;
  }
  EXPECT_FALSE(scene.redo());
}

TEST(SceneHistory, UndoesAndRedoesTwoHundredRandomOperationsToTheBytesOnTheWay) {
  Dice dice(11);
  Scene scene(small_cloud(1200), small_options());
  std::vector<std::string> states;
  apply_random(scene, dice, 200, states);
  std::set<std::string> kinds;
  for (std::size_t i = 0; i < scene.size(); ++i) kinds.insert(name_of(scene.operation(i)));
  EXPECT_EQ(kinds.size(), 8U);
  expect_states(scene, states);
}

TEST(SceneHistory, NeedsNoCheckpoints) {
  Dice dice(12);
  scene::SceneOptions options = small_options();
  options.checkpoint_bytes = 0;
  Scene scene(small_cloud(1500), options);
  std::vector<std::string> states;
  apply_random(scene, dice, 20, states);
  expect_states(scene, states);
  for (const std::size_t place : {3U, 17U, 0U, 20U, 9U, 10U}) {
    scene.go_to(place);
    EXPECT_EQ(state_of(scene), states[place]) << place;
  }
  EXPECT_THROW(scene.go_to(21), Error);
  EXPECT_EQ(state_of(scene), states[10]);
}

TEST(SceneHistory, ReplaysToTheSameBytesFromJson) {
  Scene live(small_cloud(), small_options());
  std::vector<nlohmann::json> script;
  std::vector<std::string> states;
  for (const std::string& text : one_of_every_kind()) {
    const scene::StepRecord& record = live.apply(operation_from(text));
    EXPECT_EQ(record.operation, nlohmann::json::parse(text)["op"].get<std::string>());
    EXPECT_EQ(record.points, live.cloud().size());
    EXPECT_EQ(record.triangles, static_cast<std::int64_t>(live.mesh().triangles.size()));
    script.push_back(scene::to_json(live.operation(live.done() - 1), ""));
    states.push_back(state_of(live));
  }
  Scene replay(small_cloud(), small_options(), Device::cpu(1));
  for (std::size_t i = 0; i < script.size(); ++i) {
    replay.apply(operation_of_json(script[i]));
    EXPECT_EQ(state_of(replay), states[i]) << script[i].dump();
    EXPECT_EQ(nlohmann::json(scene::to_json(replay.operation(i), "")), script[i]);
  }
}

TEST(SceneHistory, WritesTheIntervalThatAGuideUsed) {
  Scene scene(small_cloud(), small_options());
  scene.apply(operation_from(R"({"op": "guide", "camera": {}, "stroke": [[60, 60], [90, 90]], "inside_only": false})"));
  const double interval = std::get<Guide>(scene.operation(0)).interval;
  EXPECT_GT(interval, 0.05);  // cube about 3, 32 cells
  EXPECT_LT(interval, 0.15);
  const std::string with_zero = digest(scene.mesh());
  Scene again(small_cloud(), small_options());
  again.apply(scene.operation(0));
  EXPECT_EQ(digest(again.mesh()), with_zero);
}

TEST(SceneHistory, GivesTheMeshesOfTheLibrarysClasses) {
  const Cloud cloud = small_cloud();
  Options options = small_options().reconstruction;
  Scene scene(cloud, small_options());
  EXPECT_EQ(digest(scene.mesh()), digest(Reconstructor().reconstruct(cloud, options)));

  scene.apply(operation_from(R"({"op": "options", "depth": 6, "density": true})"));
  options.depth = 6;
  options.density = true;
  EXPECT_EQ(digest(scene.mesh()), digest(Reconstructor().reconstruct(cloud, options)));

  const SceneOperation bend = operation_from(one_of_every_kind()[5]);
  Deformer deformer(cloud, options);
  deformer.deform(std::get<scene::Deform>(bend).deformation);
  scene.apply(bend);
  EXPECT_EQ(digest(scene.mesh()), digest(deformer.reconstruct()));

  const SceneOperation cut = operation_from(one_of_every_kind()[6]);
  const auto& combine = std::get<scene::Combine>(cut);
  const scene::Solid other = scene::placed(*combine.solid, combine.placement);
  BooleanOptions boolean;
  boolean.reconstruction = options;
  boolean.reconstruction.keep_strays = true;
  boolean.coincidence_cells = 0.7;
  const Cloud bent = deformer.cloud();
  const BooleanResult result = Booleans().combine(bent, std::get<Cloud>(other), combine.op, boolean);
  scene.apply(cut);
  EXPECT_EQ(digest(scene.mesh()), digest(result.mesh));
  EXPECT_EQ(scene.cloud().positions, result.cloud.positions);
}

TEST(SceneHistory, KeepsKindsAndAttributesAcrossEverything) {
  Scene scene(small_cloud(), small_options());
  for (const std::string& text : one_of_every_kind()) scene.apply(operation_from(text));
  const Cloud cloud = scene.cloud();
  const auto find = [&cloud](const std::string& name) {
    for (const Attribute& attribute : cloud.attributes)
      if (attribute.name == name) return &attribute.values;
    ADD_FAILURE() << "no attribute " << name;
    return static_cast<const AttributeValues*>(nullptr);
  };
  const std::vector<std::uint8_t>& kinds = find("added")->as<std::uint8_t>();
  for (const std::uint8_t kind : {0, 1, 2}) EXPECT_GT(std::count(kinds.begin(), kinds.end(), kind), 5) << int{kind};
  const std::vector<std::uint8_t>& red = find("red")->as<std::uint8_t>();
  EXPECT_GT(std::count_if(red.begin(), red.end(), [](std::uint8_t value) { return value > 50; }), 2000);
  bool shown = false;
  for (const Attribute& attribute : scene.mesh().attributes) {
    EXPECT_NE(attribute.name, "added");
    shown = shown || attribute.name == "red";
  }
  EXPECT_TRUE(shown);  // options asked for attributes after stages without
}

TEST(SceneHistory, BeginsWithoutNormalsAndGetsThem) {
  Cloud cloud = small_cloud();
  cloud.normals.clear();
  Scene scene(cloud, small_options());
  EXPECT_TRUE(scene.mesh().triangles.empty());
  for (const std::size_t kind : {0U, 2U, 3U, 4U, 5U, 6U, 9U}) {
    EXPECT_THROW(scene.apply(operation_from(one_of_every_kind()[kind])), Error) << kind;
    EXPECT_EQ(scene.done(), 0U);
  }
  scene.apply(operation_from(R"({"op": "orient", "method": "estimate"})"));
  EXPECT_EQ(scene.topology().genus, 1);
  EXPECT_EQ(scene.record(0).before.components, 0);
  EXPECT_EQ(scene.record(0).flipped, cloud.size());
  const std::string oriented = state_of(scene);
  scene.apply(operation_from(one_of_every_kind()[0]));
  scene.undo();
  EXPECT_EQ(state_of(scene), oriented);
  scene.undo();
  EXPECT_TRUE(scene.mesh().triangles.empty());
  EXPECT_EQ(scene.cloud().size(), cloud.size());
}

TEST(SceneHistory, StaysAsItWasWhenItIsCancelled) {
  bool cancel = false;
  scene::SceneOptions options = small_options();
  options.checkpoint_bytes = 0;
  options.progress = [&cancel](const Progress&) { return !cancel; };
  Scene scene(small_cloud(), options);
  for (const std::string& text : one_of_every_kind()) scene.apply(operation_from(text));
  const std::string state = state_of(scene);
  cancel = true;
  for (const std::size_t place : {0U, 2U, 7U, 9U}) {
    EXPECT_THROW(scene.go_to(place), Error) << place;
    EXPECT_EQ(scene.done(), 11U);
  }
  for (const std::size_t kind : {0U, 5U, 6U, 7U, 8U, 9U})
    EXPECT_THROW(scene.apply(operation_from(one_of_every_kind()[kind])), Error) << kind;
  cancel = false;
  EXPECT_EQ(state_of(scene), state);
  EXPECT_EQ(scene.size(), 11U);
}

// Zhou et al. 2010, section 5.1, on the hand that the studio shows to who has no scan.
TEST(SceneHistory, OneStrokePartsTheFingersOfTheHand) {
  Scene scene(scene::shape_cloud("hand", 60'000), small_options(7));
  EXPECT_EQ(scene.topology().components, 1);
  EXPECT_EQ(scene.topology().genus, 1);
  // At x = 0.235, where they face each other, up from 0.4 to 1: pixel (200 + 100 x, 200 - 100 y).
  scene.apply(operation_from(R"({"op": "guide", "camera": {}, "stroke": [[223.5, 160], [223.5, 100]],
                                 "normals": "stroke"})"));
  EXPECT_EQ(scene.topology().components, 1);
  EXPECT_EQ(scene.topology().genus, 0);
  EXPECT_EQ(scene.record(0).before.genus, 1);
  EXPECT_GT(scene.record(0).added, 50);
  scene.undo();
  EXPECT_EQ(scene.topology().genus, 1);
}

TEST(SceneHistory, ForgetsWhatWasUndoneWhenItGoesOn) {
  Scene scene(small_cloud(), small_options());
  for (const std::string& text : one_of_every_kind()) scene.apply(operation_from(text));
  scene.go_to(2);
  EXPECT_EQ(scene.size(), 11U);
  scene.apply(operation_from(R"({"op": "options", "depth": 4})"));
  EXPECT_EQ(scene.size(), 3U);
  EXPECT_EQ(scene.options().depth, 4);
  scene.undo();
  EXPECT_EQ(scene.options().depth, 5);
}

TEST(SceneHistory, PreviewsWhatItWouldDo) {
  Scene scene(small_cloud(), small_options());
  const std::string state = state_of(scene);
  for (const std::size_t kind : {0U, 1U, 2U, 4U}) {
    const SceneOperation operation = operation_from(one_of_every_kind()[kind]);
    const EditPreview preview = scene.preview(operation);
    EXPECT_EQ(state_of(scene), state);
    const scene::StepRecord& record = scene.apply(operation);
    EXPECT_EQ(preview.added.size(), record.added) << kind;
    EXPECT_EQ(preview.removed.size(), record.removed) << kind;
    EXPECT_GT(record.added + record.removed, 0) << kind;
    scene.undo();
  }
  EXPECT_THROW((void)scene.preview(operation_from(one_of_every_kind()[5])), Error);
}

TEST(SceneHistory, KeepsTheSolidThatAnOperationRead) {
  const SceneFolder folder;
  const std::string file = folder / "part.ply";
  write_cloud(file, sphere_cloud(1000, 3, 0.4, {1, 0, 0}));
  Scene scene(small_cloud(), small_options());
  scene::Combine combine;
  combine.with.file = file;
  scene.apply(combine);
  const std::string united = state_of(scene);
  write_cloud(file, sphere_cloud(1000, 3, 0.2, {-1, 0, 0}));
  scene.go_to(0);
  scene.apply(operation_from(R"({"op": "options", "depth": 4})"));
  scene.go_to(0);
  scene::SceneOptions bare = small_options();
  bare.checkpoint_bytes = 0;
  Scene other(small_cloud(), bare);
  write_cloud(file, sphere_cloud(1000, 3, 0.4, {1, 0, 0}));
  other.apply(combine);
  write_cloud(file, sphere_cloud(1000, 3, 0.2, {-1, 0, 0}));
  other.undo();
  other.redo();
  EXPECT_EQ(state_of(other), united);
}

}  // namespace
}  // namespace pointskin::test
