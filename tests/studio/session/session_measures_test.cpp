// What panels ask: problems, comparison, numbers to colour by, densities, costs, and the place under the pointer.
#include <pointskin/io.hpp>
#include <pointskin/merge.hpp>

#include <algorithm>
#include <cmath>
#include <numeric>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "studio/session/studio_fixture.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::BlobReader;
using test::in_rectangle;
using test::Json;
using test::pixel;
using test::StudioTest;

class SessionMeasures : public StudioTest {
 protected:
  /// Half of the shape: the surface over the hole is a guess.
  void cut_in_half() {
    const Json cut = in_rectangle("remove", pixel(0, 1.1), pixel(1.1, -1.1));
    (void)page().ask("apply", {{"operation", cut}});
  }
  std::vector<float> shown_values(const std::string& name) {
    const Json mesh = page().last("mesh");
    EXPECT_EQ(mesh.at("values"), Json::array({name}));
    const BlobReader shown = blob(mesh.at("blob"));
    const auto values = shown.numbers<float>("values:" + name);
    EXPECT_EQ(values.size(), shown.header().at("vertices").get<std::size_t>());
    return values;
  }
};

TEST_F(SessionMeasures, ProblemsAreWhereTheSurfaceIsAGuess) {
  open_shape("sphere");
  cut_in_half();
  const Json reply = page().ask("problems");
  const Json& regions = reply.at("regions");
  ASSERT_FALSE(regions.empty());
  EXPECT_GT(regions[0].at("centroid")[0], 0.0) << "where the points were removed";
  EXPECT_NEAR(regions[0].at("centroid")[1].get<double>(), 0, 0.3);
  EXPECT_FALSE(regions[0].at("views").empty());
  for (std::size_t i = 1; i < regions.size(); ++i) EXPECT_GE(regions[i - 1].at("score"), regions[i].at("score"));
  EXPECT_EQ(page().ask("problems").at("regions"), regions);
}

TEST_F(SessionMeasures, AComparisonIsATableAndAHeatMap) {
  open_shape("sphere", 20'000, 6);
  const Json table = page().ask("compare", {{"reference", {{"shape", "sphere"}, {"points", 20'000}}}});
  EXPECT_LT(table.at("two_sided").at("mean_percent"), 0.5);
  EXPECT_GT(table.at("f_score"), 0.9);
  for (const float d : shown_values("distance")) ASSERT_LT(std::abs(d), 0.1F);
  (void)page().ask("reference_end");
  EXPECT_TRUE(page().last("mesh").at("values").empty());
}

TEST_F(SessionMeasures, AReferenceMayBeAMeshInAFile) {
  open_shape("sphere", 20'000, 6);
  (void)page().ask("save", {{"what", "mesh"}, {"name", "reference.ply"}});
  const Json table = page().ask("compare", {{"reference", {{"path", "reference.ply"}}}});
  EXPECT_EQ(table.at("reference"), "reference.ply");
  EXPECT_LT(table.at("two_sided").at("max"), 1e-5) << "the mesh itself";
}

TEST_F(SessionMeasures, NumbersOfVerticesComeByName) {
  open_shape("sphere");
  cut_in_half();
  (void)page().ask("values", {{"name", "distance"}});
  const std::vector<float> distances = shown_values("distance");
  EXPECT_GT(*std::max_element(distances.begin(), distances.end()), 0.5F) << "the middle of the hole is far from points";
  (void)page().ask("values", {{"name", "density"}});
  for (const float d : shown_values("density")) ASSERT_GE(d, 0.0F);
  (void)page().ask("values", {{"name", "weakness"}});
  for (const float w : shown_values("weakness")) ASSERT_TRUE(w >= 0 && w <= 1) << w;
  EXPECT_EQ(page().refusal("values", {{"name", "beauty"}}), "usage");
  (void)page().ask("values_end");
  EXPECT_TRUE(page().last("mesh").at("values").empty());
}

TEST_F(SessionMeasures, NumbersOfThePointsAreSpreadOverTheSurface) {
  Cloud cloud = test::torus_cloud(5'000, 3, 0.7, 0.25);
  std::vector<float> confidence(cloud.positions.size());
  for (std::size_t i = 0; i < confidence.size(); ++i) confidence[i] = cloud.positions[i].x > 0 ? 1.0F : 0.25F;
  cloud.attributes.push_back({"confidence", confidence});
  write_cloud(file("a.ply"), cloud);
  start();
  (void)page().ask("open", {{"files", {{{"path", "a.ply"}}}}, {"options", {{"depth", 5}}}});
  (void)page().ask("values", {{"name", "confidence"}});
  const std::vector<float> values = shown_values("confidence");
  const auto positions = blob(page().last("mesh").at("blob")).positions();
  for (std::size_t i = 0; i < values.size(); ++i)
    if (std::abs(positions[i].x) > 0.3) {
      ASSERT_NEAR(values[i], positions[i].x > 0 ? 1 : 0.25, 0.05) << i;
    }
}

TEST_F(SessionMeasures, TheHistogramSaysWhatATrimCutsOff) {
  Cloud half = test::sphere_cloud(6'000, 3);
  std::vector<bool> keep;
  for (const Vec3f& p : half.positions) keep.push_back(p.x < 0);
  keep_where(half, keep);
  write_cloud(file("half.ply"), half);
  start();
  (void)page().ask("open", {{"files", {{{"path", "half.ply"}}}}, {"options", {{"depth", 5}}}});
  const Json histogram = page().ask("histogram");
  const auto edges = histogram.at("densities").at("edges").get<std::vector<double>>();
  const auto shares = histogram.at("densities").at("counts").get<std::vector<double>>();
  ASSERT_EQ(edges.size(), shares.size() + 1);
  EXPECT_TRUE(std::is_sorted(edges.begin(), edges.end()));
  EXPECT_NEAR(std::accumulate(shares.begin(), shares.end(), 0.0), 1, 1e-6);
  std::vector<double> thresholds;
  for (const Json& entry : histogram.at("quantiles")) thresholds.push_back(entry[1]);
  EXPECT_TRUE(std::is_sorted(thresholds.begin(), thresholds.end()));

  constexpr double kTrim = 0.05;
  double threshold = 0;
  for (const Json& entry : histogram.at("quantiles"))
    if (entry[0] <= kTrim) threshold = entry[1];
  double below = 0;
  for (std::size_t i = 0; i < shares.size(); ++i) below += edges[i + 1] < threshold ? shares[i] : 0;
  const double before = fresh_scene().at("surface").at("area");
  (void)page().ask("options", {{"patch", {{"trim", kTrim}}}, {"final", true}});
  const double after = fresh_scene().at("surface").at("area");
  EXPECT_GT(below, 0.3);
  EXPECT_NEAR(1 - after / before, below, 0.12);
}

TEST_F(SessionMeasures, CostsGrowWithDepthAndAreNearWhatWasMeasured) {
  open_shape("sphere", 20'000, 6);
  const Json depths = page().ask("estimate", {{"options", {{"depth", 6}}}}).at("depths");
  ASSERT_GE(depths.size(), 3U);
  bool has_six = false;
  for (std::size_t i = 0; i < depths.size(); ++i) {
    if (i > 0) {
      EXPECT_GE(depths[i].at("bytes"), depths[i - 1].at("bytes"));
    }
    EXPECT_TRUE(depths[i].at("ms").is_number());
    has_six |= depths[i].at("depth") == 6;
  }
  EXPECT_TRUE(has_six);
}

TEST_F(SessionMeasures, AMemoryThatWouldNotSufficeIsToldBefore) {
  open_shape("sphere");
  EXPECT_NE(page().refusal("estimate", {{"options", {{"depth", 40}}}}), "");
  const Json depths = page().ask("estimate").at("depths");
  EXPECT_GT(depths.back().at("bytes"), 1'000'000);
}

TEST_F(SessionMeasures, ARayFindsThePlaceUnderThePointer) {
  open_shape("torus", 20'000, 6);
  const Json hit = page().ask("pick", {{"origin", {0.7, 0, 3}}, {"direction", {0, 0, -2}}});
  EXPECT_NEAR(hit.at("point")[0].get<double>(), 0.7, 1e-6);
  EXPECT_NEAR(hit.at("point")[2].get<double>(), 0.25, 0.02);
  EXPECT_GT(hit.at("normal")[2], 0.95);
  EXPECT_NEAR(hit.at("distance").get<double>(), (3 - 0.25) / 2, 0.02);
  EXPECT_EQ(page().ask("pick", {{"origin", {0, 0, 3}}, {"direction", {0, 0, -1}}}).at("point"), nullptr)
      << "through the hole";
}

TEST_F(SessionMeasures, ALargeSurfaceIsShownCoarserAndSavedInFull) {
  studio::StudioOptions options;
  options.most_shown = 5'000;
  start(std::move(options));
  open_shape("sphere", 40'000, 7);
  const Json mesh = page().last("mesh");
  const auto triangles = mesh.at("triangles").get<std::int64_t>(),
             whole = mesh.at("full_triangles").get<std::int64_t>();
  EXPECT_GT(whole, 30'000);
  EXPECT_LE(triangles, 5'000);
  EXPECT_GT(triangles, 1'000);
  EXPECT_EQ(mesh.at("depth"), 4) << "at depth 5 there are too many";
  EXPECT_EQ(blob(mesh.at("blob")).header().at("triangles"), triangles);
  const Json points = page().last("points");
  EXPECT_EQ(points.at("total"), 40'000);
  EXPECT_EQ(points.at("from").get<int>() + points.at("count").get<int>(), 5'000);

  (void)page().ask("save", {{"what", "mesh"}, {"name", "whole.ply"}});
  EXPECT_EQ(static_cast<std::int64_t>(read_mesh(file("whole.ply")).triangles.size()), whole);

  (void)page().ask("values", {{"name", "distance"}});
  EXPECT_EQ(static_cast<std::int64_t>(shown_values("distance").size()), mesh.at("vertices"));
  (void)page().ask("values", {{"name", "density"}});
  EXPECT_EQ(page().last("mesh").at("triangles"), triangles);
  EXPECT_EQ(page().last("mesh").at("depth"), 4);
}

TEST_F(SessionMeasures, WhatWasMeasuredDoesNotOutliveTheScene) {
  open_shape("sphere");
  const Json before = page().ask("histogram");
  cut_in_half();
  EXPECT_NE(page().ask("histogram").at("densities"), before.at("densities"));
  (void)page().ask("undo");
  EXPECT_EQ(page().ask("histogram").at("densities"), before.at("densities"));
}

}  // namespace
}  // namespace pointskin
