// pointskin reconstruct: oriented clouds in, mesh out. pointskin problems: the same, and where to look.
#include <filesystem>
#include <memory>
#include <string>
#include <system_error>
#include <vector>

#include <fmt/format.h>

#include <pointskin/reconstruct.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "output_check.hpp"
#include "ranks.hpp"
#include "reconstruct_args.hpp"
#include "reconstruct_blocks.hpp"
#include "reconstruct_each.hpp"
#include "reconstruct_run.hpp"
#include "report.hpp"
#include "spooled_input.hpp"
#include "stopwatch.hpp"
#include "summary_words.hpp"
#include "unused_options.hpp"

namespace pointskin::cli {
namespace {

/// True if a file may be one of those that --split writes.
bool is_a_split_output(const std::string& file, const std::string& output) {
  const std::filesystem::path path(file), named(output);
  std::error_code error;
  const std::string begin = named.stem().string() + "_", stem = path.stem().string();
  const auto folder_of = [&](const std::filesystem::path& of) {
    return std::filesystem::weakly_canonical(std::filesystem::absolute(of, error).parent_path(), error);
  };
  return path.extension() == named.extension() && stem.starts_with(begin) && stem.size() > begin.size() &&
         stem.find_first_not_of("0123456789", begin.size()) == std::string::npos && folder_of(path) == folder_of(named);
}

void check_split(const ReconstructArgs& args) {
  if (args.options.max_memory_bytes == 0 && !is_one_of_ranks())
    throw_usage("--split needs --max-memory: blocks are what it holds");
  if (!args.report.empty()) throw_usage("--split and --report exclude each other: a report measures one mesh");
  if (!is_one_of_ranks() && !may_work_in_blocks(args))
    throw_usage("--split needs text, binary PLY or NPY as input, .ply as output, and a depth of at least 7");
  for (const std::string& input : args.inputs)
    if (is_a_split_output(input, args.output))
      throw_usage(fmt::format("{}: --split with -o {} may write this file", input, args.output));
}

/// Everything that can be found wrong before the input is opened.
void check_files(const ReconstructArgs& args) {
  if (args.inputs.empty()) throw_usage("no input; name one or more clouds, or - for stdin");
  if (args.output.empty() && !args.dry_run && !args.given.has("--repeat") && !args.problems)
    throw_usage("no output; name it with -o");
  std::vector<std::string> inputs = args.inputs;
  if (!args.envelope.empty()) inputs.push_back(args.envelope);
  check_distinct(inputs, {{"-o", args.output}, {"--report", args.report, OutputKind::report}}, args.overwrite);
  if (!args.output.empty()) check_mesh_output(args.output);
  if (!args.report.empty()) check_replaceable(args.report);
  check_problem_pictures(args.pictures);
  if (is_one_of_ranks()) check_ranks(args);
  if (args.split) check_split(args);
  if (!args.temp.empty() && !std::filesystem::is_directory(args.temp))
    throw_usage(fmt::format("--temp {}: is no folder", args.temp));
}

void warn_about_options(const ReconstructArgs& args, const Options& options) {
  if (args.given.has("--depth") && args.given.has("--width"))
    print_warning("--depth is ignored because --width chooses the depth");
  warn_about_unused(args.given, options, mesh_file(args), !args.report.empty());
  if (options.max_memory_bytes == 0 && !is_one_of_ranks()) warn_unused(args.given, {"--temp"}, "without --max-memory");
  warn_about_ascii(args.given, args.output);
  if (mesh_file(args).empty())
    warn_unused(args.given, {"--no-normals", "--density", "--keep-attributes", "--colors", "--data", "--ascii"},
                kNoMesh);
  if (options.point_normals == PointNormals::given) warn_about_unused_normals(args.given);
  warn_about_poisson_recon(args.given, args.poisson_recon_data);
}

int run(const ReconstructArgs& given) {
  const Stopwatch watch;
  (void)launched_ranks();  // so that what one finds wrong ends all
  ReconstructArgs args = given;
  args.inputs.insert(args.inputs.end(), args.named_inputs.begin(), args.named_inputs.end());
  const Options options = library_options(args);
  parse_shift(args.shift);
  if (args.each && !is_one_of_ranks())
    check_each(args);
  else
    check_files(args);
  // What is wrong is said before files are read; no driver is asked where the CPU may do.
  (void)(args.leaves_device_open() ? parse_device("cpu", args.threads) : args.chosen());
  warn_about_options(args, options);
  if (args.each) return reconstruct_each(args);
  if (may_work_in_blocks(args) && comes_through_pipe(args))
    args.inputs.front() = spool_pipe(args.inputs.front(), args.temp);

  std::unique_ptr<Reconstructor> reconstructor;
  const Record record = run_reconstruction(args, watch, reconstructor);
  if (args.dry_run) return 0;
  if (args.problems && args.output == "-") print_note(problem_table(record.problems));
  if (args.problems && args.output != "-") write_stdout(problem_table(record.problems) + "\n");
  if (args.verbose) print_note(level_table(record));
  if (!args.quiet) print_note(file_words(args.output) + summary(record));
  return 0;
}

}  // namespace

Command problems_command() {
  const auto args = std::make_shared<ReconstructArgs>();
  args->problems = true;
  return make_command({"problems", "Reconstruct, and list where the topology of the result is doubtful."},
                      reconstruct_options, run, args);
}

Command reconstruct_command() {
  return make_command({"reconstruct", "Fit a watertight mesh to oriented points."}, reconstruct_options, run);
}

}  // namespace pointskin::cli
