// Two hundred random requests, right and wrong ones: the scene is always that of its history.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "studio/session/studio_fixture.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::combine;
using test::guide;
using test::in_rectangle;
using test::Json;
using test::lift;
using test::pixel;
using test::Random;
using test::Refused;
using test::StudioTest;

constexpr int kPoints = 3'000, kDepth = 4;

Json random_pixel(Random& random) { return pixel(random.in(-1, 1), random.in(-1, 1)); }

Json random_operation(Random& random) {
  const Json a = random_pixel(random);
  const Json b = random_pixel(random);
  switch (random.below(12)) {
    case 0:
    case 1:
      return guide({a, b}, random.in(0.05, 0.2));
    case 2: {
      Json small = in_rectangle("remove", a, {a[0].get<double>() + 12, a[1].get<double>() + 12});
      small["layers"] = random.below(2) == 0 ? "front" : "through";
      return small;
    }
    case 3:
      return in_rectangle("flip", a, {a[0].get<double>() + 8, a[1].get<double>() + 8});
    case 4:
      return {{"op", "insert"},
              {"shape", "sphere"},
              {"points", 200},
              {"scale", 0.1},
              {"translation", {random.in(-1, 1), random.in(-1, 1), 0.4}}};
    case 5:
    case 6:
      return lift(random.in(-0.1, 0.1));
    case 7:
      return combine(random.below(2) == 0 ? "union" : "difference", {{"shape", "sphere"}, {"points", 1'000}},
                     random.in(1.2, 1.7));
    case 8:
      return {{"op", "orient"}, {"method", "turn"}};
    case 9:
      return {{"op", "options"}, {"depth", 3 + random.below(3)}};
    case 10:
      return {{"op", "options"}, {"screening", random.in(0, 10)}};
    default:
      return {{"op", "options"}, {"depth", "deep"}};  // refused
  }
}

class SessionRandom : public StudioTest {
 protected:
  /// What the scene should be.
  struct Expected {
    std::vector<Json> operations;
    std::size_t done = 0;
  };

  void apply_something(Random& random, Expected& expected) {
    const Json operation = random_operation(random);
    try {
      (void)page().ask("apply", {{"operation", operation}});
      expected.operations.resize(expected.done);
      expected.operations.push_back(operation);
      ++expected.done;
    } catch (const Refused&) {  // nothing has changed then: the state below says so
    }
  }

  void go_somewhere(Random& random, Expected& expected) {
    const auto size = static_cast<std::int64_t>(expected.operations.size());
    const std::int64_t target = random.below(size + 2);
    const bool is_there = target <= size;
    EXPECT_EQ(page().refusal("go", {{"done", target}}).empty(), is_there);
    if (is_there) expected.done = static_cast<std::size_t>(target);
  }

  void ask_something(Random& random, Expected& expected) {
    switch (random.below(10)) {
      case 0:
        (void)page().ask("undo");
        if (expected.done > 0) --expected.done;
        return;
      case 1:
        (void)page().ask("redo");
        if (expected.done < expected.operations.size()) ++expected.done;
        return;
      case 2:
        return go_somewhere(random, expected);
      case 3:
        page().send("preview", {{"operation", random_operation(random)}});
        return;
      case 4:
        page().send("options", {{"patch", {{"screening", random.in(0, 10)}}}});
        return;
      default:
        apply_something(random, expected);
    }
  }
};

TEST_F(SessionRandom, TheSceneIsAlwaysThatOfItsHistory) {
  open_shape("torus", kPoints, kDepth);
  Random random(20'260'601);
  Expected expected;
  for (int i = 0; i < 200; ++i) {
    ask_something(random, expected);
    const Json scene = fresh_scene();
    ASSERT_EQ(scene.at("done"), expected.done) << i;
    ASSERT_EQ(scene.at("history").size(), expected.operations.size()) << i;
  }
  EXPECT_GT(expected.operations.size(), 5U);
  const std::string present = digest();
  const std::vector<Json> done(expected.operations.begin(),
                               expected.operations.begin() + static_cast<std::ptrdiff_t>(expected.done));
  EXPECT_EQ(present, test::replayed("torus", kPoints, kDepth, done));
  studio::StudioOptions again;
  again.resume = true;
  start(again);
  EXPECT_EQ(digest(), present);
}

}  // namespace
}  // namespace pointskin
