// What moves by itself: water under the hand, and sequences of files.
#include <pointskin/io.hpp>
#include <pointskin/simulation.hpp>

#include <chrono>
#include <string>
#include <thread>
#include <vector>

#include <gtest/gtest.h>

#include "studio/session/studio_fixture.hpp"

namespace pointskin {
namespace {

using test::Json;
using test::StudioTest;

class SessionLive : public StudioTest {
 protected:
  Json start_water(const std::string& scene = "dam-break") {
    start();
    return page().ask("fluid", {{"start", {{"scene", scene}, {"particles", 2'000}, {"free", true}}}});
  }
  /// The frame that comes after as many as have come.
  Json next_frame(std::size_t more = 1) { return page().wait("frame", page().count("frame") + more - 1); }

  /// Files "frame_0.ply" and so on of a dam that breaks.
  void write_frames(int frames) {
    simulation::Simulation water(simulation::make_scene(simulation::SceneKind::dam_break, 2'000), {},
                                 Workspace(Device::cpu(1)));
    for (int i = 0; i < frames; ++i) {
      Cloud cloud;
      cloud.positions = water.particles().positions;
      write_cloud(file("frame_" + std::to_string(i) + ".ply"), cloud);
      water.step(1.0 / 60);
    }
  }
};

TEST_F(SessionLive, WaterFlowsAndIsShownFrameByFrame) {
  const Json facts = start_water();
  EXPECT_EQ(facts.at("particles"), 2'000);
  const Json first = next_frame();
  const Json later = next_frame(3);
  EXPECT_GT(first.at("triangles"), 500);
  EXPECT_GT(later.at("seconds"), first.at("seconds"));
  EXPECT_GT(later.at("version"), first.at("version"));
  EXPECT_EQ(blob(later.at("blob")).header().at("triangles"), later.at("triangles"));
  (void)page().ask("fluid", {{"stop", true}});
  const std::size_t frames = page().count("frame");
  (void)page().ask("hello");
  EXPECT_EQ(page().count("frame"), frames);
}

TEST_F(SessionLive, FramesAreDroppedWhereNobodyDraws) {
  start_water();
  (void)next_frame();
  page().draws(false);
  (void)page().ask("hello");
  const std::size_t frames = page().count("frame");
  std::this_thread::sleep_for(std::chrono::milliseconds(500));
  EXPECT_LE(page().count("frame"), frames + 2);
  page().draws(true);
  EXPECT_GT(next_frame(3).at("version"), 0);
}

TEST_F(SessionLive, APauseHoldsTheWaterAndARestartBeginsAnew) {
  start_water();
  (void)next_frame(3);
  (void)page().ask("fluid", {{"pause", true}});
  const std::size_t frames = page().count("frame");
  std::this_thread::sleep_for(std::chrono::milliseconds(200));
  EXPECT_EQ(page().count("frame"), frames);
  const double seconds = page().last("frame").at("seconds");
  (void)page().ask("fluid", {{"restart", true}});
  EXPECT_LT(page().wait("frame", frames).at("seconds"), seconds);
  (void)page().ask("fluid", {{"pause", false}});
  (void)next_frame();
}

TEST_F(SessionLive, APushMovesTheWaterElsewhere) {
  const auto tenth_frame = [this](const Json& push) {
    start_water();
    (void)page().ask("fluid", {{"pause", true}});
    (void)page().ask("fluid", {{"restart", true}});
    (void)page().ask("fluid", {{"push", push}});
    for (int i = 0; i < 10; ++i) {
      const std::size_t frames = page().count("frame");
      (void)page().ask("fluid", {{"step", true}});
      (void)page().wait("frame", frames);
    }
    const auto bytes = studio().blob(page().last("frame").at("blob"), false);
    return bytes->data;
  };
  const Json push = {
      {{"kind", "push"}, {"centre", {0.2, 0.1, 0.2}}, {"direction", {1, 0, 0}}, {"radius", 0.4}, {"strength", 60}}};
  const auto still = tenth_frame(Json::array());
  EXPECT_EQ(tenth_frame(Json::array()), still) << "the same steps, the same bytes";
  EXPECT_NE(tenth_frame(push), still);
}

TEST_F(SessionLive, WrongRequestsOfWaterAreRefused) {
  start();
  EXPECT_EQ(page().refusal("fluid", {{"pause", true}}), "usage");
  EXPECT_NE(page().refusal("fluid", {{"start", {{"scene", "lava"}}}}), "");
  EXPECT_NE(page().refusal("fluid", {{"start", {{"particles", 1}}}}), "");
  start_water();
  EXPECT_NE(page().refusal("fluid", {{"obstacle", {0.1, 0.1, 0.1}}}), "") << "this scene has none";
  EXPECT_NE(page().refusal("fluid", {{"push", {{{"kind", "pull"}}}}}), "");
  EXPECT_NE(page().refusal("fluid", {{"push", 3}}), "");
  (void)next_frame();
}

TEST_F(SessionLive, AnObstacleIsMovedByHand) {
  start_water("obstacle");
  (void)next_frame();
  (void)page().ask("fluid", {{"obstacle", {0.3, 0.2, 0.3}}});
  (void)next_frame(2);
  const Json centre = page().last("frame").at("obstacle");
  EXPECT_FALSE(centre.is_null());
}

TEST_F(SessionLive, TheSceneCanBeWorkedOnWhileWaterFlows) {
  start_water();
  (void)next_frame();
  open_shape();
  (void)page().ask("apply", {{"operation", test::lift(0.2)}});
  EXPECT_EQ(digest(), test::replayed("torus", 6'000, 5, {test::lift(0.2)}));
}

TEST_F(SessionLive, ASequenceIsScrubbedAndKept) {
  write_frames(4);
  start();
  const Json opened = page().ask("sequence", {{"path", "frame_{}.ply"}});
  EXPECT_EQ(opened.at("frames"), 4);
  EXPECT_EQ(opened.at("name"), "frame_{}.ply");
  const Json third = page().ask("frame", {{"index", 2}});
  EXPECT_EQ(third.at("index"), 2);
  const Json event = page().last("frame");
  EXPECT_EQ(event.at("index"), 2);
  EXPECT_EQ(blob(event.at("blob")).header().at("triangles"), event.at("triangles"));
  const auto bytes = studio().blob(event.at("blob"), false)->data;
  std::this_thread::sleep_for(std::chrono::milliseconds(300));
  EXPECT_EQ(page().ask("frame", {{"index", 3}}).at("kept"), true) << "made before it was asked for";
  EXPECT_EQ(page().ask("frame", {{"index", 2}}).at("kept"), true);
  EXPECT_EQ(studio().blob(page().last("frame").at("blob"), false)->data, bytes);
  EXPECT_EQ(page().refusal("frame", {{"index", 4}}), "usage");
  (void)page().ask("sequence", {{"stop", true}});
  EXPECT_EQ(page().refusal("frame", {{"index", 0}}), "usage");
}

TEST_F(SessionLive, SequencesOutsideOfTheRootAreRefused) {
  write_frames(1);
  start();
  EXPECT_NE(page().refusal("sequence", {{"path", "../frame_{}.ply"}}), "");
  EXPECT_NE(page().refusal("sequence", {{"path", "/tmp/frame_{}.ply"}}), "");
  EXPECT_NE(page().refusal("sequence", {{"path", "other_{}.ply"}}), "");
}

}  // namespace
}  // namespace pointskin
