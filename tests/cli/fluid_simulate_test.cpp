// pointskin fluid --simulate: frames, the report, and what is refused.
#include <filesystem>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "cli/files.hpp"
#include "cli/program.hpp"
#include "cli/schema.hpp"

namespace pointskin::test {
namespace {

using Json = nlohmann::json;
using Args = std::vector<std::string>;

class FluidSimulate : public testing::Test {
 protected:
  Result simulate(const Args& more) {
    Args args = {"fluid", "--simulate", "dam-break", "--particles", "1000", "-c", "1", "-q"};
    args.insert(args.end(), more.begin(), more.end());
    return pointskin_run(args);
  }

  void expect_failure(const Args& more, int code, const std::string& part) {
    const Result result = simulate(more);
    EXPECT_EQ(result.exit_code, code) << result.err;
    EXPECT_TRUE(is_one_error_line(result.err)) << result.err;
    EXPECT_NE(result.err.find(part), std::string::npos) << result.err;
    EXPECT_TRUE(folder_.names().empty());
  }

  TemporaryFolder folder_;
};

TEST_F(FluidSimulate, WritesMeshesAndParticlesOfEveryFrame) {
  const Result result = simulate({"--frames", "11", "-o", folder_ / "m_{}.ply", "--particles-out", folder_ / "p_{}.ply",
                                  "--report", folder_ / "r.json"});
  ASSERT_EQ(result.exit_code, 0) << result.err;
  EXPECT_EQ(result.err, "");
  EXPECT_EQ(folder_.names().size(), 23U);
  const Json report = Json::parse(read_file(folder_ / "r.json"));
  const Json schema = Json::parse(read_file(POINTSKIN_SOURCE_DIR "/docs/simulation.schema.json"));
  for (const std::string& found : schema_violations(schema, report, "report")) ADD_FAILURE() << found;
  ASSERT_EQ(report["frames"].size(), 11U);
  for (int frame = 0; frame < 11; ++frame) {
    std::string number = std::to_string(frame);
    if (frame < 10) number.insert(number.begin(), '0');
    const MeshReport mesh = measure(read_mesh(folder_ / ("m_" + number + ".ply")));
    EXPECT_TRUE(mesh.watertight()) << frame;
    EXPECT_EQ(report["frames"][frame]["frame"], frame);
    EXPECT_EQ(report["frames"][frame]["mesh"]["triangles"], mesh.triangles);
    const Cloud particles = read_cloud(folder_ / ("p_" + number + ".ply"));
    EXPECT_EQ(particles.size(), 1000);
    ASSERT_EQ(particles.attributes.size(), 3U);
    EXPECT_EQ(particles.attributes[1].name, "velocity_y");
    if (frame == 0) {
      EXPECT_EQ(particles.attributes[1].values.as<float>(), std::vector<float>(1000, 0.0F));
    }
  }
  EXPECT_GT(report["frames"][10]["kinetic_energy"], 0);
}

TEST_F(FluidSimulate, GivesTheSameBytesForAnyNumberOfThreads) {
  std::set<std::string> meshes;
  std::set<std::string> particles;
  for (const char* threads : {"1", "2", "5"}) {
    ASSERT_EQ(simulate({"--frames", "8", "--device", "cpu", "--threads", threads, "-o", folder_ / "m_{}.ply",
                        "--particles-out", folder_ / "p_{}.ply"})
                  .exit_code,
              0);
    meshes.insert(read_file(folder_ / "m_7.ply"));
    particles.insert(read_file(folder_ / "p_7.ply"));
  }
  EXPECT_EQ(meshes.size(), 1U);
  EXPECT_EQ(particles.size(), 1U);
}

TEST_F(FluidSimulate, RefusesWhatIsOutOfRange) {
  const std::string output = folder_ / "m_{}.ply";
  expect_failure({}, 2, "no output");
  expect_failure({"-o", folder_ / "m.ply"}, 2, "{}");
  expect_failure({"-o", output, "--particles-out", output}, 2, "same file");
  expect_failure({"-o", output, "--particles-out", folder_ / "p_{}.obj"}, 2, ".ply");
  expect_failure({"-o", output, "--frames", "0"}, 2, "--frames");
  expect_failure({"-o", output, "--fps", "0"}, 2, "--fps");
  expect_failure({"-o", output, "--iterations", "0"}, 2, "iterations");
  expect_failure({"-o", output, "--viscosity", "2"}, 2, "viscosity");
  expect_failure({"-o", folder_ / "no/m_{}.ply"}, 8, "m_");
  const Result unknown = pointskin_run({"fluid", "--simulate", "flood", "-o", output});
  EXPECT_EQ(unknown.exit_code, 2);
  EXPECT_NE(unknown.err.find("dam-break"), std::string::npos) << unknown.err;
  EXPECT_EQ(pointskin_run({"fluid", "--simulate", "drop", "--particles", "10", "-o", output}).exit_code, 2);
}

}  // namespace
}  // namespace pointskin::test
