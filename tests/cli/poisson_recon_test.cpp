// Command lines of PoissonRecon 18.75: what means the same works, the rest is said, and --ascii writes text.
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

using Args = std::vector<std::string>;

/// ASCII PLY of a sphere with colours and a scalar.
std::string coloured_sphere() {
  std::string rows;
  for (const auto& [p, n] : sphere(1000)) {
    for (const float x : {p.x, p.y, p.z, n.x, n.y, n.z}) rows += std::to_string(x) + " ";
    rows += std::to_string(static_cast<int>(100 + 100 * p.x)) + " 9 9 " + std::to_string(p.y) + "\n";
  }
  return "ply\nformat ascii 1.0\nelement vertex 1000\nproperty float x\nproperty float y\nproperty float z\nproperty "
         "float nx\nproperty float ny\nproperty float nz\nproperty uchar red\nproperty uchar green\nproperty uchar "
         "blue\n"
         "property float quality\nend_header\n" +
         rows;
}

class PoissonReconNames : public testing::Test {
 protected:
  PoissonReconNames() { write_file(folder_ / "in.ply", coloured_sphere()); }

  Result run(Args more) {
    more.insert(more.begin(), {"reconstruct", "--in", folder_ / "in.ply", "--out", output_, "--depth", "5", "-q"});
    std::filesystem::remove(output_);
    return pointskin_run(more);
  }

  /// The mesh; what was said goes to `said`.
  std::string bytes_with(const Args& more, std::string* said = nullptr) {
    const Result result = run(more);
    EXPECT_EQ(result.exit_code, 0) << testing::PrintToString(more) << result.err;
    if (said != nullptr) *said = result.err;
    return read_file(output_);
  }

  TemporaryFolder folder_;
  std::string output_ = folder_ / "out.ply";
};

TEST_F(PoissonReconNames, AliasesDoTheSame) {
  EXPECT_TRUE(bytes_with({"--iters", "3"}) == bytes_with({"--iterations", "3"}));
  EXPECT_TRUE(bytes_with({"--iters", "3"}) != bytes_with({}));
  EXPECT_TRUE(bytes_with({"--linearFit"}) == bytes_with({"--linear-fit"}));
  EXPECT_EQ(run({"--iters", "3", "--iterations", "3"}).exit_code, 2);
  EXPECT_EQ(run({"--maxMemory", "64"}).exit_code, 0);
  EXPECT_EQ(run({"--maxMemory", "0"}).exit_code, 0);
  EXPECT_EQ(run({"--maxMemory", "0.0001"}).exit_code, 6);
  EXPECT_EQ(run({"--maxMemory", "much"}).exit_code, 2);
}

TEST_F(PoissonReconNames, ResidualsAreShown) {
  const Result shown =
      pointskin_run({"reconstruct", folder_ / "in.ply", "-o", output_, "--depth", "4", "--showResidual"});
  EXPECT_NE(shown.err.find("residual before"), std::string::npos) << shown.err;
}

TEST_F(PoissonReconNames, DataKeepsAttributesAndSaysThatTheFactorIsNotUsed) {
  const std::string expected = bytes_with({"--keep-attributes"});
  std::string said;
  EXPECT_TRUE(bytes_with({"--data"}, &said) == expected);
  EXPECT_EQ(said, "");
  for (const Args& more : {Args{"--data", "16"}, Args{"--data=16"}}) {
    EXPECT_TRUE(bytes_with(more, &said) == expected);
    EXPECT_EQ(said,
              "pointskin: warning: --data: the factor 16 has no meaning here; properties are carried as with "
              "--keep-attributes\n");
  }
  EXPECT_EQ(run({"--data=much"}).exit_code, 2);
  EXPECT_EQ(read_mesh((bytes_with({"--data", "32", "--colors"}), output_)).attributes.size(), 4U);
}

TEST_F(PoissonReconNames, OptionsWithoutAMeaningHereAreSaid) {
  const std::string expected = bytes_with({});
  for (const Args& more : {Args{"--performance"},
                           Args{"--inCore"},
                           Args{"--primalGrid"},
                           Args{"--exact"},
                           Args{"--noErode"},
                           Args{"--polygonMesh"},
                           Args{"--nonManifold"},
                           Args{"--gradients"},
                           Args{"--parallel", "0"},
                           Args{"--schedule", "1"},
                           Args{"--chunkSize", "128"},
                           Args{"--tempDir", "/tmp"},
                           Args{"--degree", "1"},
                           Args{"--kernelDepth", "6"},
                           Args{"--solveDepth", "7"},
                           Args{"--fullDepth", "5"},
                           Args{"--baseDepth", "4"},
                           Args{"--baseVCycles", "2"},
                           Args{"--cgAccuracy", "0.001"},
                           Args{"--lowDepthCutOff", "0"},
                           Args{"--envelopeDepth", "5"},
                           Args{"--alignDir", "2"}}) {
    std::string said;
    EXPECT_TRUE(bytes_with(more, &said) == expected) << more[0];
    EXPECT_TRUE(is_one_error_line(said)) << more[0] << said;
    EXPECT_TRUE(said.starts_with("pointskin: warning: " + more[0] + " ")) << said;
  }
  const std::string help = pointskin_run({"reconstruct", "--help"}).out;
  EXPECT_EQ(help.find("--parallel"), std::string::npos) << "what means nothing is not listed";
}

/// What would be written is not what was asked for.
TEST_F(PoissonReconNames, OptionsThatChangeTheOutputAreRefused) {
  for (const Args& more :
       {Args{"--grid", "g.bin"}, Args{"--tree", "t.bin"}, Args{"--xForm", "x.txt"}, Args{"--gridCoordinates"}}) {
    const Result result = run(more);
    EXPECT_EQ(result.exit_code, 2) << more[0];
    EXPECT_NE(result.err.find("there is no option " + more[0]), std::string::npos) << result.err;
  }
}

TEST_F(PoissonReconNames, AsciiWritesTextOfTheSameMesh) {
  bytes_with({"--keep-attributes"});
  const Mesh binary = read_mesh(output_);
  const std::string text = bytes_with({"--keep-attributes", "--ascii"});
  EXPECT_TRUE(text.starts_with("ply\nformat ascii 1.0\n")) << text.substr(0, 40);
  const Mesh back = read_mesh(output_);
  EXPECT_EQ(back.vertices, binary.vertices);
  EXPECT_EQ(back.normals, binary.normals);
  EXPECT_EQ(back.triangles, binary.triangles);
  ASSERT_EQ(back.attributes.size(), binary.attributes.size());
  for (std::size_t a = 0; a < back.attributes.size(); ++a)
    EXPECT_EQ(back.attributes[a].values, binary.attributes[a].values) << back.attributes[a].name;
  Args report = {"--ascii", "--report", folder_ / "r.json"};
  bytes_with(report);
  EXPECT_EQ(nlohmann::json::parse(read_file(folder_ / "r.json"))["options"]["ascii"], true);
}

TEST_F(PoissonReconNames, AsciiWritesToStdoutToo) {
  const Result result = pointskin_run({"reconstruct", folder_ / "in.ply", "-o", "-", "--depth", "4", "-q", "--ascii"});
  EXPECT_TRUE(result.out.starts_with("ply\nformat ascii 1.0\n"));
}

TEST_F(PoissonReconNames, OrientAndConvertWriteTextAsWell) {
  for (const Args& args : {Args{"orient", folder_ / "in.ply", "-o", output_, "--ascii"},
                           Args{"convert", folder_ / "in.ply", output_, "--ascii"}}) {
    std::filesystem::remove(output_);
    const Result result = pointskin_run(args);
    EXPECT_EQ(result.exit_code, 0) << result.err;
    EXPECT_TRUE(read_file(output_).starts_with("ply\nformat ascii 1.0\n")) << args[0];
    EXPECT_EQ(read_cloud(output_).size(), 1000) << args[0];
  }
}

}  // namespace
}  // namespace pointskin::test
