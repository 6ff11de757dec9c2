// How a studio begins: with a demonstration, with clouds that were named, with one that cannot be read.
#include <pointskin/io.hpp>

#include <cmath>
#include <fstream>
#include <string>

#include <gtest/gtest.h>

#include "studio/session/studio_fixture.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::guide;
using test::Json;
using test::pixel;
using test::StudioTest;

class SessionBegin : public StudioTest {
 protected:
  /// Waits until there is a scene: pages are answered before it is made.
  Json first_scene() {
    const Json scene = page().ask("hello").at("scene");
    if (!scene.is_null()) return scene;
    return page().wait("state", 0, [](const Json& e) { return !e.at("scene").is_null(); }).at("scene");
  }
};

TEST_F(SessionBegin, TheDemonstrationIsAHandThatCanBeWorkedOn) {
  studio::StudioOptions options;
  options.demo = true;
  options.reconstruction.depth = 6;
  start(options);
  const Json scene = first_scene();
  EXPECT_EQ(scene.at("clouds")[0].at("shape"), "hand");
  EXPECT_GT(scene.at("points"), 10'000);
  const int points = scene.at("points");
  const std::string before = digest();
  EXPECT_EQ(before, test::replayed("hand", points, 6, {}));
  const Json stroke = guide({pixel(-0.4, 0.5), pixel(0.4, 0.5)});
  (void)page().ask("apply", {{"operation", stroke}});
  const std::string after = digest();
  EXPECT_EQ(after, test::replayed("hand", points, 6, {stroke}));
  (void)page().ask("undo");
  EXPECT_EQ(digest(), before);
  (void)page().ask("redo");
  EXPECT_EQ(digest(), after);
}

TEST_F(SessionBegin, CloudsThatAreNamedAreOpenWhenThePageComes) {
  write_cloud(file("a.ply"), test::torus_cloud(3'000, 3, 0.7, 0.25));
  write_cloud(file("b.ply"), test::sphere_cloud(2'000, 4, 0.3));
  studio::StudioOptions options;
  options.clouds = {file("a.ply"), file("b.ply")};
  options.reconstruction.depth = 5;
  start(options);
  const Json scene = first_scene();
  EXPECT_EQ(scene.at("points"), 5'000);
  EXPECT_EQ(scene.at("clouds").size(), 2U);
  EXPECT_GT(page().last("mesh").at("triangles"), 100);
}

TEST_F(SessionBegin, ACloudThatCannotBeReadIsToldToThePage) {
  std::ofstream(file("broken.ply")) << "ply\nformat ascii 1.0\n";
  studio::StudioOptions options;
  options.clouds = {file("broken.ply")};
  start(options);
  EXPECT_EQ(page().ask("hello").at("scene"), nullptr);
  const Json notice = page().last("notice");
  EXPECT_EQ(notice.at("level"), "error");
  EXPECT_NE(notice.at("text").get<std::string>().find("broken.ply"), std::string::npos);
  open_shape();
  EXPECT_FALSE(fresh_scene().is_null());
}

TEST_F(SessionBegin, StrangePointsThatWereLeftOutAreTold) {
  std::ofstream text(file("odd.xyz"));
  for (int i = 0; i < 400; ++i) {
    const double a = 0.0157 * i;
    const double h = -1 + i / 200.0;
    text << std::cos(7 * a) << " " << std::sin(7 * a) << " " << h << " " << std::cos(7 * a) << " " << std::sin(7 * a)
         << " 0\n";
  }
  text << "nan 0 0 1 0 0\n0 0 0 0 0 0\n";
  text.close();
  start();
  (void)page().ask("open", {{"files", {{{"path", "odd.xyz"}}}}, {"options", {{"depth", 4}}}});
  EXPECT_EQ(fresh_scene().at("dropped"), 2);
  EXPECT_EQ(fresh_scene().at("points"), 400);
}

}  // namespace
}  // namespace pointskin
