// Operations through messages: what they do, and that undo and redo bring back the same bytes.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "studio/session/studio_fixture.hpp"

namespace pointskin {
namespace {

using test::combine;
using test::guide;
using test::in_rectangle;
using test::Json;
using test::lift;
using test::pixel;
using test::StudioTest;

constexpr int kPoints = 6'000, kDepth = 5;

class SessionHistory : public StudioTest {
 protected:
  Json apply(const Json& operation) { return page().ask("apply", {{"operation", operation}}).at("record"); }
};

/// One of every kind.
std::vector<Json> all_kinds() {
  return {guide({pixel(-0.2, 0), pixel(0.2, 0)}),
          in_rectangle("remove", pixel(-0.2, 0.2), pixel(0.2, -0.2)),
          in_rectangle("flip", pixel(0.6, 0.2), pixel(0.8, -0.2)),
          {{"op", "insert"}, {"shape", "sphere"}, {"points", 1'000}, {"scale", 0.1}, {"translation", {0, 0, 0.6}}},
          lift(0.2),
          combine("union", {{"shape", "sphere"}, {"points", 4'000}}, 1.2),
          {{"op", "orient"}, {"method", "turn"}},
          {{"op", "orient"}, {"method", "turn"}},
          {{"op", "options"}, {"screening", 8}}};
}

TEST_F(SessionHistory, AShapeIsOpenedAndToldInParts) {
  open_shape("torus", kPoints, kDepth);
  EXPECT_EQ(digest(), test::replayed("torus", kPoints, kDepth, {}));
  const Json mesh = page().last("mesh");
  EXPECT_EQ(mesh.at("preview"), false);
  EXPECT_EQ(mesh.at("depth"), kDepth);
  EXPECT_EQ(mesh.at("triangles"), mesh.at("full_triangles"));
  EXPECT_EQ(blob(mesh.at("blob")).header().at("triangles"), mesh.at("triangles"));
  const Json points = page().wait("points", 0, [](const Json& event) { return event.at("final").get<bool>(); });
  EXPECT_EQ(points.at("total"), kPoints);
  EXPECT_EQ(blob(points.at("blob")).positions().size(), static_cast<std::size_t>(kPoints));
  const Json scene = fresh_scene();
  EXPECT_EQ(scene.at("points"), kPoints);
  EXPECT_EQ(scene.at("topology").at("genus"), 1);
  EXPECT_EQ(scene.at("topology").at("components"), 1);
  EXPECT_EQ(scene.at("options").at("depth"), kDepth);
  EXPECT_TRUE(scene.at("history").empty());
}

TEST_F(SessionHistory, EveryKindOfOperationGivesTheBytesOfAReplay) {
  open_shape("torus", kPoints, kDepth);
  std::vector<Json> done;
  for (const Json& operation : all_kinds()) {
    done.push_back(operation);
    const Json record = apply(operation);
    EXPECT_EQ(record.at("operation"), operation.at("op"));
    EXPECT_EQ(record.at("triangles"), page().last("mesh").at("triangles"));
  }
  EXPECT_EQ(digest(), test::replayed("torus", kPoints, kDepth, done));
  const Json scene = fresh_scene();
  EXPECT_EQ(scene.at("history").size(), done.size());
  EXPECT_EQ(scene.at("done"), done.size());
  EXPECT_EQ(scene.at("options").at("screening"), 8);
}

TEST_F(SessionHistory, UndoRedoAndGoBringBackTheSameBytes) {
  open_shape("torus", kPoints, kDepth);
  std::vector<std::string> digests = {digest()};
  std::vector<Json> points = {kPoints};
  for (const Json& operation : all_kinds()) {
    points.push_back(apply(operation).at("points"));
    digests.push_back(digest());
  }
  for (std::size_t i = digests.size() - 1; i-- > 0;) {
    EXPECT_EQ(page().ask("undo").at("done"), i);
    EXPECT_EQ(digest(), digests[i]) << "undone until " << i;
    EXPECT_EQ(fresh_scene().at("points"), points[i]) << "undone until " << i;
  }
  EXPECT_EQ(page().ask("undo").at("done"), 0) << "there is nothing more to undo";
  EXPECT_EQ(page().ask("redo").at("done"), 1);
  EXPECT_EQ(digest(), digests[1]);
  for (const std::size_t done : {digests.size() - 1, std::size_t{2}, std::size_t{6}, std::size_t{0}}) {
    EXPECT_EQ(page().ask("go", {{"done", done}}).at("done"), done);
    EXPECT_EQ(digest(), digests[done]) << done;
    EXPECT_EQ(scene().at("done"), done);
  }
}

TEST_F(SessionHistory, AnOperationAfterAnUndoForgetsWhatWasUndone) {
  open_shape("torus", kPoints, kDepth);
  const Json stroke = guide({pixel(-0.2, 0), pixel(0.2, 0)});
  (void)apply(lift(0.2));
  (void)apply(lift(0.1));
  (void)page().ask("go", {{"done", 0}});
  (void)apply(stroke);
  EXPECT_EQ(fresh_scene().at("history").size(), 1U);
  EXPECT_EQ(digest(), test::replayed("torus", kPoints, kDepth, {stroke}));
  EXPECT_EQ(page().ask("redo").at("done"), 1) << "there is nothing to redo";
}

TEST_F(SessionHistory, WhatAnOperationDidIsTold) {
  open_shape("torus", kPoints, kDepth);
  const std::size_t meshes = page().count("mesh");
  const Json record = apply(in_rectangle("remove", pixel(-0.3, 0.3), pixel(0.3, -1)));
  EXPECT_GT(record.at("removed"), 100);
  EXPECT_EQ(record.at("points"), kPoints - record.at("removed").get<int>());
  EXPECT_EQ(record.at("before").at("genus"), 1);
  EXPECT_TRUE(record.at("after").contains("components"));
  EXPECT_EQ(page().count("mesh"), meshes + 1);
  const std::vector<Json> messages = page().messages();
  const auto place = [&messages](const auto& is_it) {
    for (std::size_t i = messages.size(); i-- > 0;)
      if (is_it(messages[i])) return i;
    return messages.size();
  };
  EXPECT_LT(place([](const Json& m) { return m.value("event", "") == "mesh"; }),
            place([](const Json& m) { return m.contains("record"); }))
      << "the mesh comes before the reply";
}

TEST_F(SessionHistory, FinalOptionsAreAStepOfTheHistory) {
  open_shape("torus", kPoints, kDepth);
  const std::string before = digest();
  (void)page().ask("options", {{"patch", {{"depth", 6}}}, {"final", true}});
  EXPECT_EQ(fresh_scene().at("history").size(), 1U);
  EXPECT_EQ(page().last("mesh").at("depth"), 6);
  EXPECT_EQ(digest(), test::replayed("torus", kPoints, kDepth, {{{"op", "options"}, {"depth", 6}}}));
  (void)page().ask("undo");
  EXPECT_EQ(digest(), before);
}

TEST_F(SessionHistory, AddingACloudMergesItIntoTheBase) {
  open_shape("torus", kPoints, kDepth);
  (void)page().ask("open", {{"files", {{{"shape", "sphere"}, {"points", 2'000}}}}, {"add", true}});
  EXPECT_EQ(fresh_scene().at("points"), kPoints + 2'000);
  EXPECT_EQ(fresh_scene().at("clouds").size(), 2U);
  EXPECT_EQ(fresh_scene().at("options").at("depth"), kDepth);
}

}  // namespace
}  // namespace pointskin
