// Options and parts of scripts that come to nothing are said, a warning each. The claim is tested, too: without the
// option the output has the same bytes.
#include <algorithm>
#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

using Args = std::vector<std::string>;

constexpr char kBend[] = R"({"handles": [
  {"region": {"half_space": {"point": [0, 0, -0.5], "normal": [0, 0, -1]}}},
  {"region": {"ball": {"centre": [0, 0, 1], "radius": 0.3}}, "rigid": {"axis": [0, 1, 0], "degrees": 30}}]})";
constexpr char kGuide[] = R"({"version": 1, "operations": [
  {"op": "guide", "camera": {"azimuth": 0}, "stroke": [[400, 450], [800, 450]], "interval": 0.1}]})";

/// ASCII PLY of a sphere, normals of two lengths, with a colour and a scalar.
std::string rich_cloud() {
  std::string rows;
  const std::vector<Sample> samples = sphere(700);
  for (std::size_t i = 0; i < samples.size(); ++i) {
    const auto& [p, n] = samples[i];
    const float length = i % 2 == 0 ? 1.0F : 2.0F;
    for (const float x : {p.x, p.y, p.z, length * n.x, length * n.y, length * n.z}) rows += std::to_string(x) + " ";
    rows += std::to_string(i % 256) + " 9 9 0.5\n";
  }
  return "ply\nformat ascii 1.0\nelement vertex 700\nproperty float x\nproperty float y\nproperty float z\nproperty "
         "float "
         "nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\n"
         "property float quality\nend_header\n" +
         rows;
}

Args joined(Args args, const Args& more) {
  args.insert(args.end(), more.begin(), more.end());
  return args;
}

class UnusedOptions : public testing::Test {
 protected:
  UnusedOptions() {
    save("scan.ply", ply_bytes(sphere(600)));
    save("other.ply", ply_bytes(sphere(600, {0.5F, 0, 0})));
    save("bare.ply", ply_bytes(sphere(600), false));
    save("rich.ply", rich_cloud());
    save("cube.ply", cube_mesh_ply(2));
    save("bend.json", kBend);
    save("guide.json", kGuide);
    save("f_1.ply", ply_bytes(sphere(200), false));
    save("f_2.ply", ply_bytes(sphere(200), false));
  }

  void save(const std::string& name, const std::string& bytes) { write_file(folder_ / name, bytes); }

  [[nodiscard]] Result run(const Args& args) const {
    Start start;
    start.args = args;
    start.folder = folder_.path();
    return run_program(start);
  }

  /// The bytes of all files that a run makes, which are removed then.
  std::string made_by(const Args& args, Result& result) {
    const std::vector<std::string> before = folder_.names();
    result = run(args);
    EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(args) << result.err;
    std::string bytes;
    for (const std::string& name : folder_.names()) {
      if (std::find(before.begin(), before.end(), name) != before.end()) continue;
      if (!name.ends_with(".json")) bytes += name + read_file(folder_ / name);
      std::filesystem::remove(folder_ / name);
    }
    return bytes;
  }

  /// Expects that `base` says nothing, and with `more` the same is made and `warning` is said, once.
  void expect_unused(const Args& base, const Args& more, const std::string& warning) {
    Result without, with;
    const std::string expected = made_by(base, without);
    EXPECT_EQ(without.err.find("warning"), std::string::npos) << testing::PrintToString(base) << without.err;
    const std::string made = made_by(joined(base, more), with);
    EXPECT_TRUE(made == expected) << testing::PrintToString(more) << " has an effect";
    const std::string line = "pointskin: warning: " + warning + "\n";
    EXPECT_EQ(with.err, line) << testing::PrintToString(base) << testing::PrintToString(more);
  }

  TemporaryFolder folder_;
};

TEST_F(UnusedOptions, OfTheSurface) {
  const Args base = {"reconstruct", "scan.ply", "-o", "out.ply", "--depth", "3", "-q"};
  expect_unused(base, {"--island-ratio", "0.2"}, "--island-ratio has no effect without --trim");
  expect_unused(joined(base, {"--screening", "0"}), {"--fixed-screening"},
                "--fixed-screening has no effect with --screening 0");
  expect_unused(joined(base, {"--boundary", "dirichlet"}), {"--open"},
                "--open has no effect with --boundary dirichlet");
  EXPECT_EQ(run(joined(base, {"--confidence"})).err,
            "pointskin: warning: --confidence means nothing here: all normals have the same length\n");
}

TEST_F(UnusedOptions, OfNormalsThatAreNotEstimated) {
  const Args base = {"reconstruct", "scan.ply", "-o", "out.ply", "--depth", "3", "-q"};
  for (const Args& more : {Args{"--sensor", "0,0,9"}, Args{"--keep-within", "9"}, Args{"--max-rounds", "3"},
                           Args{"--random-start"}, Args{"--seed", "7"}, Args{"--time-limit", "9"}})
    expect_unused(base, more, more[0] + " has no effect without --estimate-normals");
}

TEST_F(UnusedOptions, OfNormalsByAnotherMethod) {
  const Args propagate = {"orient", "bare.ply", "-o", "out.ply", "-q"};
  for (const Args& more : {Args{"--keep-within", "9"}, Args{"--random-start"}, Args{"--seed", "7"}})
    expect_unused(propagate, more, more[0] + " has no effect on normals by propagate");
  expect_unused(joined(propagate, {"--method", "propagate"}), {"--sensor", "0,0,9"},
                "--sensor has no effect on normals by propagate");
  expect_unused(joined(propagate, {"--method", "iterate"}), {"--seed", "7"},
                "--seed has no effect without --random-start");
  expect_unused({"reconstruct", "scan.ply", "-o", "out.ply", "--depth", "3", "-q", "--estimate-normals=repair"},
                {"--sensor", "0,0,9"}, "--sensor has no effect on normals by repair");
}

TEST_F(UnusedOptions, ThatTheFormatCannotHold) {
  const Args obj = {"reconstruct", "rich.ply", "-o", "out.obj", "--depth", "3", "-q"};
  const Args stl = {"reconstruct", "rich.ply", "-o", "out.stl", "--depth", "3", "-q"};
  for (const char* option : {"--density", "--weakness"}) {
    expect_unused(obj, {option}, std::string(option) + " has no effect in OBJ files, which hold colours alone");
    expect_unused(stl, {option}, std::string(option) + " has no effect in STL files, which hold no properties");
  }
  for (const char* option : {"--keep-attributes", "--colors"})
    expect_unused(stl, {option}, std::string(option) + " has no effect in STL files, which hold no properties");
  expect_unused(obj, {"--ascii"}, "--ascii has no effect in OBJ files, which are text always");
  expect_unused(stl, {"--ascii"}, "--ascii has no effect in STL files, which are written as binary ones");
  expect_unused({"convert", "cube.ply", "out.stl", "-q"}, {"--ascii"},
                "--ascii has no effect in STL files, which are written as binary ones");
  expect_unused({"convert", "cube.ply", "out.stl", "-q"}, {"--double"},
                "--double has no effect in files other than PLY");
  expect_unused({"convert", "cube.ply", "out.stl", "-q"}, {"--compress"},
                "--compress has no effect in files other than GLB");
  expect_unused(joined(obj, {"--colors"}), {"--keep-attributes"}, "OBJ files hold colours alone: quality is left out");
}

TEST_F(UnusedOptions, OfPointsWithoutProperties) {
  expect_unused({"reconstruct", "scan.ply", "-o", "out.ply", "--depth", "3", "-q"}, {"--keep-attributes"},
                "--keep-attributes has no effect on points without further properties");
}

TEST_F(UnusedOptions, WhereNoMeshIsWritten) {
  const Args problems = {"problems", "rich.ply", "--depth", "3", "-q"};
  const Args deform = {"deform", "rich.ply", "--script", "bend.json", "--cloud", "c.ply", "--depth", "3", "-q"};
  const Args edit = {"edit", "rich.ply", "--script", "guide.json", "--cloud", "c.ply", "--depth", "3", "-q"};
  for (const char* option : {"--no-normals", "--density"})
    for (const Args& base : {problems, deform, edit})
      expect_unused(base, {option}, std::string(option) + " has no effect where no mesh is written");
  for (const Args& base : {problems, deform})
    expect_unused(base, {"--keep-attributes"}, "--keep-attributes has no effect where no mesh is written");
  expect_unused({"edit", "rich.ply", "--script", "guide.json", "--depth", "3", "-q"}, {"--keep-attributes"},
                "--keep-attributes has no effect where neither mesh nor cloud is written");
  expect_unused(edit, {"--weakness"}, "--weakness has no effect where no mesh is written");
  for (const Args& more : {Args{"--linear-fit"}, Args{"--open"}, Args{"--offset", "0.2"}, Args{"--trim", "0.01"},
                           Args{"--envelope", "cube.ply"}, Args{"--weakness"}})
    expect_unused(deform, more, more[0] + " has no effect where no mesh is written");
}

TEST_F(UnusedOptions, OfASessionThatSolvesNothing) {
  expect_unused(
      {"edit", "scan.ply", "--script", "guide.json", "-o", "out.ply", "--depth", "3", "-q", "--field", "distance"},
      {"--cold"}, "--cold has no effect with --field distance");
}

TEST_F(UnusedOptions, OfFluids) {
  const Args file = {"fluid", "f_1.ply", "-o", "out.ply", "-r", "0.1", "-q"};
  for (const Args& more : {Args{"--frames", "3"}, Args{"--particles", "999"}, Args{"--fps", "9"},
                           Args{"--iterations", "3"}, Args{"--viscosity", "0.1"}, Args{"--vorticity", "1"}})
    expect_unused(file, more, more[0] + " has no effect without --simulate");
  for (const Args& more : {Args{"--at-once", "2"}, Args{"--max-memory", "1G"}})
    expect_unused(file, more, more[0] + " has no effect on a single frame");
  expect_unused(file, {"--no-smoothing-weights"},
                "--no-smoothing-weights has no effect without --mesh-smoothing-iters");
  const Args simulate = {"fluid", "--simulate", "drop", "--particles", "300", "--frames", "2", "-q"};
  const Args meshes = joined(simulate, {"-o", "m_{}.ply"});
  for (const Args& more :
       {Args{"--shift", "none"}, Args{"--at-once", "2"}, Args{"--max-memory", "1G"}, Args{"--overwrite"}})
    expect_unused(meshes, more, more[0] + " has no effect with --simulate");
  const Args particles = joined(simulate, {"--particles-out", "p_{}.ply"});
  for (const Args& more :
       {Args{"--particle-radius", "0.1"}, Args{"--cube-size", "1"}, Args{"--smoothing-length", "3"},
        Args{"--kernel", "anisotropic"}, Args{"--surface-threshold", "0.9"}, Args{"--mesh-smoothing-iters", "3"},
        Args{"--min-component", "3"}, Args{"--no-attributes"}, Args{"--no-normals"}})
    expect_unused(particles, more, more[0] + " has no effect where no mesh is written");
}

TEST_F(UnusedOptions, OfBenchmarksWithoutAnotherProgram) {
  const Result bench =
      run({"bench", "scan.ply", "--depths", "3", "--repeat", "1", "--devices", "cpu", "-q", "--peer-repeat", "2"});
  EXPECT_EQ(bench.err, "pointskin: warning: --peer-repeat has no effect without --peer\n");
}

TEST_F(UnusedOptions, AreNotSaidOfThoseThatAreUsed) {
  for (const Args& args : std::vector<Args>{
           {"reconstruct", "rich.ply", "-o", "out.ply", "--trim", "0.01", "--island-ratio", "0.2", "--confidence",
            "--keep-attributes", "--density", "--weakness", "--ascii", "--linear-fit", "--screening", "4"},
           {"reconstruct", "bare.ply", "-o", "out.ply", "--estimate-normals=sensor", "--sensor", "9,0,0",
            "--max-rounds", "5"},
           {"reconstruct", "bare.ply", "-o", "out.ply", "--estimate-normals=iterate", "--random-start", "--seed", "2"},
           {"reconstruct", "rich.ply", "-o", "out.obj", "--colors"},
           {"reconstruct", "rich.ply", "--repeat", "1", "--density", "--keep-attributes"},
           {"orient", "scan.ply", "-o", "out.ply", "--keep-within", "20"},
           {"fluid", "f_{}.ply", "-o", "m_{}.ply", "-r", "0.1", "--at-once", "2", "--max-memory", "1G",
            "--mesh-smoothing-iters", "2", "--no-smoothing-weights"}}) {
    const Result result = run(joined(args, args[0] == "reconstruct" ? Args{"--depth", "3"} : Args{}));
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_EQ(result.err.find("no effect"), std::string::npos) << testing::PrintToString(args) << result.err;
  }
}

TEST_F(UnusedOptions, AnEnvelopeThatMostPointsLieOutsideOf) {
  save("small.ply",
       "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
       "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
       "0.5 -0.5 -0.5\n2 -0.5 -0.5\n0.5 2 -0.5\n0.5 -0.5 2\n3 0 2 1\n3 0 1 3\n3 1 2 3\n3 2 0 3\n");
  const Args few = {"--envelope", "small.ply", "--depth", "4", "-q", "-o", "out.ply"};
  const Result result = run(joined({"reconstruct", "scan.ply"}, few));
  EXPECT_EQ(result.exit_code, 0) << result.err;
  EXPECT_TRUE(result.err.starts_with("pointskin: warning: ")) << result.err;
  EXPECT_NE(result.err.find(" of 600 points lie outside of --envelope"), std::string::npos) << result.err;
  const Result deformed = run(joined({"deform", "scan.ply", "--script", "bend.json"}, few));
  EXPECT_NE(deformed.err.find("points lie outside of --envelope"), std::string::npos) << deformed.err;
  const Result edited = run(joined({"edit", "scan.ply", "--script", "guide.json"}, few));
  EXPECT_NE(edited.err.find(" of 600 points lie outside of --envelope"), std::string::npos) << edited.err;
  const Args most = {"reconstruct", "scan.ply", "--envelope", "hull.off", "--depth", "4", "-q", "-o", "out.ply"};
  save("hull.off",
       "OFF\n8 6 0\n-9 -9 -9\n9 -9 -9\n9 9 -9\n-9 9 -9\n-9 -9 9\n9 -9 9\n9 9 9\n-9 9 9\n4 0 3 2 1\n4 4 5 6 7"
       "\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
  EXPECT_EQ(run(most).err, "");
}

TEST_F(UnusedOptions, OperationsOfAnEditThatChangeNothing) {
  const Args edit = {"edit", "scan.ply", "--script", "ops.json", "-o", "out.ply", "--depth", "3", "-q"};
  const auto warned = [&](const std::string& operations) {
    save("ops.json", R"({"version": 1, "operations": [)" + operations + "]}");
    const Result result = run(edit);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.err;
  };
  EXPECT_EQ(warned(""), "pointskin: warning: ops.json: has no operations\n");
  EXPECT_EQ(warned(R"({"op": "remove", "camera": {}, "rectangle": [0, 0, 1200, 900]})"),
            "pointskin: warning: operations[0] of ops.json: the remove changes no point\n");
  EXPECT_EQ(warned(R"({"op": "guide", "camera": {}, "stroke": [[1, 1], [2, 1]]})"),
            "pointskin: warning: operations[0] of ops.json: the guide changes no point\n");
  EXPECT_EQ(warned(R"({"op": "guide", "camera": {}, "stroke": [[400, 450], [800, 450]], "interval": 0.1})"), "");
}

TEST_F(UnusedOptions, StraysOfAnEdit) {
  std::vector<Sample> samples = sphere(600);
  samples.push_back({{99, 0, 0}, {1, 0, 0}});
  save("strays.ply", ply_bytes(samples));
  const Args edit = {"edit", "strays.ply", "--script", "guide.json", "-o", "out.ply", "--depth", "3", "-q"};
  EXPECT_NE(run(edit).err.find("1 stray points"), std::string::npos);
  EXPECT_EQ(run(joined(edit, {"--keep-strays"})).err.find("stray"), std::string::npos);
}

TEST_F(UnusedOptions, PartsOfADeformationThatReachNoPoint) {
  const auto warned = [&](const std::string& script) {
    save("script.json", script);
    const Result result = run({"deform", "scan.ply", "--script", "script.json", "-o", "out.ply", "--depth", "3", "-q"});
    EXPECT_EQ(result.exit_code, 0) << result.err;
    return result.err;
  };
  const std::string nothing = "pointskin: warning: script.json: moves nothing\n";
  EXPECT_EQ(warned("{}"), nothing);
  EXPECT_EQ(warned(R"({"handles": [], "lattices": []})"), nothing);
  EXPECT_EQ(warned(R"({"handles": [{"region": {"ball": {"centre": [0, 0, 0], "radius": 2}}}]})"), nothing);
  EXPECT_EQ(warned(kBend), "");
  const std::string turn = R"(, "rigid": {"degrees": 5}})";
  for (const char* region :
       {R"({"ball": {"centre": [0, 0, 5], "radius": 1}})", R"({"box": {"lower": [2, 2, 2], "upper": [3, 3, 3]}})",
        R"({"capsule": {"from": [3, 0, 0], "to": [3, 0, 1], "radius": 1}})",
        R"({"half_space": {"point": [0, 0, 2], "normal": [0, 0, 1]}})"})
    EXPECT_EQ(warned(std::string(R"({"handles": [{"region": )") + region + turn + "]}"),
              "pointskin: warning: script.json: handles[0]: no point lies in its region\n")
        << region;
  for (const char* region :
       {R"({"ball": {"centre": [0, 0, 1.9], "radius": 1}})", R"({"box": {"lower": [0, 0, 0], "upper": [3, 3, 3]}})",
        R"({"capsule": {"from": [3, 0, 0], "to": [3, 0, 1], "radius": 2.1}})",
        R"({"half_space": {"point": [0, 0, 0.9], "normal": [0, 0, 1]}})", R"({"points": [3]})"})
    EXPECT_EQ(warned(std::string(R"({"handles": [{"region": )") + region + turn + "]}"), "") << region;
  const std::string move = R"(, "spans": [1, 1, 1], "moves": [{"at": [0, 0, 0], "by": [0.1, 0, 0]}]}]})";
  EXPECT_EQ(warned(R"({"lattices": [{"box": {"lower": [4, 4, 4], "upper": [5, 5, 5]})" + move),
            "pointskin: warning: script.json: lattices[0]: no point lies in its block\n");
  EXPECT_EQ(warned(R"({"lattices": [{"box": {"lower": [0, 0, 0], "upper": [2, 2, 2]})" + move), "");
  EXPECT_EQ(warned(R"({"lattices": [{"origin": [0, 0, 0], "axes": [[2, 0, 0], [2, 2, 0], [0, 0, 2]])" + move), "");
}

}  // namespace
}  // namespace pointskin::test
