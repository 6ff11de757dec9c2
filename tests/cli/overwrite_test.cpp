// No file of the user's is replaced unasked, and none is written twice, whatever the names look like.
#include <sys/stat.h>

#include <filesystem>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

namespace fs = std::filesystem;
using Args = std::vector<std::string>;

constexpr char kHold[] = R"({"handles": [{"region": {"ball": {"centre": [0, 0, 0], "radius": 3}}}]})";
constexpr char kInsert[] =
    R"({"version": 1, "operations": [{"op": "insert", "file": "part.ply", "translation": [0.1, 0, 0]}]})";

/// A folder with a file of every kind that commands read.
class Overwriting : public testing::Test {
 protected:
  Overwriting() {
    save("scan.ply", ply_bytes(sphere(600)));
    save("other.ply", ply_bytes(sphere(600, {0.5F, 0, 0})));
    save("part.ply", ply_bytes(sphere(50, {0.2F, 0, 0})));
    save("mesh.ply", cube_mesh_ply(2));
    save("mesh.png", cube_mesh_ply(2));
    save("bend.json", kHold);
    save("ops.json", kInsert);
    save("f_1.ply", ply_bytes(sphere(200), false));
    save("f_2.ply", ply_bytes(sphere(300), false));
  }

  void save(const std::string& name, const std::string& bytes) { write_file(folder_ / name, bytes); }
  [[nodiscard]] std::string bytes(const std::string& name) const { return read_file(folder_ / name); }

  [[nodiscard]] Result run(const Args& args) const {
    Start start;
    start.args = args;
    start.folder = folder_.path();
    return run_program(start);
  }

  /// Expects exit code 2 with `part` in its line, and that no file has changed.
  void expect_refused(const Args& args, const std::string& part) {
    const std::vector<std::string> names = folder_.names();
    std::vector<std::string> before;
    for (const std::string& name : names) before.push_back(content(name));
    const Result result = run(args);
    EXPECT_NO_FATAL_FAILURE(expect_error(result, 2, part)) << testing::PrintToString(args);
    EXPECT_EQ(folder_.names(), names) << testing::PrintToString(args);
    for (std::size_t i = 0; i < names.size(); ++i)
      EXPECT_EQ(content(names[i]), before[i]) << names[i] << testing::PrintToString(args);
  }

  /// Expects that `args` are refused, and done with --overwrite, which replaces `name` alone.
  void expect_asks(Args args, const std::string& name) {
    const std::string before = bytes(name);
    expect_refused(args, "--overwrite");
    const std::vector<std::string> names = folder_.names();
    args.emplace_back("--overwrite");
    const Result result = run(args);
    EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(args) << result.err;
    EXPECT_NE(bytes(name), before) << testing::PrintToString(args);
    EXPECT_EQ(folder_.names(), names) << testing::PrintToString(args);
  }

  TemporaryFolder folder_;

 private:
  [[nodiscard]] std::string content(const std::string& name) const {
    return fs::is_regular_file(folder_ / name) ? bytes(name) : "";
  }
};

TEST_F(Overwriting, ReconstructAsks) {
  expect_asks({"reconstruct", "scan.ply", "-o", "scan.ply", "--depth", "3"}, "scan.ply");
  expect_asks({"reconstruct", "other.ply", "part.ply", "-o", "part.ply", "--depth", "3"}, "part.ply");
}

TEST_F(Overwriting, ReconstructAsksForItsEnvelopeAndForNamedInputs) {
  save("hull.ply", cube_mesh_ply(1));
  expect_refused({"reconstruct", "scan.ply", "-o", "hull.ply", "--envelope", "hull.ply"}, "--overwrite");
  expect_refused({"reconstruct", "--in", "scan.ply", "--out", "scan.ply"}, "--overwrite");
}

TEST_F(Overwriting, ProblemsAsks) {
  expect_asks({"problems", "scan.ply", "-o", "scan.ply", "--depth", "3"}, "scan.ply");
}

TEST_F(Overwriting, OrientAsks) { expect_asks({"orient", "scan.ply", "-o", "scan.ply"}, "scan.ply"); }

TEST_F(Overwriting, ConvertAsks) {
  save("cloud.ply",
       "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
       "end_header\n1 2 3\n");
  expect_asks({"convert", "mesh.ply", "mesh.ply"}, "mesh.ply");
  expect_asks({"convert", "cloud.ply", "cloud.ply"}, "cloud.ply");
}

TEST_F(Overwriting, RenderAsks) { expect_asks({"render", "mesh.png", "-o", "mesh.png", "--size", "9x9"}, "mesh.png"); }

TEST_F(Overwriting, BooleanAsks) {
  const Args unite = {"boolean", "scan.ply", "other.ply", "--op", "union", "--depth", "4"};
  const auto with = [&unite](const Args& more) {
    Args args = unite;
    args.insert(args.end(), more.begin(), more.end());
    return args;
  };
  save("out.ply", "old");
  expect_asks(with({"-o", "out.ply", "--cloud", "other.ply"}), "other.ply");
  expect_asks(with({"-o", "scan.ply"}), "scan.ply");
}

TEST_F(Overwriting, DeformAsks) {
  expect_asks({"deform", "scan.ply", "--script", "bend.json", "-o", "scan.ply", "--depth", "3"}, "scan.ply");
  expect_asks({"deform", "other.ply", "--script", "bend.json", "--cloud", "other.ply", "--depth", "3"}, "other.ply");
}

TEST_F(Overwriting, EditAsksForItsInputsItsScriptAndWhatThatInserts) {
  const Args edit = {"edit", "scan.ply", "--script", "ops.json", "--depth", "3"};
  const auto with = [&edit](const Args& more) {
    Args args = edit;
    args.insert(args.end(), more.begin(), more.end());
    return args;
  };
  expect_asks(with({"--save", "ops.json"}), "ops.json");
  save("ops.json", kInsert);
  expect_asks(with({"-o", "./part.ply"}), "part.ply");
  save("part.ply", ply_bytes(sphere(50)));
  expect_asks(with({"--cloud", "scan.ply"}), "scan.ply");
  expect_asks(with({"-o", "scan.ply"}), "scan.ply");
}

TEST_F(Overwriting, FluidAsks) { expect_asks({"fluid", "f_1.ply", "-o", "f_1.ply", "-r", "0.1"}, "f_1.ply"); }

TEST_F(Overwriting, SeesThroughLinksAndDots) {
  fs::create_symlink("scan.ply", folder_ / "link.ply");
  fs::create_symlink("link.ply", folder_ / "chain.ply");
  fs::create_hard_link(folder_ / "scan.ply", folder_ / "twin.ply");
  fs::create_directory(folder_ / "deep");
  fs::create_directory_symlink(".", folder_ / "here");
  for (const std::string& name : {std::string("link.ply"), std::string("chain.ply"), std::string("twin.ply"),
                                  std::string("./scan.ply"), std::string(".//scan.ply"),
                                  std::string("deep/../scan.ply"), std::string("here/scan.ply"), folder_ / "scan.ply"})
    expect_refused({"reconstruct", "scan.ply", "-o", name}, "--overwrite");
}

/// Which command, and how it names its report.
TEST_F(Overwriting, ReportsReplaceNoInputEvenIfAsked) {
  for (Args args : std::vector<Args>{
           {"reconstruct", "scan.ply", "-o", "out.ply", "--report", "./scan.ply"},
           {"problems", "scan.ply", "--report", "scan.ply"},
           {"edit", "scan.ply", "--script", "ops.json", "--report", "part.ply"},
           {"edit", "scan.ply", "--script", "ops.json", "--report", "ops.json"},
           {"deform", "scan.ply", "--script", "bend.json", "-o", "out.ply", "--report", "bend.json"},
           {"boolean", "scan.ply", "other.ply", "--op", "union", "-o", "out.ply", "--report", "other.ply"},
           {"orient", "scan.ply", "-o", "out.ply", "--report", "scan.ply"},
           {"fluid", "f_1.ply", "-o", "out.ply", "-r", "0.1", "--report", "f_1.ply"},
           {"fluid", "f_{}.ply", "-o", "out_{}.ply", "-r", "0.1", "--report", "f_2.ply"}}) {
    expect_refused(args, "would overwrite the input");
    args.emplace_back("--overwrite");
    expect_refused(args, "would overwrite the input");
  }
  for (const char* option : {"--report", "--plot"}) {
    const Args bench = {"bench", "scan.ply", "--depths", "3", "--repeat", "1", "--devices", "cpu"};
    Args args = bench;
    args.insert(args.end(), {option, "./scan.ply"});
    expect_refused(args, "would overwrite the input");
    args = bench;
    args.insert(args.end(), {"--peer", "/bin/cp {in} {out} --config=ops.json bend.json", option, "ops.json"});
    expect_refused(args, "would overwrite the input");
    args.back() = "bend.json";
    expect_refused(args, "would overwrite the input");
  }
}

TEST_F(Overwriting, TwoOutputsAreNeverOneFile) {
  save("here.ply", "old");
  fs::create_hard_link(folder_ / "here.ply", folder_ / "twin.ply");
  fs::create_symlink("here.ply", folder_ / "link.ply");
  fs::create_symlink("nothing.ply", folder_ / "dangling.ply");
  for (const auto& [a, b] : std::vector<std::pair<std::string, std::string>>{{"new.ply", "./new.ply"},
                                                                             {"new.ply", ".//.//new.ply"},
                                                                             {"here.ply", "twin.ply"},
                                                                             {"here.ply", "link.ply"},
                                                                             {"nothing.ply", "dangling.ply"},
                                                                             {"new.ply", folder_ / "new.ply"}}) {
    for (const Args& args :
         std::vector<Args>{{"reconstruct", "scan.ply", "-o", a, "--report", b},
                           {"problems", "scan.ply", "-o", a, "--report", b},
                           {"orient", "scan.ply", "-o", a, "--report", b},
                           {"edit", "scan.ply", "--script", "ops.json", "-o", a, "--save", b},
                           {"edit", "scan.ply", "--script", "ops.json", "--report", a, "--save", b},
                           {"edit", "scan.ply", "--script", "ops.json", "-o", a, "--cloud", b},
                           {"deform", "scan.ply", "--script", "bend.json", "-o", a, "--cloud", b},
                           {"deform", "scan.ply", "--script", "bend.json", "-o", a, "--report", b},
                           {"boolean", "scan.ply", "other.ply", "--op", "union", "-o", a, "--cloud", b},
                           {"boolean", "scan.ply", "other.ply", "--op", "union", "-o", a, "--report", b},
                           {"fluid", "f_1.ply", "-o", a, "-r", "0.1", "--report", b},
                           {"bench", "scan.ply", "--depths", "3", "--repeat", "1", "--report", a, "--plot", b}})
      expect_refused(args, "same file");
  }
}

TEST_F(Overwriting, AFrameReplacesNoOtherFramesInput) {
  save("f_01.ply", ply_bytes(sphere(250), false));
  for (const Args& more : {Args{}, Args{"--overwrite"}}) {
    Args args = {"fluid", "f_{}.ply", "-o", "f_0{}.ply", "-r", "0.1"};
    args.insert(args.end(), more.begin(), more.end());
    expect_refused(args, "another frame");
    args = {"deform", "f_1.ply", "--script", "bend.json", "-o", "f_{}.ply", "--frames", "3"};
    args.insert(args.end(), more.begin(), more.end());
    expect_refused(args, "f_1.ply");
    args = {"deform", "scan.ply", "f_2.ply", "--script", "bend.json", "--cloud", "./f_{}.ply", "--frames", "3"};
    args.insert(args.end(), more.begin(), more.end());
    expect_refused(args, "f_2.ply");
  }
}

TEST_F(Overwriting, AFrameReplacesItsOwnParticlesIfAsked) {
  const std::string before = bytes("f_2.ply");
  expect_asks({"fluid", "f_{}.ply", "-o", "./f_{}.ply", "-r", "0.1", "--at-once", "2", "--threads", "2"}, "f_1.ply");
  EXPECT_NE(bytes("f_2.ply"), before);
  EXPECT_EQ(run({"check", "f_2.ply"}).exit_code, 0);
}

TEST_F(Overwriting, NoReportTakesAFramesName) {
  expect_refused({"fluid", "f_{}.ply", "-o", "m_{}.ply", "-r", "0.1", "--report", "./m_2.ply"}, "same file");
  expect_refused(
      {"deform", "scan.ply", "--script", "bend.json", "-o", "m_{}.ply", "--frames", "12", "--report", "m_07.ply"},
      "same file");
  expect_refused(
      {"deform", "scan.ply", "--script", "bend.json", "-o", "m_{}.ply", "--cloud", "./m_{}.ply", "--frames", "3"},
      "same file");
  const Args simulate = {"fluid", "--simulate", "drop", "--particles", "500", "--frames", "11", "-o", "m_{}.ply"};
  for (const Args& more : {Args{"--report", ".//m_03.ply"}, Args{"--particles-out", "./m_{}.ply"}}) {
    Args args = simulate;
    args.insert(args.end(), more.begin(), more.end());
    expect_refused(args, "same file");
  }
}

TEST_F(Overwriting, ASequenceWritesNoFileTwiceThroughLinks) {
  fs::create_symlink("m_1.ply", folder_ / "m_0.ply");
  expect_refused({"fluid", "--simulate", "drop", "--particles", "500", "--frames", "3", "-o", "m_{}.ply"},
                 "same file twice");
}

TEST_F(Overwriting, TheNullDeviceMayBeNamedTwiceAndAPipeMayNot) {
  EXPECT_EQ(run({"reconstruct", "scan.ply", "-o", "/dev/null", "--report", "/dev/null", "--depth", "3"}).exit_code, 0);
  ASSERT_EQ(mkfifo((folder_ / "pipe").c_str(), 0600), 0);
  expect_refused({"reconstruct", "scan.ply", "-o", "pipe", "--report", "./pipe"}, "same file");
  expect_refused({"orient", "pipe", "-o", "pipe"}, "pipe");
}

TEST_F(Overwriting, FilesThatAreNoInputsAreReplacedAsEver) {
  save("old.ply", "old");
  save("old.json", "old");
  EXPECT_EQ(run({"reconstruct", "scan.ply", "-o", "old.ply", "--report", "old.json", "--depth", "3"}).exit_code, 0);
  EXPECT_TRUE(bytes("old.ply").starts_with("ply"));
  EXPECT_TRUE(bytes("old.json").starts_with("{"));
}

TEST_F(Overwriting, AMissingInputIsToldAsMissing) {
  EXPECT_EQ(run({"reconstruct", "nothing.ply", "-o", "nothing.ply"}).exit_code, 3);
}

TEST_F(Overwriting, KnowsWhereStdinAndStdoutLead) {
  const std::string before = bytes("scan.ply");
  const Result replaced = run_shell("exec \"$P\" reconstruct - -o scan.ply --depth 3 < scan.ply", folder_.path());
  expect_error(replaced, 2, "--overwrite");
  const Result appended =
      run_shell("exec \"$P\" reconstruct scan.ply -o - --depth 3 --overwrite >> scan.ply", folder_.path());
  expect_error(appended, 2, "stdout");
  const Result both =
      run_shell("exec \"$P\" reconstruct scan.ply -o - --report both.ply --depth 3 > both.ply", folder_.path());
  expect_error(both, 2, "same file");
  EXPECT_EQ(bytes("scan.ply"), before);
}

}  // namespace
}  // namespace pointskin::test
