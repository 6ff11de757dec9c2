// pointskin compare: how far apart two meshes are.
#include <memory>
#include <string>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "json_text.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

struct CompareArgs {
  std::string mesh, reference;
  CompareOptions options;
  bool json = false;
};

Json distances_json(const DistanceStatistics& d, double diagonal) {
  const double to_percent = 100 / diagonal;
  return {{"mean", d.mean},
          {"rms", d.rms},
          {"p95", d.p95},
          {"max", d.max},
          {"mean_percent", d.mean * to_percent},
          {"rms_percent", d.rms * to_percent},
          {"p95_percent", d.p95 * to_percent},
          {"max_percent", d.max * to_percent}};
}

Json to_json(const CompareArgs& args, const MeshComparison& c) {
  return {{"version", 1},
          {"command", "compare"},
          {"mesh", args.mesh},
          {"reference", args.reference},
          {"samples", args.options.samples},
          {"tau", args.options.tau},
          {"reference_diagonal", c.reference_diagonal},
          {"to_reference", distances_json(c.to_reference, c.reference_diagonal)},
          {"from_reference", distances_json(c.from_reference, c.reference_diagonal)},
          {"two_sided", distances_json(c.two_sided, c.reference_diagonal)},
          {"normal_consistency", c.normal_consistency},
          {"precision", c.precision},
          {"recall", c.recall},
          {"f_score", c.f_score}};
}

std::string distances_text(const char* name, const DistanceStatistics& d, double diagonal) {
  const auto cell = [diagonal](double distance) {
    return fmt::format("{:>22}", fmt::format("{:.4g} ({:.4f} %)", distance, 100 * distance / diagonal));
  };
  return fmt::format("{:<16}{}{}{}{}\n", name, cell(d.mean), cell(d.rms), cell(d.p95), cell(d.max));
}

std::string human_text(const CompareArgs& args, const MeshComparison& c) {
  std::string text =
      fmt::format("distances in world units (in % of the reference's diagonal, {:.6g})\n", c.reference_diagonal);
  text += fmt::format("{:<16}{:>22}{:>22}{:>22}{:>22}\n", "", "mean", "rms", "p95", "max");
  text += distances_text("to reference", c.to_reference, c.reference_diagonal);
  text += distances_text("from reference", c.from_reference, c.reference_diagonal);
  text += distances_text("two-sided", c.two_sided, c.reference_diagonal);
  text += fmt::format("normal consistency  {:.5f}\n", c.normal_consistency);
  return text +
         fmt::format("F-score             {:.5f} (precision {:.5f}, recall {:.5f}; within {:g} of the diagonal)\n",
                     c.f_score, c.precision, c.recall, args.options.tau);
}

int run(const CompareArgs& args) {
  check_threads(args.options.threads);
  if (args.options.samples < 1) throw Error(ErrorCode::usage, "--samples: must be at least 1");
  if (!(args.options.tau > 0)) throw Error(ErrorCode::usage, "--tau: must be above 0");
  const ReadOptions read{.shift = std::nullopt, .threads = args.options.threads};
  const Mesh mesh = read_mesh(args.mesh, read);
  const MeshComparison comparison = compare(mesh, read_mesh(args.reference, read), args.options);
  write_stdout(args.json ? json_text(to_json(args, comparison)) : human_text(args, comparison));
  return 0;
}

}  // namespace

void add_compare(CLI::App& program, Job& job) {
  CLI::App* command = add_command(program, "compare", "Measure how far a mesh is from a reference mesh, both ways.");
  auto args = std::make_shared<CompareArgs>();
  command->add_option("MESH", args->mesh, "mesh: PLY, OBJ, STL or OFF")->required();
  command->add_option("REF", args->reference, "reference mesh")->required();
  command->add_option("--tau", args->options.tau, "F-score threshold, as a fraction of REF's diagonal")
      ->type_name("F")
      ->group("Measure")
      ->capture_default_str();
  command->add_option("--samples", args->options.samples, "samples on each mesh")
      ->type_name("N")
      ->group("Measure")
      ->capture_default_str();
  command->add_flag("--json", args->json, "print JSON")->group("Output");
  add_threads_option(*command, args->options.threads, "Limits");
  finish_command(*command, job, args, run);
}

}  // namespace pointskin::cli
