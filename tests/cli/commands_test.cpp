// info, check, compare, convert, render.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

using Json = nlohmann::json;

class Commands : public testing::Test {
 protected:
  Json json_of(std::vector<std::string> args, int exit_code = 0) {
    args.emplace_back("--json");
    const Result result = pointskin_run(args);
    EXPECT_EQ(result.exit_code, exit_code) << result.err;
    EXPECT_EQ(result.err, "");
    return Json::parse(result.out);
  }

  std::string save(const char* name, const std::string& bytes) {
    write_file(folder_ / name, bytes);
    return folder_ / name;
  }

  TemporaryFolder folder_;
};

TEST_F(Commands, InfoDescribesACloud) {
  std::vector<Sample> samples = sphere(5000, {10, 20, 30});
  samples[3].position.x = NAN;
  const Json info = json_of({"info", save("cloud.ply", ply_bytes(samples))});
  EXPECT_EQ(info["kind"], "cloud");
  EXPECT_EQ(info["points"], 4999);
  EXPECT_EQ(info["dropped"], 1);
  EXPECT_EQ(info["normals"], true);
  EXPECT_EQ(info["attributes"], Json::array());
  EXPECT_NEAR(info["bounds"]["lower"][1].get<double>(), 19, 0.01);
  EXPECT_NEAR(info["bounds"]["upper"][2].get<double>(), 31, 0.01);
  // 5000 points share 4 pi: each has a patch 0.05 wide, and spiral neighbours are about as far apart.
  EXPECT_NEAR(info["spacing"].get<double>(), std::sqrt(4 * std::acos(-1.0) / 5000), 0.015);
}

TEST_F(Commands, InfoNamesAttributesWithTheirTypes) {
  const std::string path =
      save("c.ply",
           "ply\nformat ascii 1.0\nelement vertex 2\nproperty float x\nproperty float y\nproperty float "
           "z\nproperty uchar red\nproperty float quality\nend_header\n0 0 0 255 0.5\n3 4 0 0 0.5\n");
  const Json info = json_of({"info", path});
  EXPECT_EQ(info["normals"], false);
  EXPECT_EQ(info["attributes"],
            (Json{{{"name", "red"}, {"type", "uint8"}}, {{"name", "quality"}, {"type", "float32"}}}));
  EXPECT_DOUBLE_EQ(info["spacing"].get<double>(), 5);
}

TEST_F(Commands, InfoDoesNotLetNamesSteerTheTerminal) {
  write_file(folder_ / "steering.ply",
             "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
             "property float \x1b[31mevil\x07\nend_header\n0 0 0 1\n");
  const Result result = pointskin_run({"info", folder_ / "steering.ply"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.out.find("?[31mevil?"), std::string::npos) << result.out;
  EXPECT_EQ(result.out.find_first_of("\x1b\x07"), std::string::npos);
}

TEST_F(Commands, InfoDescribesAMesh) {
  const Json info = json_of({"info", save("cube.ply", cube_mesh_ply(2))});
  EXPECT_EQ(info["kind"], "mesh");
  EXPECT_EQ(info["vertices"], 26);
  EXPECT_EQ(info["triangles"], 48);
  EXPECT_DOUBLE_EQ(info["spacing"].get<double>(), 1);
}

TEST_F(Commands, InfoReadsStdinAndSpeaksToPeople) {
  Start start;
  start.args = {"info", "-"};
  start.input = cube_mesh_ply(1);
  const Result mesh = run_program(start);
  EXPECT_EQ(mesh.exit_code, 0) << mesh.err;
  EXPECT_NE(mesh.out.find("triangles   12\n"), std::string::npos) << mesh.out;
  start.input = ply_bytes(sphere(10));
  const Result cloud = run_program(start);
  EXPECT_NE(cloud.out.find("points      10\n"), std::string::npos) << cloud.out << cloud.err;
  EXPECT_NE(cloud.out.find("normals     yes\n"), std::string::npos) << cloud.out;
}

TEST_F(Commands, CheckPassesACubeAndMeasuresIt) {
  const Json check = json_of({"check", save("cube.ply", cube_mesh_ply(3))});
  for (const char* key : {"watertight", "closed", "manifold", "oriented"}) EXPECT_EQ(check[key], true) << key;
  EXPECT_EQ(check["euler"], 2);
  EXPECT_EQ(check["components"], 1);
  EXPECT_NEAR(check["volume"].get<double>(), 27, 1e-12);
  EXPECT_NEAR(check["area"].get<double>(), 54, 1e-12);
}

TEST_F(Commands, CheckFailsAnOpenCubeWithExitFive) {
  std::string mesh = cube_mesh_ply(1);
  mesh.replace(mesh.find("face 12"), 7, "face 11");
  mesh.erase(mesh.rfind("3 "));
  const std::string path = save("open.ply", mesh);
  const Json check = json_of({"check", path}, 5);
  EXPECT_EQ(check["watertight"], false);
  EXPECT_EQ(check["closed"], false);
  EXPECT_EQ(check["boundary_edges"], 3);
  const Result people = pointskin_run({"check", path});
  EXPECT_EQ(people.exit_code, 5);
  EXPECT_NE(people.out.find("closed      no"), std::string::npos) << people.out;
}

TEST_F(Commands, CompareOfACubeWithItselfIsZero) {
  const std::string cube = save("cube.ply", cube_mesh_ply(2));
  const Json same = json_of({"compare", cube, cube, "--samples", "5000"});
  EXPECT_NEAR(same["two_sided"]["max"].get<double>(), 0, 1e-6);
  EXPECT_NEAR(same["reference_diagonal"].get<double>(), 2 * std::sqrt(3.0), 1e-6);
  EXPECT_GT(same["normal_consistency"].get<double>(), 0.99);
  EXPECT_EQ(same["f_score"], 1.0);
}

TEST_F(Commands, CompareReportsBothWaysAbsoluteAndInPercent) {
  const std::string small = save("small.ply", cube_mesh_ply(1)), large = save("large.ply", cube_mesh_ply(2));
  const Json far = json_of({"compare", small, large, "--samples", "5000", "--tau", "0.001"});
  for (const char* way : {"to_reference", "from_reference", "two_sided"}) {
    for (const std::string key : {"mean", "rms", "p95", "max"}) {
      const double percent = 100 * far[way][key].get<double>() / far["reference_diagonal"].get<double>();
      EXPECT_NEAR(far[way][key + "_percent"].get<double>(), percent, 1e-9) << way << key;
    }
  }
  EXPECT_GT(far["from_reference"]["max"].get<double>(), far["to_reference"]["max"].get<double>());
  EXPECT_LT(far["f_score"].get<double>(), 1);
  const Result people = pointskin_run({"compare", small, large, "--samples", "1000"});
  for (const char* part : {"mean", "rms", "p95", "max", "%", "normal consistency", "F-score"}) {
    EXPECT_NE(people.out.find(part), std::string::npos) << people.out;
  }
}

TEST_F(Commands, ConvertKeepsTheMeshInEveryFormat) {
  const std::string cube = save("cube.ply", cube_mesh_ply(2));
  for (const char* name : {"a.obj", "a.stl", "a.ply"}) {
    const Result result = pointskin_run({"convert", cube, folder_ / name});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_NEAR(json_of({"check", folder_ / name})["volume"].get<double>(), 8, 1e-12) << name;
    ASSERT_EQ(pointskin_run({"convert", folder_ / name, folder_ / "back.ply"}).exit_code, 0) << name;
    EXPECT_EQ(read_mesh(folder_ / "back.ply").triangles.size(), 48U) << name;
  }
}

TEST_F(Commands, ConvertWritesCloudsAsPlyOnly) {
  const std::string cloud = save("cloud.xyz", "0 0 0 0 0 1\n1 2 3 0 0 1\n");
  EXPECT_EQ(pointskin_run({"convert", cloud, folder_ / "cloud.ply"}).exit_code, 0);
  EXPECT_EQ(read_cloud(folder_ / "cloud.ply").size(), 2);
  EXPECT_EQ(pointskin_run({"convert", cloud, folder_ / "cloud.obj"}).exit_code, 2);
  Start start;
  start.args = {"convert", "-", "-"};
  start.input = ply_bytes(sphere(10));
  const Result piped = run_program(start);
  EXPECT_EQ(piped.exit_code, 0) << piped.err;
  EXPECT_TRUE(piped.out.starts_with("ply\n"));
}

TEST_F(Commands, RenderDrawsAPicture) {
  const std::string cube = save("cube.ply", cube_mesh_ply(2)), picture = folder_ / "cube.png";
  const Result result = pointskin_run({"render", cube, "-o", picture, "--size", "64x48"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  const std::string png = read_file(picture);
  ASSERT_GT(png.size(), 33U);
  EXPECT_EQ(png.substr(1, 3), "PNG");
  EXPECT_EQ(png[19], 64);  // IHDR: width and height, big endian, from byte 16.
  EXPECT_EQ(png[23], 48);
}

TEST_F(Commands, FilesMayBeNamedLikeCommandsAndOptions) {
  const std::string cube = cube_mesh_ply(1);
  for (const char* name : {"info", "-dash.ply"}) {
    save(name, cube);
    Start start;
    start.args = {"info", "--", name};
    start.folder = folder_.path();
    const Result result = run_program(start);
    EXPECT_EQ(result.exit_code, 0) << name << result.err;
  }
}

}  // namespace
}  // namespace pointskin::test
