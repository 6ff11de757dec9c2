// check: its JSON against its schema, and --self-intersections.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "cli/schema.hpp"
#include "support/shapes.hpp"

namespace pointskin::test {
namespace {

using Json = nlohmann::json;

class CheckCommand : public testing::Test {
 protected:
  std::string save(const char* name, const Mesh& mesh) {
    write_mesh(folder_ / name, mesh);
    return folder_ / name;
  }

  /// What check prints as JSON, which follows the schema.
  Json json_of(std::vector<std::string> args, int exit_code) {
    args.insert(args.begin(), "check");
    args.emplace_back("--json");
    const Result result = pointskin_run(args);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(result.err, "");
    Json json = Json::parse(result.out);
    const Json rules = Json::parse(read_file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/check.schema.json"));
    for (const std::string& violation : schema_violations(rules, json, "check")) ADD_FAILURE() << violation;
    return json;
  }

  /// Two boxes, closed and oriented, one through the other.
  static Mesh crossed_boxes() {
    Mesh mesh = box_mesh();
    append(mesh, box_mesh({0.25, 0.375, 0.5}, {2, 2, 2}));
    return mesh;
  }

  TemporaryFolder folder_;
};

TEST_F(CheckCommand, LooksForSelfIntersectionsOnlyWhereAsked) {
  const std::string crossed = save("crossed.ply", crossed_boxes());
  EXPECT_FALSE(json_of({crossed}, 0).contains("self_intersections"));
  const std::string sound = save("sound.ply", torus_mesh(30, 20));
  const Json none = json_of({sound, "--self-intersections"}, 0);
  EXPECT_EQ(none["self_intersections"],
            (Json{{"pairs", 0}, {"touching", 0}, {"triangles", 0}, {"listed", Json::array()}}));
}

TEST_F(CheckCommand, FailsAMeshThatPassesThroughItselfWithExitFive) {
  Mesh mesh = crossed_boxes();
  mesh.origin = {1e6, 2e6, 500};
  const std::string path = save("crossed.ply", mesh);
  const Json check = json_of({path, "--self-intersections"}, 5);
  EXPECT_EQ(check["watertight"], true);  // that says nothing of space
  const Json& found = check["self_intersections"];
  const SelfIntersections expected = find_self_intersections(mesh);
  EXPECT_EQ(found["pairs"], expected.pairs);
  EXPECT_EQ(found["triangles"], expected.triangles);
  EXPECT_EQ(found["touching"], 0);
  ASSERT_EQ(found["listed"].size(), 10U);
  EXPECT_EQ(found["listed"][0]["kind"], "crossing");
  EXPECT_EQ(found["listed"][0]["triangles"], expected.listed[0].triangles);
  for (std::size_t axis = 0; axis < 3; ++axis)
    EXPECT_NEAR(found["listed"][0]["place"][axis].get<double>(), expected.listed[0].place_world[axis], 1e-6);
}

TEST_F(CheckCommand, TellsTouchesFromCrossings) {
  Mesh mesh = box_mesh();
  append(mesh, box_mesh({1, 1, 1}, {2, 2, 2}));
  const Json found = json_of({save("touch.ply", mesh), "--self-intersections"}, 5)["self_intersections"];
  EXPECT_GT(found["pairs"], 0);
  EXPECT_EQ(found["touching"], found["pairs"]);
  EXPECT_EQ(found["listed"][0]["kind"], "touching");
  EXPECT_EQ(found["listed"][0]["place"], (Json{1, 1, 1}));
}

TEST_F(CheckCommand, StillFailsAnOpenMeshWithoutSelfIntersections) {
  const Json open = json_of({save("open.ply", patch_mesh(3)), "--self-intersections"}, 5);
  EXPECT_EQ(open["watertight"], false);
  EXPECT_EQ(open["self_intersections"]["pairs"], 0);
}

TEST_F(CheckCommand, SpeaksToPeopleOfSelfIntersections) {
  const std::string crossed = save("crossed.ply", crossed_boxes());
  const Result no = pointskin_run({"check", crossed, "--self-intersections"});
  EXPECT_EQ(no.exit_code, 5);
  EXPECT_NE(no.out.find("watertight  yes\n"), std::string::npos) << no.out;
  EXPECT_NE(no.out.find("embedded    no ("), std::string::npos) << no.out;
  EXPECT_NE(no.out.find(" cross at "), std::string::npos) << no.out;
  const Result yes = pointskin_run({"check", save("sound.ply", box_mesh()), "--self-intersections"});
  EXPECT_EQ(yes.exit_code, 0);
  EXPECT_NE(yes.out.find("embedded    yes ("), std::string::npos) << yes.out;
  EXPECT_EQ(pointskin_run({"check", crossed}).out.find("embedded"), std::string::npos);
}

TEST_F(CheckCommand, PrintsTheSameForAnyNumberOfThreads) {
  const std::string crossed = save("crossed.ply", crossed_boxes());
  const auto out = [&](const char* threads) {
    return pointskin_run({"check", crossed, "--self-intersections", "--json", "--threads", threads}).out;
  };
  EXPECT_EQ(out("1"), out("3"));
}

TEST_F(CheckCommand, SaysTheSameWithLittleMemory) {
#if defined(__SANITIZE_ADDRESS__) || defined(__SANITIZE_THREAD__)
  GTEST_SKIP() << "the sanitizer's own memory counts as the program's";
#endif
  Mesh mesh = torus_mesh(700, 400);
  mesh.triangles.pop_back();
  mesh.origin = {1e6, 0, -3};
  const std::string file = save("torus.ply", mesh);  // 280,000 vertices: 23 MB in memory
  const Json whole = json_of({file}, 5);
  EXPECT_EQ(whole["boundary_edges"], 3);
  for (const char* limit : {"16M", "24M", "1G"}) EXPECT_EQ(json_of({file, "--max-memory", limit}, 5), whole) << limit;
  for (const char* limit : {"1K", "6M"})
    expect_error(pointskin_run({"check", file, "--max-memory", limit}), 6, "--max-memory");
  write_mesh(folder_ / "text.ply", mesh, {.ascii = true});
  expect_error(pointskin_run({"check", folder_ / "text.ply", "--max-memory", "20M"}), 6, "convert");
  expect_error(pointskin_run({"check", file, "--max-memory", "1G", "--self-intersections"}), 2, "--max-memory");
}

}  // namespace
}  // namespace pointskin::test
