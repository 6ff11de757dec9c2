// pointskin edit with whole documents: the clouds, options and operations of a scene, replayed to the bytes of the scene.
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "cli/schema.hpp"
#include "studio/scene/scene_support.hpp"

namespace pointskin::test {
namespace {

using Json = nlohmann::json;
using Args = std::vector<std::string>;

class EditDocument : public testing::Test {
 protected:
  EditDocument() { write_cloud(cloud_, small_cloud()); }

  /// A session with one operation of every kind, saved; `mesh_` is what its scene shows.
  void save_session() {
    scene::Document document;
    document.base.clouds.push_back(scene::cloud_of_file(cloud_));
    stamp_clouds(document.base);
    scene::SceneOptions options = small_options();
    document.options = options.reconstruction;
    scene::ReadFacts facts;
    scene::Scene scene(load_base(document.base.clouds, {.shift = scene::shift_of(document.base.shift)},
                                 scene::MissingNormals::refused, facts),
                       options);
    for (const std::string& text : one_of_every_kind()) {
      scene.apply(operation_from(text));
      document.operations.push_back(scene::to_json(scene.operation(scene.done() - 1), ""));
    }
    scene.undo();
    document.done = scene.done();
    write_document(script_, document);
    write_mesh(mesh_, scene.mesh());
  }

  Result edit(const Args& more = {}) {
    Args args = {"edit", "--script", script_, "-o", output_};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  TemporaryFolder folder_;
  std::string cloud_ = folder_ / "cloud.ply";
  std::string script_ = folder_ / "scene.json";
  std::string mesh_ = folder_ / "mesh.ply";
  std::string output_ = folder_ / "out.ply";
};

TEST_F(EditDocument, MayNotBeAFolder) {
  script_ = folder_ / "scenes";
  std::filesystem::create_directory(script_);
  const Result result = edit();
  EXPECT_EQ(result.exit_code, 3);
  EXPECT_NE(result.err.find("cannot be read"), std::string::npos) << result.err;
}

TEST_F(EditDocument, GivesTheBytesOfTheSceneThatWasSaved) {
  save_session();
  const std::string report = folder_ / "report.json", saved = folder_ / "saved.json";
  const Result result = edit({"--report", report, "--save", saved, "--threads", "1"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(read_file(output_), read_file(mesh_));
  const Json json = Json::parse(read_file(report));
  const Json schema = Json::parse(read_file(std::string(POINTSKIN_SOURCE_DIR) + "/docs/edit.schema.json"));
  EXPECT_EQ(schema_violations(schema, json), std::vector<std::string>());
  EXPECT_EQ(json["steps"].size(), one_of_every_kind().size() - 1);
  EXPECT_EQ(json["options"]["depth"], 5);
  for (const char* kind : {"deform", "boolean", "orient", "options"})
    EXPECT_NE(result.err.find(std::string(": ") + kind + ": "), std::string::npos) << result.err;
  EXPECT_EQ(read_file(saved), read_file(script_));  // what was undone is still there
}

TEST_F(EditDocument, OptionsAndCloudsOfTheCommandLineCount) {
  save_session();
  const std::string report = folder_ / "report.json";
  ASSERT_EQ(edit({"--depth", "4", "--cold", "--report", report}).exit_code, 0);
  const Json options = Json::parse(read_file(report))["options"];
  EXPECT_EQ(options["depth"], 4);
  EXPECT_EQ(options["warm_start"], false);
  EXPECT_NE(read_file(output_), read_file(mesh_));
  const std::string other = folder_ / "other.ply";
  write_cloud(other, small_cloud(2500));
  const Result result = edit({other});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(read_file(output_), read_file(mesh_));
}

TEST_F(EditDocument, TellsWhatHasChangedAndWhatIsMissing) {
  save_session();
  write_cloud(cloud_, small_cloud(2900));
  const Result changed = edit();
  EXPECT_EQ(changed.exit_code, 0) << changed.err;
  EXPECT_NE(changed.err.find("cloud.ply: has changed since the document was written"), std::string::npos);
  std::filesystem::remove(cloud_);
  std::filesystem::remove(output_);
  expect_error(edit(), 3, "cloud.ply");
  write_file(script_, R"({"version": 1, "operations": []})");
  expect_error(edit(), 2, "no cloud");
  EXPECT_FALSE(std::filesystem::exists(output_));
}

TEST_F(EditDocument, EstimatesNormalsFirstIfItIsToldTo) {
  Cloud bare = small_cloud();
  bare.normals.clear();
  write_cloud(cloud_, bare);
  const std::string begin =
      R"({"version": 1, "clouds": [{"file": "cloud.ply"}], "options": {"depth": 5}, "operations": [)";
  write_file(script_, begin + R"({"op": "orient", "method": "estimate"}]})");
  const Result result = edit();
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("0: normals by propagate: "), std::string::npos) << result.err;
  write_file(script_, begin + R"({"op": "options", "depth": 4}]})");
  EXPECT_EQ(edit().exit_code, 4);
}

TEST_F(EditDocument, NeverReplacesAFileThatItReads) {
  save_session();
  Args args = {"edit", "--script", script_, "-o", cloud_};
  expect_error(pointskin_run(args), 2, "cloud.ply");
}

}  // namespace
}  // namespace pointskin::test
