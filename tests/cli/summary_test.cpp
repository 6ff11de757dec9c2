// The last line on stderr: which file was written, what the mesh is, and where memory was.
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include <pointskin/device.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

using Args = std::vector<std::string>;

class Summary : public testing::Test {
 protected:
  Summary() {
    std::vector<Sample> two = sphere(1500, {-2, 0, 0});
    const std::vector<Sample> other = sphere(1500, {2, 0, 0});
    two.insert(two.end(), other.begin(), other.end());
    save("one.ply", ply_bytes(sphere(1500)));
    save("two.ply", ply_bytes(two));
    std::vector<Sample> half = sphere(6000);
    std::erase_if(half, [](const Sample& s) { return s.position.z > 0; });
    save("half.ply", ply_bytes(half));
    save("bare.ply", ply_bytes(sphere(300), false));
    save("f_1.ply", ply_bytes(sphere(200), false));
    save("f_2.ply", ply_bytes(sphere(300), false));
    save("cube.ply", cube_mesh_ply(2));
    save("bend.json", R"({"handles": [{"region": {"points": [0]}, "rigid": {"degrees": 9}}]})");
    save("ops.json", R"({"version": 1, "operations": [
      {"op": "guide", "camera": {}, "stroke": [[400, 450], [800, 450]], "interval": 0.1}]})");
  }

  void save(const std::string& name, const std::string& bytes) { write_file(folder_ / name, bytes); }

  /// The last line of what a run says.
  std::string line_of(const Args& args) {
    Start start;
    start.args = args;
    start.folder = folder_.path();
    const Result result = run_program(start);
    EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(args) << result.err;
    const std::string said = result.err.empty() ? "" : result.err.substr(0, result.err.size() - 1);
    return said.substr(said.rfind('\n') + 1);
  }

  void expect_parts(const Args& args, const std::vector<std::string>& parts) {
    const std::string line = line_of(args);
    for (const std::string& part : parts)
      EXPECT_NE(line.find(part), std::string::npos) << "'" << part << "' is not in: " << line;
    EXPECT_EQ(line.find("device"), std::string::npos) << line;
    Args quiet = args;
    quiet.emplace_back("-q");
    EXPECT_EQ(line_of(quiet), "");
  }

  TemporaryFolder folder_;
};

TEST_F(Summary, OfReconstruct) {
  const Args cpu = {"--depth", "5", "--device", "cpu"};
  const auto with = [&cpu](Args args) {
    args.insert(args.end(), cpu.begin(), cpu.end());
    return args;
  };
  expect_parts(with({"reconstruct", "one.ply", "-o", "a.ply"}),
               {"a.ply: points 1500", ", closed, 1 component;", "memory "});
  expect_parts(with({"reconstruct", "two.ply", "-o", "./a.obj"}), {"./a.obj: points 3000", ", closed, 2 components;"});
  expect_parts(with({"reconstruct", "half.ply", "-o", "a.ply", "--trim", "0.2"}), {", open, 1 component;"});
  expect_parts(with({"reconstruct", "one.ply", "-o", "a.ply", "--report", "r.json"}), {", watertight, 1 component;"});
  expect_parts(with({"reconstruct", "one.ply", "-o", "-"}), {"stdout: points 1500"});
  expect_parts(with({"reconstruct", "one.ply", "--repeat", "1"}), {"points 1500", ", closed, 1 component;"});
}

TEST_F(Summary, OfProblems) {
  expect_parts({"problems", "two.ply", "-o", "a.ply", "--depth", "5", "--device", "cpu"},
               {"a.ply: points 3000", ", closed, 2 components;"});
}

TEST_F(Summary, OfEdit) {
  expect_parts({"edit", "one.ply", "--script", "ops.json", "-o", "a.ply", "--depth", "4", "--device", "cpu"},
               {"a.ply: operations 1, triangles ", ", closed, 1 component;", "ms: total "});
}

TEST_F(Summary, OfDeform) {
  expect_parts({"deform", "two.ply", "--script", "bend.json", "-o", "a.ply", "--depth", "5", "--device", "cpu"},
               {"a.ply: points 3000", ", closed, 2 components;", "; 1 frame:"});
  expect_parts({"deform", "one.ply", "--script", "bend.json", "-o", "m_{}.ply", "--frames", "2", "--depth", "4",
                "--device", "cpu"},
               {"m_{}.ply: points 1500", "; 2 frames:"});
  expect_parts({"deform", "one.ply", "--script", "bend.json", "--cloud", "c.ply", "--depth", "4", "--device", "cpu"},
               {"c.ply: points 1500"});
}

TEST_F(Summary, OfBoolean) {
  expect_parts({"boolean", "one.ply", "two.ply", "--op", "union", "-o", "a.ply", "--depth", "5", "--device", "cpu"},
               {"a.ply: A: ", ", closed, ", " component", "memory "});
}

TEST_F(Summary, OfFluid) {
  expect_parts({"fluid", "f_1.ply", "-o", "a.ply", "-r", "0.15", "--device", "cpu"},
               {"a.ply: particles 200", ", closed, 2 components;"});
  expect_parts(
      {"fluid", "f_{}.ply", "-o", "m_{}.ply", "-r", "0.15", "--device", "cpu", "--at-once", "2", "--threads", "2"},
      {"m_{}.ply: frames 2; the last one: particles 300", ", closed, 2 components;"});
  expect_parts(
      {"fluid", "--simulate", "drop", "--particles", "300", "--frames", "2", "-o", "m_{}.ply", "--device", "cpu"},
      {"m_{}.ply: drop: 300 particles, 2 frames;", ", closed, ", " component"});
}

TEST_F(Summary, OfOrient) {
  expect_parts({"orient", "bare.ply", "-o", "a.ply", "--device", "cpu"}, {"a.ply: points 300; ms: total "});
}

TEST_F(Summary, OfConvertAndRender) {
  expect_parts({"convert", "cube.ply", "a.obj"}, {"a.obj: 26 vertices, 48 triangles, closed, 1 component"});
  std::string mesh = cube_mesh_ply(1);
  mesh.replace(mesh.find("face 12"), 7, "face 11");
  mesh.erase(mesh.rfind("3 "));
  save("open.ply", mesh);
  expect_parts({"convert", "open.ply", "a.obj"}, {"a.obj: 8 vertices, 11 triangles, open, 1 component"});
  expect_parts({"convert", "one.ply", "a.ply"}, {"a.ply: 1500 points"});
  expect_parts({"render", "cube.ply", "-o", "a.png", "--size", "9x9"}, {"a.png: 9 x 9 pixels"});
}

TEST_F(Summary, OfBench) {
  const Args bench = {"bench",     "one.ply", "--depths", "3",      "--repeat", "1",
                      "--devices", "cpu",     "--report", "b.json", "--plot",   "b.svg"};
  EXPECT_EQ(line_of(bench), "b.svg: written");
}

TEST_F(Summary, TellsDeviceMemoryOnAGpuAlone) {
  EXPECT_NE(
      line_of({"reconstruct", "one.ply", "-o", "a.ply", "--depth", "4", "--device", "cpu"}).find(" of it buffers"),
      std::string::npos);
  if (Device::automatic().kind != DeviceKind::cuda) GTEST_SKIP() << "no GPU";
  EXPECT_NE(line_of({"reconstruct", "one.ply", "-o", "a.ply", "--depth", "4", "--device", "cuda"}).find(" device, "),
            std::string::npos);
}

}  // namespace
}  // namespace pointskin::test
