// Files through messages: opened, uploaded, listed and saved below the root alone, atomically, with the bytes of the CLI.
#include <pointskin/formats.hpp>
#include <pointskin/io.hpp>

#include <filesystem>
#include <fstream>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "scene/document.hpp"
#include "scene/sha256.hpp"
#include "studio/session/studio_fixture.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

namespace fs = std::filesystem;

using test::guide;
using test::Json;
using test::lift;
using test::pixel;
using test::StudioTest;

class SessionFiles : public StudioTest {
 protected:
  void write_torus(const std::string& name, std::int64_t points = 5'000) {
    write_cloud(file(name), test::torus_cloud(points, 3, 0.7, 0.25));
  }
  void apply(const Json& operation) { (void)page().ask("apply", {{"operation", operation}}); }
  Json save(const std::string& what, const std::string& name) {
    return page().ask("save", {{"what", what}, {"name", name}});
  }
  Json open_file(const std::string& path) { return page().ask("open", {{"files", {{{"path", path}}}}}); }
  /// The kind that the listing of the root gives a name; "" if it does not list it.
  std::string kind(const std::string& name) {
    const Json listing = page().ask("files", {{"folder", ""}});
    for (const Json& entry : listing.at("entries"))
      if (entry.at("name") == name) return entry.at("kind");
    return "";
  }
};

TEST_F(SessionFiles, FilesBelowTheRootAreListedByKinds) {
  write_torus("a.ply");
  write_torus("frame_1.ply");
  write_torus("frame_2.ply");
  fs::create_directory(root() / "more");
  std::ofstream(file("scene.json")) << "{}";
  std::ofstream(file("notes.txt")) << "no cloud";
  std::ofstream(file("part.stl")) << "solid x\nendsolid x\n";
  start();
  EXPECT_EQ(kind("a.ply"), "cloud");
  EXPECT_EQ(kind("more"), "folder");
  EXPECT_EQ(kind("scene.json"), "session");
  EXPECT_EQ(kind("part.stl"), "mesh");
  EXPECT_EQ(kind("frame_{}.ply"), "sequence");
  EXPECT_EQ(page().ask("files", {{"folder", "more"}}).at("entries").size(), 0U);
  EXPECT_EQ(page().refusal("files", {{"folder", "none"}}), "invalid_input");
}

TEST_F(SessionFiles, NothingOutsideOfTheRootIsReadOrWritten) {
  const fs::path outside = root().parent_path() / "outside.ply";
  write_torus("a.ply");
  fs::copy_file(file("a.ply"), outside);
  fs::create_symlink(outside, file("link.ply"));
  fs::create_directory_symlink(root().parent_path(), file("up"));
  start();
  for (const std::string path : {"../outside.ply", "link.ply", "up/outside.ply", "/etc/passwd", "none.ply", ""})
    EXPECT_EQ(page().refusal("open", {{"files", {{{"path", path}}}}}), "invalid_input") << path;
  EXPECT_EQ(page().refusal("open", {{"files", {{{"path", outside.string()}}}}}), "invalid_input");
  EXPECT_EQ(page().refusal("files", {{"folder", "up"}}), "invalid_input");
  (void)open_file("a.ply");
  for (const std::string name : {"../b.ply", "up/b.ply", "/tmp/b.ply", "", ".."})
    EXPECT_NE(page().refusal("save", {{"what", "mesh"}, {"name", name}}), "") << name;
  EXPECT_NE(page().refusal("save", {{"what", "mesh"}, {"name", "b.ply"}, {"folder", "up"}}), "");
  EXPECT_NE(page().refusal("save", {{"what", "mesh"}, {"name", "link.ply"}, {"overwrite", true}}), "");
  EXPECT_EQ(fs::file_size(outside), fs::file_size(file("a.ply")));
  EXPECT_FALSE(fs::exists(root().parent_path() / "b.ply"));
}

TEST_F(SessionFiles, MeshesAndPointsSayWhichSceneTheyBelongTo) {
  write_torus("a.ply");
  write_torus("b.ply", 4'000);
  start();
  (void)open_file("a.ply");
  const Json first = page().last("mesh").at("scene");
  apply(guide({pixel(-0.9, 0), pixel(0.9, 0)}));
  EXPECT_EQ(page().last("mesh").at("scene"), first) << "a step goes on with the scene";
  EXPECT_EQ(page().events("points").front().at("scene"), first);
  (void)open_file("b.ply");
  EXPECT_NE(page().last("mesh").at("scene"), first);
  EXPECT_EQ(page().last("points").at("scene"), page().last("mesh").at("scene"));
}

TEST_F(SessionFiles, WhatCannotBeOpenedLeavesTheSceneBeforeOnThePage) {
  write_torus("a.ply");
  write_torus("b.ply", 4'000);
  start();
  (void)open_file("a.ply");
  const std::string expected = digest();
  const Json mesh = page().last("mesh");
  fs::remove_all(folder());  // no place for a journal: found out when the points were shown
  EXPECT_EQ(page().refusal("open", {{"files", {{{"path", "b.ply"}}}}}), "output_not_written");
  fs::create_directory(folder());
  const Json again = page().wait("mesh", 0, [&](const Json& e) { return e.at("version") > mesh.at("version"); });
  EXPECT_EQ(again.at("scene"), mesh.at("scene"));
  EXPECT_EQ(again.at("triangles"), mesh.at("triangles"));
  const auto is_of_a = [](const Json& e) { return e.at("total") == 5'000; };
  const Json points = page().wait("points", page().count("points") - 1, is_of_a);
  EXPECT_EQ(points.at("scene"), mesh.at("scene"));
  EXPECT_EQ(digest(), expected);
}

TEST_F(SessionFiles, AnUploadIsOpenedLikeAFile) {
  write_torus("a.ply");
  start();
  (void)open_file("a.ply");
  const std::string expected = digest();
  const fs::path sent = studio().upload_folder() / "sent";
  fs::copy_file(file("a.ply"), sent);
  const std::uint64_t id = studio().uploaded(sent, "../../my scan.ply");
  EXPECT_FALSE(fs::exists(sent)) << "the studio has taken it over";
  (void)page().ask("open", {{"files", {{{"upload", id}}}}});
  EXPECT_EQ(digest(), expected);
  EXPECT_EQ(fresh_scene().at("clouds")[0].at("name"), "my scan.ply");
  EXPECT_EQ(page().refusal("open", {{"files", {{{"upload", id + 1}}}}}), "usage");
}

TEST_F(SessionFiles, EveryFormatOfMeshesIsSaved) {
  open_shape();
  const std::size_t triangles = page().last("mesh").at("triangles");
  for (const FormatInfo& format : file_formats()) {
    if (!format.writes_meshes) continue;
    const std::string name = "mesh" + format.extensions.front();
    const Json saved = save("mesh", name);
    EXPECT_EQ(saved.at("path"), file(name));
    EXPECT_EQ(saved.at("bytes"), fs::file_size(file(name))) << name;
    if (format.reads_meshes) {
      EXPECT_EQ(read_mesh(file(name)).triangles.size(), triangles) << name;
    }
  }
  EXPECT_EQ(scene::sha256_of_file(file("mesh.ply")), digest());
  EXPECT_EQ(page().refusal("save", {{"what", "mesh"}, {"name", "mesh.doc"}}), "usage");
}

TEST_F(SessionFiles, TheEditedCloudIsSavedInEveryFormatOfClouds) {
  open_shape();
  apply(guide({pixel(-0.9, 0), pixel(0.9, 0)}, 0.05));
  const std::int64_t points = fresh_scene().at("points");
  EXPECT_GT(points, 6'000);
  for (const FormatInfo& format : file_formats()) {
    if (!format.writes_clouds) continue;
    const std::string name = "cloud" + format.extensions.front();
    (void)save("cloud", name);
    EXPECT_EQ(read_cloud(file(name)).size(), points) << name;
  }
}

TEST_F(SessionFiles, AFileThatIsThereIsReplacedOnlyWhenAskedFor) {
  open_shape();
  std::ofstream(file("mesh.ply")) << "mine";
  EXPECT_NE(page().refusal("save", {{"what", "mesh"}, {"name", "mesh.ply"}}), "");
  EXPECT_EQ(fs::file_size(file("mesh.ply")), 4U);
  (void)page().ask("save", {{"what", "mesh"}, {"name", "mesh.ply"}, {"overwrite", true}});
  EXPECT_EQ(scene::sha256_of_file(file("mesh.ply")), digest());
  const auto files = fs::directory_iterator(root());
  EXPECT_EQ(std::distance(begin(files), end(files)), 1) << "nothing else is left behind";
}

TEST_F(SessionFiles, ADownloadIsThereOnce) {
  open_shape();
  const Json saved = page().ask("save", {{"what", "mesh"}, {"name", "torus.ply"}, {"download", true}});
  const auto download = studio().download(saved.at("download"));
  ASSERT_TRUE(download.has_value());
  EXPECT_EQ(download->name, "torus.ply");
  EXPECT_TRUE(download->temporary);
  EXPECT_EQ(scene::sha256_of_file(download->file.string()), digest());
  EXPECT_FALSE(studio().download(saved.at("download")).has_value());
  EXPECT_FALSE(fs::exists(root() / "torus.ply"));
}

TEST_F(SessionFiles, ASessionBringsBackSceneAndHistory) {
  write_torus("a.ply");
  start();
  (void)open_file("a.ply");
  apply(lift(0.2));
  apply(guide({pixel(-0.9, 0), pixel(0.9, 0)}, 0.05));
  apply({{"op", "options"}, {"depth", 6}});
  (void)page().ask("undo");
  const std::string before = digest();
  (void)save("session", "mine.json");
  const Json document = Json::parse(std::ifstream(file("mine.json")));
  EXPECT_EQ(document.at("clouds")[0].at("file"), "a.ply") << "as seen from the session's folder";
  EXPECT_EQ(document.at("clouds")[0].at("sha256"), scene::sha256_of_file(file("a.ply")));
  start();
  (void)page().ask("resume", {{"path", "mine.json"}});
  EXPECT_EQ(digest(), before);
  EXPECT_EQ(fresh_scene().at("history").size(), 3U);
  EXPECT_EQ(fresh_scene().at("done"), 2);
  (void)page().ask("redo");
  EXPECT_EQ(page().last("mesh").at("depth"), 6);
}

TEST_F(SessionFiles, ASessionWhoseCloudChangedSaysSo) {
  write_torus("a.ply");
  start();
  (void)open_file("a.ply");
  (void)save("session", "mine.json");
  write_torus("a.ply", 4'000);
  (void)page().ask("resume", {{"path", "mine.json"}});
  const Json notice = page().last("notice");
  EXPECT_EQ(notice.at("level"), "warning");
  EXPECT_NE(notice.at("text").get<std::string>().find("a.ply"), std::string::npos);
}

TEST_F(SessionFiles, AScriptGivesTheSameBytesElsewhere) {
  open_shape();
  const std::vector<Json> operations = {lift(0.2), guide({pixel(-0.9, 0), pixel(0.9, 0)}, 0)};
  for (const Json& operation : operations) apply(operation);
  (void)save("script", "script.json");
  const scene::Document script = scene::read_document(file("script.json"));
  EXPECT_TRUE(script.base.clouds.empty());
  EXPECT_GT(script.operations[1].at("interval"), 0.0) << "the number that was used";
  EXPECT_EQ(script.options.depth, 5);
  EXPECT_EQ(test::replayed("torus", 6'000, 5, {script.operations.begin(), script.operations.end()}), digest());
}

TEST_F(SessionFiles, APictureOfThePageIsSaved) {
  open_shape();
  const fs::path sent = studio().upload_folder() / "sent";
  std::ofstream(sent) << "a picture";
  const std::uint64_t id = studio().uploaded(sent, "canvas.png");
  (void)page().ask("save", {{"what", "picture"}, {"upload", id}, {"name", "view.png"}});
  EXPECT_EQ(fs::file_size(file("view.png")), 9U);
}

TEST_F(SessionFiles, ACloudWithoutNormalsIsOpenedAndGetsThem) {
  Cloud cloud = test::torus_cloud(5'000, 3, 0.7, 0.25);
  cloud.normals.clear();
  write_cloud(file("bare.ply"), cloud);
  start();
  (void)open_file("bare.ply");
  EXPECT_EQ(fresh_scene().at("normals"), false);
  EXPECT_EQ(page().last("mesh").at("triangles"), 0);
  EXPECT_EQ(page().refusal("apply", {{"operation", lift(0.1)}}), "no_normals");
  EXPECT_EQ(page().refusal("preview", {{"operation", lift(0.1)}}), "no_normals");
  apply({{"op", "orient"}, {"method", "estimate"}});
  EXPECT_EQ(scene().at("normals"), true);
  EXPECT_GT(page().last("mesh").at("triangles"), 1'000);
  (void)page().ask("undo");
  EXPECT_EQ(page().last("mesh").at("triangles"), 0);
  EXPECT_EQ(scene().at("normals"), false);
}

}  // namespace
}  // namespace pointskin
