// Every option that a command lists in its help is taken, and does something.
#include <algorithm>
#include <filesystem>
#include <map>
#include <regex>
#include <set>
#include <string>
#include <vector>

#include <gtest/gtest.h>

#include "cli/files.hpp"
#include "cli/program.hpp"

namespace pointskin::test {
namespace {

using Args = std::vector<std::string>;

/// How an option is tried: `before` and `after` give different output.
struct Trial {
  Args after;
  Args before = {};
  bool may_fail = false;  ///< what changes is that the command refuses
};
using Trials = std::map<std::string, Trial>;

/// Three quarters of a noisy sphere, normals of all lengths, colours and a scalar, and a stray point.
std::string open_scan() {
  std::string rows;
  int count = 0;
  std::uint32_t random = 1;
  const auto draw = [&random] {
    return static_cast<float>((random = random * 1664525U + 1013904223U) >> 8) * 0x1p-24F;
  };
  for (const Sample& s : sphere(2500)) {
    const float grow = 1 + 0.03F * (draw() - 0.5F);
    const float length = 0.5F + 2 * draw();
    const float red = 255 * draw();
    if (s.position.z > 0.5F) continue;
    ++count;
    for (const float x : {grow * s.position.x, grow * s.position.y, grow * s.position.z, length * s.normal.x,
                          length * s.normal.y, length * s.normal.z})
      rows += std::to_string(x) + " ";
    rows += std::to_string(static_cast<int>(red)) + " 9 9 " + std::to_string(draw()) + "\n";
  }
  rows += "40 0 0 1 0 0 9 9 9 0\n";
  return "ply\nformat ascii 1.0\nelement vertex " + std::to_string(count + 1) +
         "\nproperty float x\nproperty float y\nproperty float z\nproperty float nx\nproperty float ny\nproperty float "
         "nz\nproperty uchar red\nproperty uchar green\nproperty uchar blue\nproperty float quality\nend_header\n" +
         rows;
}

/// The long names of the options in `help`, or the short one where there is no long one.
std::set<std::string> listed_in(const std::string& help) {
  std::set<std::string> names;
  const std::regex line(R"(^  (?:-\w, )?(--?[A-Za-z][A-Za-z-]*))");
  for (std::size_t start = 0, end = 0; (end = help.find('\n', start)) != std::string::npos; start = end + 1) {
    std::smatch match;
    const std::string text = help.substr(start, end - start);
    if (std::regex_search(text, match, line)) names.insert(match[1]);
  }
  return names;
}

class HelpOptions : public testing::Test {
 protected:
  HelpOptions() {
    save("scan.ply", open_scan());
    save("whole.ply", ply_bytes(sphere(1500)));
    std::vector<Sample> apart = sphere(800);
    for (Sample& s : apart) s.position = {2.5F + 0.5F * s.position.x, 0.5F * s.position.y, 0.5F * s.position.z};
    save("apart.ply", ply_bytes(apart));
    save("moved.ply", ply_bytes(sphere(1500, {0.7F, 0.1F, 0.2F})));
    std::vector<Sample> with_stray = sphere(1500, {0.7F, 0.1F, 0.2F});
    with_stray.push_back({{90, 0, 0}, {1, 0, 0}});
    save("stray.ply", ply_bytes(with_stray));
    save("hull.off",
         "OFF\n8 6 0\n-1 -1 -1\n1 -1 -1\n1 1 -1\n-1 1 -1\n-1 -1 0.6\n1 -1 0.6\n1 1 0.6\n-1 1 0.6\n4 0 3 2 1\n"
         "4 4 5 6 7\n4 0 1 5 4\n4 1 2 6 5\n4 2 3 7 6\n4 3 0 4 7\n");
    save("bend.json", R"({"handles": [
      {"region": {"half_space": {"point": [0, 0, -0.5], "normal": [0, 0, -1]}}},
      {"region": {"ball": {"centre": [0, 0, 0.4], "radius": 1}}, "rigid": {"axis": [0, 1, 0], "degrees": 40}}]})");
    save("hold.json", R"({"handles": [{"region": {"ball": {"centre": [0, 0, 0], "radius": 2}}}]})");
    save("ops.json", R"({"version": 1, "operations": [
      {"op": "guide", "camera": {}, "stroke": [[400, 450], [800, 450]], "interval": 0.1}]})");
    save("none.json", R"({"version": 1, "operations": []})");
    for (int i = 1; i <= 3; ++i) {
      std::string text;
      for (const Sample& s : sphere(150 + 10 * i))
        text += std::to_string(s.position.x) + " " + std::to_string(s.position.y) + " " + std::to_string(s.position.z) +
                " 0.25\n";
      text += "9 0 0 1\n";  // a piece of one particle
      save("p_" + std::to_string(i) + ".xyz", text);
    }
  }

  void save(const std::string& name, const std::string& bytes) { write_file(folder_ / name, bytes); }

  /// Exit code, stdout, names and bytes of all files that a run makes; times in reports do not count.
  std::string outcome_of(const Args& args, int& exit_code, std::string& warnings) {
    const std::vector<std::string> before = folder_.names();
    std::map<std::string, std::string> contents;
    for (const std::string& name : before) contents[name] = read_file(folder_ / name);
    Start start;
    start.args = args;
    start.folder = folder_.path();
    const Result result = run_program(start);
    exit_code = result.exit_code;
    warnings = result.err;
    // Times and memory in reports are never alike.
    static const std::regex kCosts(
        "\"[a-z_]*(ms|bytes|median|min|max|total|read|write|surface|upload|octree|splat|solve|"
        "extract|download|edit|reconstruct|sample|map|mesh|estimate|propagate|iterate|"
        "particles|field|finish|simulate)\": [0-9.e+-]+\\.[0-9e+-]+|_bytes\": [0-9]+");
    std::string outcome = std::to_string(result.exit_code) + result.out;
    outcome += std::to_string(std::count(result.err.begin(), result.err.end(), '\n')) + " lines";
    for (const std::string& name : folder_.names()) {
      const std::string bytes = read_file(folder_ / name);
      if (contents.contains(name) && contents[name] == bytes) continue;
      outcome += name + (name.ends_with(".json") ? std::regex_replace(bytes, kCosts, "") : bytes);
      if (contents.contains(name))
        write_file(folder_ / name, contents[name]);
      else
        std::filesystem::remove(folder_ / name);
    }
    return outcome;
  }

  /// The outcome of a run that several options are compared with, which must be the same two times.
  const std::string& outcome_without(const Args& args) {
    const auto [found, is_new] = known_.try_emplace(args);
    if (is_new) {
      int exit_code = 0;
      std::string warnings;
      found->second = outcome_of(args, exit_code, warnings);
      EXPECT_TRUE(found->second == outcome_of(args, exit_code, warnings))
          << testing::PrintToString(args) << ": two runs differ";
    }
    return found->second;
  }

  /// Tries every option that `command` lists.
  void try_all(const std::string& command, const Args& base, Trials trials) {
    trials.insert({"--help", {{"--help"}}});
    for (const std::string& name : listed_in(pointskin_run({command, "--help"}).out)) {
      ASSERT_TRUE(trials.contains(name)) << command << " lists " << name << ", which is not tried";
      const Trial& trial = trials[name];
      Args before = base, after = base;
      before.insert(before.end(), trial.before.begin(), trial.before.end());
      after.insert(after.end(), trial.after.begin(), trial.after.end());
      int code_after = 0;
      std::string said_after;
      const std::string outcome_after = outcome_of(after, code_after, said_after);
      EXPECT_FALSE(outcome_without(before) == outcome_after) << command << " " << name << " does nothing";
      EXPECT_EQ(said_after.find("no effect"), std::string::npos) << said_after;
      EXPECT_TRUE(trial.may_fail || code_after == 0) << command << testing::PrintToString(trial.after) << said_after;
      trials.erase(name);
    }
    for (const auto& [name, trial] : trials) ADD_FAILURE() << command << " does not list " << name;
  }

  TemporaryFolder folder_;
  std::map<Args, std::string> known_;
};

/// Those of the surface that solve_options has.
Trials solve_trials() {
  return {{"--depth", {{"--depth", "6"}, {"--depth", "5"}}},
          {"--screening", {{"--screening", "9"}}},
          {"--iterations", {{"--iterations", "1"}}},
          {"--scale", {{"--scale", "1.4"}}},
          {"--samples-per-node", {{"--samples-per-node", "20"}}},
          {"--fixed-screening", {{"--fixed-screening"}}},
          {"--linear-fit", {{"--linear-fit"}}},
          {"--boundary", {{"--boundary", "dirichlet"}}},
          {"--keep-strays", {{"--keep-strays"}}},
          {"--no-normals", {{"--no-normals"}}},
          {"--shift", {{"--shift", "1000,2000,3000"}}},
          {"--threads", {{"--threads", "-1"}, {}, true}},
          {"--device", {{"--device", "quantum"}, {}, true}},
          {"--quiet", {{"-q"}}}};
}

/// Those that reconstruct, edit and deform have.
Trials fit_trials() {
  Trials trials = solve_trials();
  trials.insert({{"--field", {{"--field", "distance"}}},
                 {"--confidence", {{"--confidence"}}},
                 {"--open", {{"--open", "--scale", "1"}, {"--scale", "1"}}},
                 {"--envelope", {{"--envelope", "hull.off"}}},
                 {"--offset", {{"--offset", "0.2"}}},
                 {"--trim", {{"--trim", "0.1"}}},
                 // what stays is less than nine tenths, and so an island itself
                 {"--island-ratio", {{"--trim", "0.3", "--island-ratio", "0.9"}, {"--trim", "0.3"}, true}},
                 {"--largest", {{"apart.ply", "--largest"}, {"apart.ply"}}},
                 {"--min-component", {{"apart.ply", "--min-component", "0.4"}, {"apart.ply"}}},
                 {"--density", {{"--density"}}},
                 {"--weakness", {{"--weakness"}}},
                 {"--keep-attributes", {{"--keep-attributes"}}},
                 {"--report", {{"--report", "r.json"}}}});
  return trials;
}

/// Those of reconstruct and problems.
Trials reconstruct_trials() {
  Trials trials = fit_trials();
  trials.insert({{"--output", {{"-o", "a.ply", "--repeat", "1"}, {"--repeat", "1"}}},
                 {"--overwrite", {{"-o", "scan.ply", "--overwrite"}, {"-o", "scan.ply"}}},
                 {"--ascii", {{"--ascii"}}},
                 {"--normals", {{"--normals", "repair"}}},
                 {"--estimate-normals", {{"--estimate-normals"}}},
                 {"--sensor", {{"--estimate-normals", "--sensor", "0,0,0"}, {"--estimate-normals"}}},
                 {"--keep-within", {{"--estimate-normals", "--keep-within", "1"}, {"--estimate-normals"}}},
                 {"--max-rounds", {{"--estimate-normals", "--max-rounds", "0"}, {"--estimate-normals"}, true}},
                 {"--time-limit", {{"--estimate-normals", "--time-limit", "-1"}, {"--estimate-normals"}, true}},
                 {"--random-start",
                  {{"--estimate-normals=iterate", "--random-start", "--report", "r.json"},
                   {"--estimate-normals=iterate", "--report", "r.json"}}},
                 {"--seed",
                  {{"--estimate-normals=iterate", "--random-start", "--seed", "5", "--report", "r.json"},
                   {"--estimate-normals=iterate", "--random-start", "--report", "r.json"}}},
                 {"--max-memory", {{"--max-memory", "1"}, {}, true}},
                 {"--temp", {{"--temp", "nowhere"}, {}, true}},
                 {"--split", {{"--split"}, {}, true}},
                 {"--dry-run", {{"--dry-run"}}},
                 {"--repeat", {{"--repeat", "2", "--report", "r.json"}, {"--report", "r.json"}}},
                 {"--verbose", {{"-v", "--report", "r.json"}, {"-q", "--report", "r.json"}}},
                 {"--in", {{"--in", "whole.ply"}}},
                 {"--out", {{"--out", "a.ply", "--repeat", "1"}, {"--repeat", "1"}}},
                 {"--pointWeight", {{"--pointWeight", "9"}}},
                 {"--samplesPerNode", {{"--samplesPerNode", "20"}}},
                 {"--iters", {{"--iters", "1"}}},
                 {"--linearFit", {{"--linearFit"}}},
                 {"--bType", {{"--bType", "2"}}},
                 {"--width", {{"--width", "0.5"}}},
                 {"--colors", {{"--colors"}}},
                 {"--data", {{"--data"}}},
                 {"--maxMemory", {{"--maxMemory", "0.00001"}, {}, true}},
                 {"--showResidual", {{"--showResidual"}, {"-q"}}}});
  return trials;
}

/// Puts `first` and a depth before what is tried, but for those trials in `whole`, which have all that they need.
Trials behind(const Args& first, Trials trials, const std::set<std::string>& whole) {
  for (auto& [name, trial] : trials) {
    for (Args* args : {&trial.before, &trial.after}) {
      if (name != "--depth" && name != "--width") args->insert(args->begin(), {"--depth", "5"});
      if (!whole.contains(name)) args->insert(args->begin(), first.begin(), first.end());
    }
  }
  return trials;
}

const std::set<std::string> kOutputs = {"--output", "--out", "--overwrite", "--each", "--script", "--op", "--frames"};

TEST_F(HelpOptions, OfReconstruct) {
  Trials trials = reconstruct_trials();
  trials.insert({"--each", {{"--each", "-o", "{}_mesh.ply"}, {"-o", "out.ply"}}});
  try_all("reconstruct", {"reconstruct", "scan.ply"}, behind({"-o", "out.ply"}, trials, kOutputs));
}

TEST_F(HelpOptions, OfProblems) {
  Trials trials = reconstruct_trials();
  for (const char* name : {"--field", "--offset", "--weakness"}) trials.erase(name);
  trials.insert({{"--pictures", {{"--pictures", "."}}},
                 {"--pictures-most", {{"--pictures", ".", "--pictures-most", "0"}, {"--pictures", "."}, true}},
                 {"--up", {{"--up", "z"}}}});
  try_all("problems", {"problems", "scan.ply"}, behind({"-o", "out.ply"}, trials, kOutputs));
}

TEST_F(HelpOptions, OfEdit) {
  Trials trials = fit_trials();
  trials.erase("--offset");
  trials.insert({{"--script", {{"--script", "none.json", "-o", "out.ply"}, {"--script", "ops.json", "-o", "out.ply"}}},
                 {"--output", {{"--script", "ops.json", "-o", "a.ply"}, {"--script", "ops.json"}}},
                 {"--cloud", {{"--cloud", "c.ply"}}},
                 {"--save", {{"--save", "s.json"}}},
                 {"--overwrite",
                  {{"--script", "ops.json", "--save", "ops.json", "--overwrite"},
                   {"--script", "ops.json", "--save", "ops.json"}}},
                 {"--max-memory", {{"--max-memory", "1"}, {}, true}},
                 {"--cold", {{"--cold", "--iterations", "3"}, {"--iterations", "3"}}}});
  try_all("edit", {"edit", "scan.ply"}, behind({"--script", "ops.json", "-o", "out.ply"}, trials, kOutputs));
}

TEST_F(HelpOptions, OfDeform) {
  const Args bend = {"--script", "bend.json", "-o", "out.ply"};
  Trials trials = fit_trials();
  trials.insert(
      {{"--script", {{"--script", "hold.json", "-o", "out.ply"}, bend}},
       {"--output", {{"--script", "bend.json", "-o", "a.ply"}, {"--script", "bend.json", "--cloud", "c.ply"}}},
       {"--cloud", {{"--cloud", "c.ply"}}},
       {"--max-memory", {{"--max-memory", "1"}, {}, true}},
       {"--overwrite",
        {{"--script", "bend.json", "-o", "scan.ply", "--overwrite"}, {"--script", "bend.json", "-o", "scan.ply"}}},
       {"--frames",
        {{"--script", "bend.json", "-o", "m_{}.ply", "--frames", "2"}, {"--script", "bend.json", "-o", "m_{}.ply"}}}});
  try_all("deform", {"deform", "scan.ply"}, behind(bend, trials, kOutputs));
}

TEST_F(HelpOptions, OfBoolean) {
  const Args unite = {"--op", "union", "-o", "out.ply"};
  Trials trials = solve_trials();
  trials.insert(
      {{"--op", {{"--op", "intersection", "-o", "out.ply"}, unite}},
       {"--output", {{"--op", "union", "-o", "a.ply"}, unite}},
       {"--overwrite", {{"--op", "union", "-o", "whole.ply", "--overwrite"}, {"--op", "union", "-o", "whole.ply"}}},
       {"--cloud", {{"--cloud", "c.ply"}}},
       {"--report", {{"--report", "r.json"}}},
       {"--creases", {{"--creases", "none"}}},
       {"--coincidence", {{"--coincidence", "20"}}}});
  try_all("boolean", {"boolean", "whole.ply", "stray.ply"}, behind(unite, trials, kOutputs));
}

TEST_F(HelpOptions, OfFluid) {
  const Args file = {"p_1.xyz", "-o", "out.ply", "-r", "0.08"};
  const Args sequence = {"p_{}.xyz", "-o", "m_{}.ply", "-r", "0.08"};
  const Args scene = {"--simulate", "drop", "--particles", "400", "--frames", "3", "-o", "m_{}.ply"};
  const auto with = [](Args args, const Args& more) {
    args.insert(args.end(), more.begin(), more.end());
    return args;
  };
  const auto on = [&with](const Args& base, const Args& more) { return Trial{with(base, more), base}; };
  const auto refused = [&with](const Args& base, const Args& more) { return Trial{with(base, more), base, true}; };
  const Args slow = {"--simulate", "drop", "--particles", "400", "-o", "m_{}.ply"};
  const Trials trials = {
      {"--output", {{"p_1.xyz", "-o", "a.ply", "-r", "0.08"}, file}},
      {"--first", on(sequence, {"--first", "2"})},
      {"--last", on(sequence, {"--last", "2"})},
      {"--report", on(file, {"--report", "r.json"})},
      {"--overwrite",
       {{"p_1.ply", "-o", "p_1.ply", "-r", "0.08", "--overwrite"}, {"p_1.ply", "-o", "p_1.ply", "-r", "0.08"}}},
      {"--shift", on(file, {"--shift", "1000,2000,3000"})},
      {"--particle-radius", {{"p_1.xyz", "-o", "out.ply", "-r", "0.1"}, file}},
      {"--cube-size", on(file, {"-c", "0.7"})},
      {"--smoothing-length", on(file, {"-l", "3"})},
      {"--kernel", on(file, {"--kernel", "anisotropic"})},
      {"--surface-threshold", on(file, {"-t", "0.8"})},
      {"--no-attributes", on(file, {"--no-attributes"})},
      {"--no-normals", on(file, {"--no-normals"})},
      {"--mesh-smoothing-iters", on(file, {"--mesh-smoothing-iters", "3"})},
      {"--no-smoothing-weights", on(with(file, {"--mesh-smoothing-iters", "5"}), {"--no-smoothing-weights"})},
      {"--min-component", on(file, {"--min-component", "20"})},
      {"--simulate", {{"--simulate", "stir", "--particles", "400", "--frames", "3", "-o", "m_{}.ply"}, scene}},
      {"--frames", {with(slow, {"--frames", "2"}), with(slow, {"--frames", "3"})}},
      {"--particles", {{"--simulate", "drop", "--particles", "500", "--frames", "3", "-o", "m_{}.ply"}, scene}},
      {"--fps", on(scene, {"--fps", "20"})},
      {"--iterations", on(scene, {"--iterations", "1"})},
      {"--viscosity", on(scene, {"--viscosity", "0.5"})},
      {"--vorticity", on(scene, {"--vorticity", "5"})},
      {"--particles-out", on(scene, {"--particles-out", "q_{}.ply"})},
      {"--at-once", on(with(sequence, {"--threads", "2", "--report", "r.json"}), {"--at-once", "1"})},
      {"--max-memory", on(with(sequence, {"--threads", "2", "--report", "r.json"}), {"--max-memory", "1"})},
      {"--threads", refused(file, {"--threads", "-1"})},
      {"--device", refused(file, {"--device", "quantum"})},
      {"--quiet", on(file, {"-q"})}};
  std::filesystem::copy(folder_ / "p_1.xyz", folder_ / "p_1.ply");
  write_file(folder_ / "p_1.ply", ply_bytes(sphere(150), false));
  try_all("fluid", {"fluid"}, trials);
}

}  // namespace
}  // namespace pointskin::test
