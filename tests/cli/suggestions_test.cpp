// Usage errors say which command or option is wrong, what may have been meant, and which words are allowed.
#include <string>
#include <utility>
#include <vector>

#include <gtest/gtest.h>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

using Args = std::vector<std::string>;

const Args kCommands = {"reconstruct", "problems", "edit",    "deform", "boolean", "fluid", "orient", "info",
                        "check",       "compare",  "convert", "render", "bench",   "help",  "version"};

void expect_usage(const Args& args, const std::string& part) {
  const Result result = pointskin_run(args);
  EXPECT_NO_FATAL_FAILURE(expect_error(result, 2, part)) << testing::PrintToString(args);
  EXPECT_EQ(result.out, "");
}

TEST(Suggestions, NameTheCommandThatWasMeant) {
  expect_usage({"recnstruct", "a.ply"}, "there is no command 'recnstruct'; did you mean 'reconstruct'?");
  expect_usage({"recon", "a.ply"}, "did you mean 'reconstruct'?");
  expect_usage({"Deform"}, "did you mean 'deform'?");
  expect_usage({"booleans"}, "did you mean 'boolean'?");
  expect_usage({"cehck", "a.ply"}, "did you mean 'check'?");
}

TEST(Suggestions, ListTheCommandsWhereNoneIsNear) {
  for (const Args& args : {Args{}, Args{"frobnicate"}}) {
    for (const std::string& command : kCommands) expect_usage(args, command);
    expect_usage(args, "try 'pointskin --help'");
  }
}

TEST(Suggestions, SeeThatTheCommandIsMissing) {
  expect_usage({"scan.ply", "-o", "mesh.ply"}, "did you mean 'pointskin reconstruct scan.ply'?");
  expect_usage({"--in", "scan.ply", "--out", "mesh.ply"}, "did you mean 'pointskin reconstruct --in'?");
  expect_usage({"-", "-o", "mesh.ply"}, "did you mean 'pointskin reconstruct -'?");
  expect_usage({"--vresion"}, "did you mean --version?");
}

TEST(Suggestions, NameTheOptionThatWasMeantInEveryCommand) {
  const std::vector<std::pair<Args, std::string>> cases = {
      {{"reconstruct", "a.ply", "-o", "b.ply", "--dpth", "9"}, "there is no option --dpth; did you mean --depth?"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "-depth", "9"}, "--depth?"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--dpth=9"}, "there is no option --dpth; did you mean --depth?"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--samples_per_node", "2"}, "--samples-per-node?"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--samplesPerNodes", "2"}, "--samples-per-node?"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--keepAttributes"}, "--keep-attributes?"},
      {{"problems", "a.ply", "--reprot", "r.json"}, "--report?"},
      {{"edit", "a.ply", "--scrpt", "s.json"}, "--script?"},
      {{"deform", "a.ply", "--script", "s.json", "--frmes", "3"}, "--frames?"},
      {{"boolean", "a.ply", "b.ply", "--opp", "union"}, "--op?"},
      {{"fluid", "a.vtk", "-o", "b.ply", "--particleRadius", "1"}, "--particle-radius?"},
      {{"orient", "a.ply", "-o", "b.ply", "--methd", "repair"}, "--method?"},
      {{"orient", "a.ply", "--ouput", "b.ply"}, "--output?"},
      {{"info", "a.ply", "--jsn"}, "--json?"},
      {{"check", "a.ply", "--JSON"}, "--json?"},
      {{"compare", "a.ply", "b.ply", "--sample", "9"}, "--samples?"},
      {{"convert", "a.ply", "b.ply", "--shfit", "none"}, "--shift?"},
      {{"render", "a.ply", "-o", "b.png", "--azimut", "9"}, "--azimuth?"},
      {{"bench", "--depht", "8"}, "--depths?"}};
  for (const auto& [args, part] : cases) {
    expect_usage(args, part);
    expect_usage(args, "try 'pointskin " + args[0] + " --help'");
  }
}

TEST(Suggestions, TellWhichCommandHasTheOption) {
  expect_usage({"reconstruct", "a.ply", "-o", "b.ply", "--script", "s.json"}, "edit and deform have it");
  expect_usage({"check", "a.ply", "--simulate", "drop"}, "there is no option --simulate of check; fluid has it");
  expect_usage({"edit", "a.ply", "--script", "s.json", "--offset", "1"}, "reconstruct and deform have it");
}

TEST(Suggestions, TellASingleArgumentTooMany) { expect_usage({"check", "a.ply", "b.ply"}, "'b.ply' is one argument"); }

TEST(HelpCommand, PrintsWhatTheOptionDoes) {
  for (const Args& args : {Args{"help"}, Args{"help", "--"}}) {
    const Result help = pointskin_run(args);
    EXPECT_EQ(help.exit_code, 0) << help.err;
    EXPECT_EQ(help.out, pointskin_run({"--help"}).out);
    EXPECT_EQ(help.err, "");
  }
  for (const std::string& command : kCommands) {
    const Result help = pointskin_run({"help", command});
    EXPECT_EQ(help.exit_code, 0) << command << help.err;
    EXPECT_EQ(help.out, pointskin_run({command, "--help"}).out) << command;
    EXPECT_EQ(help.err, "") << command;
  }
  expect_usage({"help", "recnstruct"}, "did you mean 'reconstruct'?");
  expect_usage({"help", "frobnicate"}, "there is no command 'frobnicate'");
}

TEST(VersionCommand, PrintsWhatTheOptionDoes) {
  const Result version = pointskin_run({"version"});
  EXPECT_EQ(version.exit_code, 0) << version.err;
  EXPECT_EQ(version.out, pointskin_run({"--version"}).out);
  EXPECT_TRUE(version.out.starts_with("pointskin "));
}

/// What is wrong with the value is told with the option that it was given for.
TEST(WrongValues, NameTheirOption) {
  const std::vector<std::pair<Args, std::string>> cases = {
      {{"orient", "a.ply", "-o", "b.ply", "--sensor", "0,0"}, "--sensor: '0,0' is not X,Y,Z"},
      {{"orient", "a.ply", "-o", "b.ply", "--sensor", "none"}, "--sensor: 'none' is not X,Y,Z"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--estimate-normals", "--sensor", "0,0,x"}, "--sensor: '0,0,x'"},
      {{"orient", "a.ply", "-o", "b.ply", "--shift", "0,0"}, "--shift: '0,0' is not auto, none or x,y,z"},
      {{"convert", "a.ply", "b.ply", "--shift", "0"}, "--shift: '0' is not auto, none or x,y,z"},
      {{"info", "a.ply", "--shift", "0"}, "--shift: '0'"},
      {{"render", "a.ply", "-o", "b.png", "--target", "1,2"}, "--target: '1,2'"},
      {{"render", "a.ply", "-o", "b.png", "--size", "1"}, "--size: '1'"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--max-memory", "lots"}, "--max-memory: 'lots'"},
      {{"fluid", "a.ply", "-o", "b.ply", "-r", "1", "--max-memory", "lots"}, "--max-memory: 'lots'"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--depth", "40"},
       "--depth: '40' is not a whole number from 1 to 20 or auto"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--samplesPerNode", "101"}, "--samples-per-node must be in"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--samplesPerNode", "101"}, "but is 101"},
      {{"fluid", "a.ply", "-o", "b.ply", "-r", "1", "-c", "90"}, "--cube-size must be in 0.05..4, but is 90"},
      {{"fluid", "a.ply", "-o", "b.ply", "-r", "1", "--mesh-smoothing-iters", "-1"}, "--mesh-smoothing-iters must"},
      {{"orient", "a.ply", "-o", "b.ply", "--max-rounds", "0"}, "--max-rounds must be in 1..1000, but is 0"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--depth", "eight"},
       "--depth: 'eight' is not a whole number from 1 to 20 or auto"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--depth"}, "--depth: its value D is missing"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--depth", "3", "--depth", "4"}, "--depth is given 2 times"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--trim", "1"}, "--trim: '1' is not a number from 0 to below 1 or auto"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--min-component", "1.5"}, "--min-component must be a whole number"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--min-component", "-1"}, "but is -1"},
      {{"fluid", "--simulate", "drop", "-o", "m_{}.ply", "--particles", "1"}, "--particles: 1 is not in [200, "},
      {{"fluid", "--simulate", "drop", "-o", "m_{}.ply", "--viscosity", "2"}, "--viscosity: 2 is not in [0, 1]"},
      {{"bench", "--depths", "8,99"}, "--depths: '99'"},
      {{"bench", "--generate", "cow:9"}, "--generate: 'cow:9'"}};
  for (const auto& [args, part] : cases) expect_usage(args, part);
}

/// Options that take a word name all words that are allowed, in the same way.
TEST(WrongValues, NameTheWordsThatAreAllowed) {
  const std::vector<std::pair<Args, std::string>> cases = {
      {{"reconstruct", "a.ply", "-o", "b.ply", "--boundary", "x"}, "--boundary: 'x' is not free, dirichlet or neumann"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--normals", "x"},
       "--normals: 'x' is not given, auto, repair or estimate"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--field", "x"}, "--field: 'x' is not poisson or distance"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--bType", "9"}, "--bType: '9' is not 1, 2 or 3"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--device", "x"},
       "--device: 'x' is not auto, cpu, cuda, cuda:N, cuda:N,M or cuda:all"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--device", "cuda:0,x"},
       "--device: 'cuda:0,x' is not auto, cpu, cuda, cuda:N, cuda:N,M or cuda:all"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--estimate-normals=x"},
       "--estimate-normals: 'x' is not auto, sensor, propagate, iterate or repair"},
      {{"orient", "a.ply", "-o", "b.ply", "--method", "x"},
       "--method: 'x' is not auto, sensor, propagate, iterate or repair"},
      {{"boolean", "a.ply", "b.ply", "-o", "c.ply", "--op", "x"},
       "--op: 'x' is not union, intersection, difference or symmetric-difference"},
      {{"boolean", "a.ply", "b.ply", "-o", "c.ply", "--op", "union", "--creases", "x"},
       "--creases: 'x' is not none or sampled"},
      {{"fluid", "a.ply", "-o", "b.ply", "-r", "1", "--kernel", "x"}, "--kernel: 'x' is not isotropic or anisotropic"},
      {{"fluid", "--simulate", "x", "-o", "m_{}.ply"},
       "--simulate: 'x' is not dam-break, double-dam-break, drop, obstacle or stir"},
      {{"render", "a.ply", "-o", "b.png", "--up", "w"}, "--up: 'w' is not x, y, z, -x, -y or -z"},
      {{"reconstruct", "a.ply", "-o", "b.ply", "--device", "cuda:0,0"}, "--device: GPU 0 is named twice"},
      {{"bench", "--devices", "cpu,x"}, "--devices: 'x' is not all, cpu, cuda, cuda:N, cuda:N,M or cuda:all"}};
  for (const auto& [args, part] : cases) expect_usage(args, part);
}

}  // namespace
}  // namespace pointskin::test
