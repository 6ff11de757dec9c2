// Legacy VTK and JSON: particles as simulations write them.
#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>
#include <map>

#include "support/io_files.hpp"

namespace pointskin {
namespace {

using test::cloud_of;
using test::raw;
using test::story_of;

std::map<std::string, AttributeValues> attributes_of(const Cloud& cloud) {
  std::map<std::string, AttributeValues> all;
  for (const Attribute& a : cloud.attributes) all[a.name] = a.values;
  return all;
}

const std::string kAscii =
    "# vtk DataFile Version 3.0\nparticles\nASCII\nDATASET POLYDATA\nPOINTS 3 float\n0 0 0 1 2 3\n-1 -2.5 1e2\n"
    "VERTICES 3 6\n1 0 1 1 1 2\nPOINT_DATA 3\nSCALARS density float 1\nLOOKUP_TABLE default\n1000 1001.5 nan\n"
    "VECTORS velocity double\n1 0 0 0 1 0 0 0 1\nNORMALS normals float\n0 0 1 0 0 1 0 1 0\n"
    "FIELD more 2\nid 1 3 int\n7 8 9\nuv 2 3 float\n.1 .2 .3 .4 .5 .6\n";

std::string binary_file() {
  std::string bytes = "# vtk DataFile Version 4.1\nparticles\nBINARY\nFIELD FieldData 1\nTIME 1 1 double\n" +
                      raw<double>(0.25, true) + "\nDATASET UNSTRUCTURED_GRID\nPOINTS 2 double\n";
  for (const double v : {1.0, 2.0, 3.0, 4.0, 5.0, 6.5}) bytes += raw<double>(v, true);
  bytes += "\nCELLS 2 4\n";
  for (const int v : {1, 0, 1, 1}) bytes += raw<std::int32_t>(v, true);
  bytes += "\nCELL_TYPES 2\n" + raw<std::int32_t>(1, true) + raw<std::int32_t>(1, true);
  bytes +=
      "\nCELL_DATA 2\nSCALARS of_cells float 1\nLOOKUP_TABLE default\n" + raw<float>(1, true) + raw<float>(2, true);
  bytes += "\nPOINT_DATA 2\nSCALARS id unsigned_int 1\nLOOKUP_TABLE id_table\n" + raw<std::uint32_t>(10, true) +
           raw<std::uint32_t>(4'000'000'000U, true);
  bytes += "\nSCALARS red unsigned_char\n";
  bytes += "\x0c\xff";
  bytes += "\nFIELD FieldData 2\nvelocity 3 2 float\n";
  for (const float v : {1.0F, 0.0F, -1.0F, 0.5F, 0.25F, 8.0F}) bytes += raw<float>(v, true);
  bytes += "\nstep%201 1 2 vtktypeint64\n" + raw<std::int64_t>(-5, true) + raw<std::int64_t>(6, true) + "\n";
  return bytes;
}

TEST(VtkReader, ReadsPointsAndTheirDataFromText) {
  const Cloud cloud = cloud_of("a.vtk", kAscii);
  EXPECT_EQ(cloud.positions, (std::vector<Vec3f>{{0, 0, 0}, {1, 2, 3}, {-1, -2.5F, 100}}));
  EXPECT_EQ(cloud.normals, (std::vector<Vec3f>{{0, 0, 1}, {0, 0, 1}, {0, 1, 0}}));
  const auto all = attributes_of(cloud);
  EXPECT_EQ(all.size(), 7U);
  EXPECT_EQ(all.at("density").at(1), 1001.5);
  EXPECT_TRUE(all.at("density").is_missing(2));
  EXPECT_EQ(all.at("velocity_y"), (std::vector<double>{0, 1, 0}));
  EXPECT_EQ(all.at("id"), (std::vector<std::int32_t>{7, 8, 9}));
  EXPECT_EQ(all.at("uv_1"), (std::vector<float>{0.2F, 0.4F, 0.6F}));
}

TEST(VtkReader, ReadsPointsAndTheirDataFromBigEndianBytes) {
  const Cloud cloud = cloud_of("a.vtk", binary_file());
  EXPECT_EQ(cloud.positions, (std::vector<Vec3f>{{1, 2, 3}, {4, 5, 6.5F}}));
  const auto all = attributes_of(cloud);
  EXPECT_EQ(all.size(), 6U);
  EXPECT_EQ(all.count("of_cells"), 0U);
  EXPECT_EQ(all.at("id"), (std::vector<std::uint32_t>{10, 4'000'000'000U}));
  EXPECT_EQ(all.at("velocity_z"), (std::vector<float>{-1, 8}));
  EXPECT_EQ(all.at("step_201"), (std::vector<std::int64_t>{-5, 6}));
  EXPECT_EQ(all.at("red"), (std::vector<std::uint8_t>{12, 255}));
}

TEST(VtkReader, PassesOverTheCellsOfVersionFive) {
  const Cloud cloud = cloud_of(
      "a.vtk",
      "# vtk DataFile Version 5.1\nt\nASCII\nDATASET POLYDATA\nPOINTS 2 float\n1 1 1 2 2 2\nMETADATA\nINFORMATION 1\n"
      "NAME a LOCATION b\n\nVERTICES 3 2\nOFFSETS vtktypeint64\n0 1 2\nCONNECTIVITY vtktypeint64\n0 1\n"
      "POINT_DATA 2\nFIELD FieldData 1\nm 1 2 float\n3 4\nMETADATA\nINFORMATION 0\n\n");
  EXPECT_EQ(cloud.size(), 2);
  EXPECT_EQ(attributes_of(cloud).at("m"), (std::vector<float>{3, 4}));
}

const std::string kPolygons =
    "# vtk DataFile Version 3.0\nmesh\nASCII\nDATASET POLYDATA\nPOINTS 5 float\n0 0 0 1 0 0 1 1 0 0 1 0 2 2 0\n"
    "VERTICES 1 2\n1 4\nPOLYGONS 2 9\n4 0 1 2 3\n3 2 1 4\nTRIANGLE_STRIPS 1 5\n4 0 1 3 2\n"
    "POINT_DATA 5\nSCALARS id int 1\nLOOKUP_TABLE default\n1 2 3 4 5\n";

/// Cells as version 5 has them.
const std::string kCells =
    "# vtk DataFile Version 5.1\nmesh\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 4 float\n0 0 0 1 0 0 0 1 0 1 1 0\n"
    "CELLS 4 9\nOFFSETS vtktypeint64\n0 4 5 9\nCONNECTIVITY vtktypeint64\n0 1 2 3 2 0 1 3 2\nCELL_TYPES 3\n8\n1\n9\n";

TEST(VtkReader, ReadsPolygonsStripsAndCells) {
  const Mesh mesh = test::mesh_of("a.vtk", kPolygons);
  EXPECT_EQ(mesh.vertices.size(), 5U);
  EXPECT_EQ(mesh.triangles, (std::vector<Triangle>{{0, 1, 2}, {0, 2, 3}, {2, 1, 4}, {0, 1, 3}, {3, 1, 2}}));
  ASSERT_EQ(mesh.attributes.size(), 1U);
  EXPECT_EQ(mesh.attributes[0].values, (std::vector<std::int32_t>{1, 2, 3, 4, 5}));
  EXPECT_EQ(test::mesh_of("a.vtk", kCells).triangles,
            (std::vector<Triangle>{{0, 1, 3}, {0, 3, 2}, {0, 1, 3}, {0, 3, 2}}));
  EXPECT_TRUE(test::mesh_of("a.vtk", kAscii).triangles.empty()) << "particles";
}

TEST(VtkReader, RefusesCellsThatDoNotFit) {
  const auto refused = [](std::string text, const std::string& part, const std::string& instead) {
    text.replace(text.find(part), part.size(), instead);
    return !story_of(ErrorCode::invalid_input, [&] { test::mesh_of("a.vtk", text); }).empty();
  };
  EXPECT_TRUE(refused(kPolygons, "3 2 1 4", "3 2 1 5")) << "a point that there is not";
  EXPECT_TRUE(refused(kPolygons, "3 2 1 4", "3 2 1 -1"));
  EXPECT_TRUE(refused(kPolygons, "3 2 1 4", "4 2 1 4")) << "a corner beyond the end";
  EXPECT_TRUE(refused(kPolygons, "POLYGONS 2 9", "POLYGONS 3 9")) << "a polygon less than promised";
  EXPECT_TRUE(refused(kPolygons, "POLYGONS 2 9", "POLYGONS 2 99999999999"));
  EXPECT_TRUE(refused(kCells, "0 4 5 9", "0 4 5 10"));
  EXPECT_TRUE(refused(kCells, "0 4 5 9", "0 5 4 9"));
  EXPECT_TRUE(refused(kCells, "0 4 5 9", "1 4 5 9"));
  EXPECT_TRUE(refused(kCells, "CONNECTIVITY vtktypeint64\n0 1 2 3 2 0 1 3 2\n", "")) << "cells without points";
  EXPECT_TRUE(refused(kCells, "CELL_TYPES 3\n8\n1\n9\n", "")) << "cells without types";
  EXPECT_TRUE(refused(kCells, "CONNECTIVITY vtktypeint64", "CONNECTIVITY float")) << "ids that are no whole numbers";
}

TEST(VtkReader, IsRecognisedByItsContent) {
  EXPECT_EQ(cloud_of("particles", kAscii).size(), 3);
  EXPECT_EQ(cloud_of("a.xyz", kAscii).size(), 3);
}

TEST(VtkReader, RefusesWhatIsNotThere) {
  const auto story = [](const std::string& text) {
    return story_of(ErrorCode::invalid_input, [&] { cloud_of("a.vtk", text); });
  };
  const std::string head = "# vtk DataFile Version 3.0\nt\nASCII\nDATASET POLYDATA\n";
  EXPECT_NE(story("no vtk").find("legacy VTK"), std::string::npos);
  EXPECT_NE(story("# vtk DataFile Version 3.0\nt\nXML\n").find("XML"), std::string::npos);
  EXPECT_NE(story(head).find("no POINTS"), std::string::npos);
  EXPECT_NE(story(head + "POINTS 2 float\n1 2 3 4 5").find("ends before"), std::string::npos);
  EXPECT_NE(story(head + "POINTS 1 float\n1 2 x\n").find("'x' is not a number"), std::string::npos);
  EXPECT_NE(story(head + "POINTS -1 float\n").find("'-1'"), std::string::npos);
  EXPECT_NE(story(head + "POINTS 1 quad\n1 2 3\n").find("'quad'"), std::string::npos);
  EXPECT_NE(story(head + "POINTS 1 float\n1 2 3\nPOINT_DATA 2\n").find("data of 2 points for 1"), std::string::npos);
  EXPECT_NE(story(head + "POINTS 1 float\n1 2 3\nWHAT 1\n").find("'WHAT'"), std::string::npos);
  EXPECT_NE(story("# vtk DataFile Version 3.0\nt\nASCII\nDATASET STRUCTURED_POINTS\n").find("STRUCTURED_POINTS"),
            std::string::npos);
  // Counts that lie must not take memory.
  for (const char* count : {"9223372036854775807", "4611686018427387904", "1000000000000", "99999999999999999999"})
    for (const char* encoding : {"ASCII", "BINARY"}) {
      const std::string lying = std::string("# vtk DataFile Version 3.0\nt\n") + encoding +
                                "\nDATASET POLYDATA\nPOINTS " + count + " float\n1 2 3\n";
      EXPECT_NE(story(lying), "") << lying;
    }
  EXPECT_NE(story(head + "POINTS 1 float\n1 2 3\nPOINT_DATA 1\nFIELD f 1\na 9223372036854775807 "
                         "9223372036854775807 float\n1\n"),
            "");
}

TEST(VtkReader, SurvivesDamage) {
  test::damage(kAscii, [](const std::string& bytes) { cloud_of("a.vtk", bytes); });
  test::damage(binary_file(), [](const std::string& bytes) { cloud_of("a.vtk", bytes); });
  for (const std::string& text : {kPolygons, kCells, binary_file()})
    test::damage(text, [](const std::string& bytes) { test::mesh_of("a.vtk", bytes); });
}

TEST(JsonReader, ReadsAListOfPoints) {
  const Cloud cloud = cloud_of("a.json", " [\n[1, 2,3] ,[-1e-1,0.5, 7]\n]\n");
  EXPECT_EQ(cloud.positions, (std::vector<Vec3f>{{1, 2, 3}, {-0.1F, 0.5F, 7}}));
  EXPECT_EQ(cloud_of("particles", "[[1,2,3]]").size(), 1);
  EXPECT_EQ(cloud_of("a.json", "[]").size(), 0);
}

TEST(JsonReader, RefusesEverythingElse) {
  for (const char* text : {"", "[", "[[1,2]]", "[[1,2,3,4]]", "[[1,2,3],]", "[[1,2,3]] 1", "{}", "[1,2,3]",
                           "[[1,2,\"a\"]]", "[[1 2 3]]", "[[1,2,3]"})
    EXPECT_NE(story_of(ErrorCode::invalid_input, [&] { cloud_of("a.json", text); }), "") << text;
  test::damage("[[1,2,3],[4.5,-5e3,6]]\n", [](const std::string& bytes) { cloud_of("a.json", bytes); });
}

TEST(VtkReader, AgreesWithThePlyOfTheSameFrame) {
  const std::filesystem::path folder = std::filesystem::path(POINTSKIN_SOURCE_DIR) / ".." / "shared" / "data";
  const auto vtk = folder / "dam_break_frame_23_24389_particles.vtk";
  const auto ply = folder / "fluid_dam_break_24389.ply";
  if (!std::filesystem::exists(vtk) || !std::filesystem::exists(ply)) GTEST_SKIP() << "there are no real frames";
  const Cloud cloud = read_cloud(vtk.string());
  EXPECT_EQ(cloud.positions, read_cloud(ply.string()).positions);
  EXPECT_EQ(cloud.attributes.size(), 4U);
}

}  // namespace
}  // namespace pointskin
