// The table of formats: what files are taken for, and that every format does what the table says.
#include <gtest/gtest.h>

#include <set>
#include <string>

#include <pointskin/error.hpp>
#include <pointskin/formats.hpp>

#include "support/io_files.hpp"
#include "support/shapes.hpp"

namespace pointskin {
namespace {

using test::story_of;

TEST(Formats, HaveNamesAndExtensionsOfTheirOwn) {
  std::set<std::string> seen;
  for (const FormatInfo& format : file_formats()) {
    EXPECT_TRUE(seen.insert(format.name).second) << format.name;
    EXPECT_FALSE(format.extensions.empty()) << format.name;
    for (const std::string& extension : format.extensions) {
      EXPECT_TRUE(seen.insert(extension).second) << extension;
      EXPECT_EQ(extension_of("some/file" + extension), extension);
      EXPECT_EQ(format_of("some/file" + extension), &format);
    }
    EXPECT_TRUE(format.reads_clouds || !format.reads_meshes) << format.name << ": a mesh is read as a cloud, too";
    EXPECT_TRUE(format.reads_clouds || format.writes_meshes || !format.built)
        << format.name << ": nothing is done with it";
  }
}

TEST(Formats, TheFirstHoldsEverything) {
  const FormatInfo& first = file_formats().front();
  EXPECT_EQ(first.attributes, HeldAttributes::all);
  EXPECT_TRUE(first.reads_clouds && first.reads_meshes && first.writes_clouds && first.writes_meshes);
}

TEST(Formats, AreFoundByTheExtensionWhateverItsCase) {
  EXPECT_EQ(extension_of("a.b/Scan.PLY"), ".ply");
  EXPECT_EQ(extension_of("a.b/scan"), "");
  EXPECT_EQ(extension_of("a.b/.ply"), "") << "a hidden file";
  EXPECT_EQ(extension_of("-"), "");
  ASSERT_NE(format_of("a/Mesh.STL"), nullptr);
  EXPECT_EQ(format_of("a/Mesh.STL")->name, "STL");
  EXPECT_EQ(format_of("a.ply/mesh"), nullptr);
  EXPECT_EQ(format_of("mesh.step"), nullptr);
}

TEST(Formats, ExtensionsMakeASentence) {
  FormatInfo a{.name = "A", .extensions = {".a", ".aa"}, .writes_clouds = true};
  FormatInfo b{.name = "B", .extensions = {".b"}, .reads_meshes = true, .writes_clouds = true};
  const FormatInfo both[] = {a, b};
  EXPECT_EQ(extension_list(&FormatInfo::writes_clouds, both), ".a, .aa or .b");
  EXPECT_EQ(extension_list(&FormatInfo::reads_meshes, both), ".b");
  EXPECT_EQ(extension_list(&FormatInfo::writes_meshes, both), "");
}

TEST(Formats, MeshesThatAreWrittenHoldFacesAndAreReadAgain) {
  const test::TemporaryFolder folder;
  const Mesh box = test::box_mesh();
  int written = 0;
  for (const FormatInfo& format : file_formats()) {
    const std::string path = folder.file("box" + format.extensions.front());
    if (!format.writes_meshes) {
      EXPECT_NE(story_of(ErrorCode::usage, [&] { write_mesh(path, box); }), "") << format.name;
      continue;
    }
    ++written;
    write_mesh(path, box);
    if (!format.reads_clouds) {
      const std::string story = story_of(ErrorCode::invalid_input, [&] { read_cloud(path); });
      EXPECT_NE(story.find("is " + format.name + ", which is written, but not read"), std::string::npos) << story;
      EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { read_mesh(path); }), "") << format.name;
      continue;
    }
    EXPECT_TRUE(may_hold_faces(path)) << format.name;
    const Mesh again = read_mesh(path);
    EXPECT_EQ(again.triangles.size(), box.triangles.size()) << format.name;
    EXPECT_EQ(again.vertices.size(), box.vertices.size()) << format.name;
    EXPECT_EQ(read_cloud(path).positions, again.vertices) << format.name;
  }
  EXPECT_GT(written, 0);
}

TEST(Formats, MeshesOfPointsAreRefusedByName) {
  for (const io::Format& format : io::formats())
    if (!format.info.reads_meshes && format.info.reads_clouds) {
      const std::string story = story_of(ErrorCode::invalid_input, [&] {
        io::parse_mesh({"a" + format.info.extensions.front(), "1 2 3\n"}, {});
      });
      const std::string meshes = extension_list(&FormatInfo::reads_meshes);
      EXPECT_NE(story.find("is a file of points, not a mesh; name a " + meshes + " file"), std::string::npos)
          << format.info.name << ": " << story;
    }
}

TEST(Formats, UnknownExtensionsListThoseThatAreKnown) {
  EXPECT_EQ(story_of(ErrorCode::invalid_input, [] { test::mesh_of("a.step", "1 2 3\n"); }),
            "a.step: has the unknown extension '.step'; use " + extension_list(&FormatInfo::reads_meshes));
  EXPECT_EQ(story_of(ErrorCode::invalid_input, [] { test::cloud_of("a.step", "1 2 3\n"); }),
            "a.step: has the unknown extension '.step'; use " + extension_list(&FormatInfo::reads_clouds));
  EXPECT_EQ(story_of(ErrorCode::usage, [] { write_mesh("a.step", test::box_mesh()); }),
            "a.step: unknown extension; use " + extension_list(&FormatInfo::writes_meshes));
}

TEST(MayHoldFaces, AsksTheHeaderOfAPly) {
  const auto header = [](const std::string& faces) { return "ply\nformat ascii 1.0\nelement vertex 3\n" + faces; };
  EXPECT_TRUE(io::may_hold_faces("a.ply", header("element face 12\nend_header\n")));
  EXPECT_TRUE(io::may_hold_faces("a.xyz", header("element face 12\n"))) << "the first bytes count, not the name";
  EXPECT_FALSE(io::may_hold_faces("a.ply", header("element face 0\nend_header\n")));
  EXPECT_FALSE(io::may_hold_faces("a.ply", header("end_header\nelement face 12\n"))) << "that is no header any more";
  EXPECT_FALSE(io::may_hold_faces("a.ply", ""));
}

TEST(MayHoldFaces, GoesByTheNameElsewhere) {
  for (const char* path : {"a.obj", "a.stl", "b/A.OFF"}) EXPECT_TRUE(io::may_hold_faces(path, "")) << path;
  for (const char* path : {"a.xyz", "a.pcd", "a.json", "a", "a.step", "-"})
    EXPECT_FALSE(io::may_hold_faces(path, "1 2 3")) << path;
  EXPECT_FALSE(io::may_hold_faces("a.obj", "# .PCD v0.7\n")) << "PCD by its first bytes";
  EXPECT_THROW((void)may_hold_faces("/no/such/file.ply"), Error);
}

}  // namespace
}  // namespace pointskin
