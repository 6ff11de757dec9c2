// Several pages on one scene: all see the same, a slow one does not hold up the others.
#include <algorithm>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "studio/session/studio_fixture.hpp"

namespace pointskin {
namespace {

using test::BlobReader;
using test::Json;
using test::lift;
using test::Page;
using test::StudioTest;

class SessionPages : public StudioTest {
 protected:
  void apply(const Json& operation) { (void)page().ask("apply", {{"operation", operation}}); }
};

bool is_final(const Json& points) { return points.at("final"); }

TEST_F(SessionPages, AllPagesAreToldOfMeshesPointsAndStates) {
  start();
  const auto other = another_page();
  open_shape();
  apply(lift(0.2));
  const Json mesh = page().last("mesh");
  const Json seen = other->wait("mesh", 0, [&](const Json& e) { return e.at("version") == mesh.at("version"); });
  EXPECT_EQ(seen, mesh);
  (void)page().ask("digest");
  (void)page().wait("points", 0, is_final);
  EXPECT_TRUE(other->wait("points", 0, is_final).contains("blob"));
  EXPECT_EQ(other->last("state"), page().last("state"));
}

TEST_F(SessionPages, APageThatComesLateLearnsEverything) {
  open_shape();
  apply(lift(0.2));
  (void)page().wait("points", 0, is_final);
  (void)page().ask("preview", {{"operation", lift(0.4)}});
  const auto late = another_page();
  const Json hello = late->ask("hello");
  EXPECT_EQ(hello.at("scene"), scene());
  for (const char* key : {"program", "version", "device", "loopback", "root", "shapes", "formats", "max_upload"})
    EXPECT_TRUE(hello.contains(key)) << key;
  EXPECT_EQ(hello.at("scene").at("history").size(), 1U);
  const Json mesh = late->wait("mesh");
  EXPECT_EQ(mesh.at("preview"), false);
  EXPECT_EQ(mesh.at("triangles"), hello.at("scene").at("triangles"));
  EXPECT_EQ(blob(mesh.at("blob")).header().at("triangles"), mesh.at("triangles"));
  EXPECT_NE(studio().blob(late->wait("points", 0, is_final).at("blob"), false), nullptr);
}

TEST_F(SessionPages, APageThatDoesNotDrawGetsTwoPreviewsButEveryMeshThatCounts) {
  open_shape();
  const auto slow = another_page();
  slow->draws(false);
  for (int i = 0; i < 6; ++i) (void)page().ask("preview", {{"operation", lift(0.05 * (i + 1))}});
  EXPECT_EQ(slow->count("mesh"), 2U);
  EXPECT_GE(page().count("mesh"), 5U);
  apply(lift(0.1));
  apply(lift(0.1));
  EXPECT_EQ(slow->count("mesh"), 4U) << "those that are done are told to all";
  slow->draws(true);
  (void)slow->ask("ack", {{"version", slow->last("mesh").at("version")}});
  (void)page().ask("preview", {{"operation", lift(0.3)}});
  EXPECT_EQ(slow->count("mesh"), 5U);
}

TEST_F(SessionPages, OldBlobsAreFreedAndNewOnesStay) {
  open_shape();
  const Json first = page().last("mesh").at("blob");
  for (int i = 0; i < 8; ++i) apply(lift(0.01 * (i + 1)));
  EXPECT_EQ(studio().blob(first, false), nullptr);
  EXPECT_EQ(studio().blob(first, true), nullptr);
  EXPECT_NE(studio().blob(page().last("mesh").at("blob"), false), nullptr);
  EXPECT_EQ(studio().blob(123'456'789, false), nullptr);
}

TEST_F(SessionPages, ABlobIsTheSameCompressed) {
  open_shape();
  const Json id = page().last("mesh").at("blob");
  const BlobReader raw = blob(id);
  const BlobReader packed = blob(id, true);
  EXPECT_EQ(packed.positions(), raw.positions());
  EXPECT_EQ(packed.normals(), raw.normals());
  EXPECT_EQ(packed.section("triangles").at("codec"), "index");
  EXPECT_LT(studio().blob(id, true)->data.size(), studio().blob(id, false)->data.size() / 2);
  EXPECT_EQ(studio().blob(id, true), studio().blob(id, true)) << "encoded once";
}

TEST_F(SessionPages, PointsComeInPartsOfWhichTheFirstIsEven) {
  open_shape("sphere", 350'000, 5);
  const Json last = page().wait("points", 0, is_final);
  const std::vector<Json> parts = page().events("points");
  ASSERT_EQ(parts.size(), 2U);
  EXPECT_EQ(parts[0].at("from"), 0);
  EXPECT_EQ(parts[0].at("count"), 200'000);
  EXPECT_EQ(parts[1].at("from"), 200'000);
  EXPECT_EQ(parts[1].at("count"), 150'000);
  EXPECT_EQ(last.at("total"), 350'000);
  const BlobReader first = blob(parts[0].at("blob"));
  const BlobReader second = blob(parts[1].at("blob"));
  EXPECT_EQ(first.lower(), second.lower()) << "one box for all";
  const auto positions = first.positions();
  for (std::size_t axis = 0; axis < 3; ++axis) {
    const auto above = std::count_if(positions.begin(), positions.end(), [axis](const auto& p) { return p[axis] > 0; });
    EXPECT_NEAR(static_cast<double>(above), 100'000, 2'000) << axis;
  }
}

TEST_F(SessionPages, APageMayLeaveWhileItsRequestIsWorkedOn) {
  open_shape();
  {
    const auto other = another_page();
    for (int i = 0; i < 5; ++i) other->send("apply", {{"operation", lift(0.01)}});
  }
  EXPECT_EQ(page().ask("apply", {{"operation", lift(0.01)}}).at("done"), 6);
}

TEST_F(SessionPages, TheEndIsTold) {
  start();
  const auto other = another_page();
  stop();
  EXPECT_EQ(other->count("closing"), 1U);
}

}  // namespace
}  // namespace pointskin
