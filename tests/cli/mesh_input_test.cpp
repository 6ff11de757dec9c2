// Meshes without vertex normals, where oriented points are wanted: vertices take the normals of their faces.
#include <cmath>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

using Args = std::vector<std::string>;

class MeshInput : public testing::Test {
 protected:
  MeshInput() {
    write_file(folder_ / "cloud.ply", ply_bytes(sphere(4000)));
    EXPECT_EQ(pointskin_run({"reconstruct", folder_ / "cloud.ply", "-o", folder_ / "ball.ply", "--depth", "5",
                             "--no-normals", "-q"})
                  .exit_code,
              0);
    const Mesh ball = read_mesh(folder_ / "ball.ply");
    for (const char* name : {"ball.stl", "ball.obj"}) write_mesh(folder_ / name, ball);
    std::string off =
        "OFF\n" + std::to_string(ball.vertices.size()) + " " + std::to_string(ball.triangles.size()) + " 0\n";
    for (const Vec3f& v : ball.vertices)
      off += std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z) + "\n";
    for (const Triangle& t : ball.triangles)
      off += "3 " + std::to_string(t[0]) + " " + std::to_string(t[1]) + " " + std::to_string(t[2]) + "\n";
    write_file(folder_ / "ball.off", off);
  }

  TemporaryFolder folder_;
  std::string output_ = folder_ / "out.ply";
};

TEST_F(MeshInput, GivesAWatertightBallFromEveryFormat) {
  for (const char* name : {"ball.ply", "ball.stl", "ball.obj", "ball.off"}) {
    const Result result = pointskin_run({"reconstruct", folder_ / name, "-o", output_, "--depth", "5", "-q"});
    ASSERT_EQ(result.exit_code, 0) << name << result.err;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
    EXPECT_NE(result.err.find("pointskin: warning: "), std::string::npos) << result.err;
    EXPECT_NE(result.err.find(std::string(name) + ": its vertices have no normals and take those of the faces"),
              std::string::npos)
        << result.err;
    const MeshReport report = measure(read_mesh(output_));
    EXPECT_TRUE(report.watertight()) << name;
    EXPECT_NEAR(report.volume, 4.0 / 3.0 * std::acos(-1.0), 0.15) << name;
  }
}

TEST_F(MeshInput, GivesEditsAndDeformationsTheSame) {
  write_file(folder_ / "hold.json", R"({"handles": [{"region": {"points": [0]}}]})");
  write_file(folder_ / "none.json", R"({"version": 1, "operations": []})");
  EXPECT_EQ(
      pointskin_run({"deform", folder_ / "ball.stl", "--script", folder_ / "hold.json", "-o", output_, "--depth", "4"})
          .exit_code,
      0);
  EXPECT_EQ(
      pointskin_run({"edit", folder_ / "ball.stl", "--script", folder_ / "none.json", "-o", output_, "--depth", "4"})
          .exit_code,
      0);
}

TEST_F(MeshInput, IsMergedWithClouds) {
  const Result result =
      pointskin_run({"reconstruct", folder_ / "cloud.ply", folder_ / "ball.stl", "-o", output_, "--depth", "4"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("points " + std::to_string(4000 + read_mesh(folder_ / "ball.stl").vertices.size()) + ","),
            std::string::npos)
      << result.err;
}

TEST_F(MeshInput, KeepsNormalsThatThereAre) {
  const Result result =
      pointskin_run({"reconstruct", folder_ / "cloud.ply", "-o", folder_ / "rich.ply", "--depth", "5"});
  ASSERT_EQ(result.exit_code, 0);
  EXPECT_EQ(pointskin_run({"reconstruct", folder_ / "rich.ply", "-o", output_, "--depth", "4", "-q"}).err, "");
}

TEST_F(MeshInput, LeavesCloudsWithoutNormalsAnError) {
  write_file(folder_ / "bare.ply", ply_bytes(sphere(100), false));
  EXPECT_EQ(pointskin_run({"reconstruct", folder_ / "bare.ply", "-o", output_}).exit_code, 4);
  write_file(folder_ / "bare.obj", "v 0 0 0\nv 1 0 0\nv 0 1 0\n");
  EXPECT_EQ(pointskin_run({"reconstruct", folder_ / "bare.obj", "-o", output_}).exit_code, 4);
}

TEST_F(MeshInput, DropsVerticesWithoutFaces) {
  const Mesh ball = read_mesh(folder_ / "ball.obj");
  std::string obj = "v 0.1 0.1 0.1\n";
  for (const Vec3f& v : ball.vertices)
    obj += "v " + std::to_string(v.x) + " " + std::to_string(v.y) + " " + std::to_string(v.z) + "\n";
  for (const Triangle& t : ball.triangles)
    obj += "f " + std::to_string(t[0] + 2) + " " + std::to_string(t[1] + 2) + " " + std::to_string(t[2] + 2) + "\n";
  write_file(folder_ / "loose.obj", obj);
  const Result result = pointskin_run({"reconstruct", folder_ / "loose.obj", "-o", output_, "--depth", "4", "-q"});
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_NE(result.err.find("1 points were dropped: their normal has zero length"), std::string::npos) << result.err;
}

}  // namespace
}  // namespace pointskin::test
