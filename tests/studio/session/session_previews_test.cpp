// Previews: shown at once, without a trace in the scene, and only the newest.
#include <algorithm>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "studio/session/studio_fixture.hpp"

namespace pointskin {
namespace {

using test::BlobReader;
using test::combine;
using test::guide;
using test::in_rectangle;
using test::Json;
using test::lift;
using test::pixel;
using test::Refused;
using test::StudioTest;

class SessionPreviews : public StudioTest {
 protected:
  Json preview(const Json& operation) { return page().ask("preview", {{"operation", operation}}); }
  Json apply(const Json& operation) { return page().ask("apply", {{"operation", operation}}).at("record"); }

  /// "ok", or the code that a request was refused with.
  std::string outcome(std::int64_t id) {
    try {
      (void)page().reply(id);
      return "ok";
    } catch (const Refused& refused) {
      return refused.code();
    }
  }
};

TEST_F(SessionPreviews, GhostsAreThePointsThatAnOperationThenAddsAndRemoves) {
  open_shape();
  const std::string before = digest();
  const Json stroke = guide({pixel(-0.9, 0), pixel(0.9, 0)}, 0.05);
  const Json shown = preview(stroke);
  const Json ghosts = page().last("ghosts");
  EXPECT_GT(ghosts.at("added"), 10);
  EXPECT_EQ(ghosts.at("removed_blob"), nullptr);
  EXPECT_EQ(shown.at("added"), ghosts.at("added"));
  const BlobReader points = blob(ghosts.at("blob"));
  EXPECT_EQ(points.header().at("kind"), "points");
  EXPECT_EQ(points.positions().size(), ghosts.at("added").get<std::size_t>());
  EXPECT_EQ(points.normals().size(), points.positions().size());
  EXPECT_EQ(digest(), before);
  EXPECT_TRUE(fresh_scene().at("history").empty());
  EXPECT_EQ(apply(stroke).at("added"), ghosts.at("added"));

  const Json cut = in_rectangle("remove", pixel(0.5, 0.3), pixel(1, -0.3));
  (void)preview(cut);
  const Json gone = page().last("ghosts");
  EXPECT_EQ(gone.at("blob"), nullptr);
  EXPECT_EQ(blob(gone.at("removed_blob")).positions().size(), gone.at("removed").get<std::size_t>());
  EXPECT_EQ(apply(cut).at("removed"), gone.at("removed"));
}

TEST_F(SessionPreviews, EndingAPreviewTakesGhostsAndMeshBack) {
  open_shape();
  (void)preview(guide({pixel(-0.9, 0), pixel(0.9, 0)}));
  (void)preview(lift(0.3));
  ASSERT_EQ(page().last("mesh").at("preview"), true);
  (void)page().ask("preview_end");
  EXPECT_EQ(page().last("ghosts").at("blob"), nullptr);
  EXPECT_EQ(page().last("ghosts").at("added"), 0);
  const Json mesh = page().last("mesh");
  EXPECT_EQ(mesh.at("preview"), false);
  EXPECT_EQ(mesh.at("triangles"), scene().at("triangles"));
}

TEST_F(SessionPreviews, EveryMoveOfADragStartsFromTheRestPose) {
  open_shape();
  (void)preview(lift(0.1));
  const Json first = page().last("mesh");
  EXPECT_EQ(first.at("preview"), true);
  const auto bytes = studio().blob(first.at("blob"), false)->data;
  (void)preview(lift(0.4));
  EXPECT_NE(studio().blob(page().last("mesh").at("blob"), false)->data, bytes);
  (void)preview(lift(0.1));
  EXPECT_EQ(studio().blob(page().last("mesh").at("blob"), false)->data, bytes);
  (void)apply(lift(0.1));
  (void)preview(lift(0.1));  // of the bent cloud now
  EXPECT_NE(studio().blob(page().last("mesh").at("blob"), false)->data, bytes);
}

TEST_F(SessionPreviews, ACombinationTintsWhatItKeepsTurnsAndDrops) {
  open_shape();
  const Json with = {{"shape", "sphere"}, {"points", 3'000}};
  for (const char* operation : {"union", "intersection", "difference", "symmetric"}) {
    const Json reply = preview(combine(operation, with, 0.8));
    const Json ghosts = page().last("ghosts");
    const auto tint = blob(ghosts.at("blob")).numbers<std::uint8_t>("tint");
    const auto both = [&reply](const char* key) {
      return reply.at("a").at(key).get<int>() + reply.at("b").at(key).get<int>();
    };
    const auto tinted = [&tint](int c) { return std::count(tint.begin(), tint.end(), static_cast<std::uint8_t>(c)); };
    EXPECT_EQ(tinted(0), both("kept") - both("flipped")) << operation;
    EXPECT_EQ(tinted(1), both("flipped")) << operation;
    EXPECT_EQ(tinted(2), both("dropped")) << operation;
    EXPECT_EQ(page().last("mesh").at("preview"), true);
  }
  EXPECT_TRUE(fresh_scene().at("history").empty());
}

TEST_F(SessionPreviews, OptionsThatAreNotFinalLeaveNoTrace) {
  open_shape("torus", 6'000, 8);
  const std::string before = digest();
  (void)page().ask("options", {{"patch", {{"screening", 30}}}});
  const Json mesh = page().last("mesh");
  EXPECT_EQ(mesh.at("preview"), true);
  EXPECT_LE(mesh.at("depth"), 7);
  EXPECT_GE(mesh.at("depth"), 6);
  EXPECT_EQ(digest(), before);
  EXPECT_TRUE(fresh_scene().at("history").empty());
}

TEST_F(SessionPreviews, ATrimIsShownBeforeItIsDone) {
  open_shape("sphere");
  (void)apply(in_rectangle("remove", pixel(0, 1.1), pixel(1.1, -1.1)));  // half a sphere: the rest is a guess
  (void)page().ask("options", {{"patch", {{"trim", 0}}}, {"final", false}});
  const Json whole = page().last("mesh");
  (void)page().ask("options", {{"patch", {{"trim", 0.05}}}, {"final", false}});
  const Json trimmed = page().last("mesh");
  EXPECT_EQ(trimmed.at("preview"), true);
  EXPECT_LT(trimmed.at("triangles").get<double>(), 0.95 * whole.at("triangles").get<double>());
}

TEST_F(SessionPreviews, OnlyTheNewestPreviewCounts) {
  open_shape("torus", 20'000, 7);
  (void)preview(lift(0.01));
  std::vector<std::int64_t> ids;
  for (int i = 0; i < 40; ++i) ids.push_back(page().send("preview", {{"operation", lift(0.01 * i)}}));
  std::multiset<std::string> outcomes;
  for (const std::int64_t id : ids) outcomes.insert(outcome(id));
  EXPECT_EQ(outcome(ids.back()), "ok");
  EXPECT_EQ(outcomes.count("ok") + outcomes.count("superseded"), ids.size());
  EXPECT_GE(outcomes.count("superseded"), 20U);
}

TEST_F(SessionPreviews, OperationsAreNeverDroppedAndKeepTheirOrder) {
  open_shape();
  std::vector<std::int64_t> ids;
  std::vector<Json> operations;
  for (int i = 0; i < 6; ++i) {
    operations.push_back(lift(0.02 * (i + 1)));
    for (int k = 0; k < 5; ++k) page().send("preview", {{"operation", lift(0.1 * k)}});
    ids.push_back(page().send("apply", {{"operation", operations.back()}}));
  }
  for (std::size_t i = 0; i < ids.size(); ++i) EXPECT_EQ(page().reply(ids[i]).at("done"), i + 1);
  EXPECT_EQ(digest(), test::replayed("torus", 6'000, 5, operations));
}

TEST_F(SessionPreviews, ALongJobTellsHowFarItIsAndCanBeCancelled) {
  open_shape();
  const std::string before = digest();
  const Json large = {{"files", {{{"shape", "gyroid"}, {"points", 400'000}}}}, {"options", {{"depth", 9}}}};
  const std::size_t before_it = page().count("progress");
  const std::int64_t id = page().send("open", large);
  const Json progress = page().wait("progress", before_it);
  EXPECT_TRUE(progress.at("phase").is_string());
  EXPECT_GE(progress.at("fraction"), 0.0);
  EXPECT_LE(progress.at("fraction"), 1.0);
  EXPECT_TRUE(progress.contains("eta_ms"));
  (void)page().ask("cancel");
  EXPECT_EQ(outcome(id), "interrupted");
  EXPECT_TRUE(
      page().wait("progress", before_it, [](const Json& e) { return e.value("finished", false); }).at("finished"));
  EXPECT_EQ(digest(), before) << "the scene is as it was";
}

}  // namespace
}  // namespace pointskin
