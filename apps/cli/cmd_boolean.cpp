// pointskin boolean: the union, intersection or difference of two solids.
#include <filesystem>
#include <variant>
#include <vector>

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "boolean_args.hpp"
#include "boolean_report.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "run_memory.hpp"
#include "signals.hpp"
#include "stopwatch.hpp"
#include "summary_words.hpp"
#include "unused_options.hpp"

namespace pointskin::cli {
namespace {

using Solid = std::variant<Cloud, Mesh>;

/// Everything that can be found wrong before the inputs are opened.
void check_files(const BooleanArgs& args) {
  check_distinct(
      {args.a, args.b},
      {{"-o", args.output}, {"--cloud", args.cloud, OutputKind::file}, {"--report", args.report, OutputKind::report}},
      args.overwrite);
  check_mesh_output(args.output);
  if (!args.cloud.empty()) check_cloud_name(args.cloud, "--cloud: {} does not end in {}");
  for (const std::string& file : {args.cloud, args.report})
    if (!file.empty()) check_replaceable(file);
}

/// Reads A or B, and cleans a cloud. @param dropped  receives how many points were left out
Solid read_solid(const std::string& path, const BooleanArgs& args, std::int64_t& dropped) {
  Solid solid = read_cloud_or_mesh(path, {.shift = parse_shift(args.shift), .threads = args.threads});
  Cloud* const cloud = std::get_if<Cloud>(&solid);
  if (cloud == nullptr) return solid;
  const std::string name = path == "-" ? "stdin" : path;
  if (cloud->positions.empty())
    throw Error(cloud->dropped == 0 ? ErrorCode::empty_result : ErrorCode::invalid_input,
                fmt::format("{}: holds no points with finite coordinates of at most 1e38", name));
  if (!cloud->has_normals())
    throw Error(ErrorCode::no_normals, fmt::format("{}: has no normals; it needs outward normals nx, ny, nz", name));
  drop_unusable(*cloud, name + ": ");
  cloud->attributes.clear();
  dropped = cloud->dropped;
  return solid;
}

BooleanOperand operand_of(const Solid& solid) {
  if (const auto* cloud = std::get_if<Cloud>(&solid)) return *cloud;
  return std::get<Mesh>(solid);
}

void warn_about_strays_of(const char* name, const BooleanPart& part) {
  if (part.strays > 0)
    print_warning(fmt::format("{}: {} stray points far from all others are left out; use --keep-strays to keep them",
                              name, part.strays));
}

BooleanResult compute(const BooleanArgs& args, const Solid& a, const Solid& b, BooleanRecord& record) {
  Booleans booleans(record.device);
  ProgressLine line(!args.quiet && stderr_is_terminal());
  BooleanOptions options = record.options;
  options.reconstruction.progress = [&line](const Progress& progress) {
    line.update(progress);
    return !interrupted();
  };
  BooleanResult result = booleans.combine(operand_of(a), operand_of(b), args.op, options);
  line.clear();
  record.run = result.report;
  warn_about_strays_of("A", record.run.a);
  warn_about_strays_of("B", record.run.b);
  for (const Warning& warning : record.run.result.warnings) print_warning(warning.text);
  return result;
}

void write_outputs(const BooleanArgs& args, const BooleanResult& result, BooleanRecord& record) {
  throw_if_interrupted();
  const Stopwatch watch;
  if (!args.cloud.empty()) {
    write_cloud(args.cloud, result.cloud, args.threads);
    file_was_written();
  }
  write_mesh(args.output, result.mesh, args.threads);
  file_was_written();
  if (args.report.empty()) ignore_interrupts();
  record.write_ms = watch.ms();
}

int run(const BooleanArgs& args) {
  const Stopwatch watch;
  BooleanRecord record;
  record.options = library_options(args);
  parse_shift(args.shift);
  check_files(args);
  record.device = args.chosen();
  warn_about_unused(args.given, record.options.reconstruction, args.output, false);

  Solid a = read_solid(args.a, args, record.a_dropped);
  Solid b = read_solid(args.b, args, record.b_dropped);
  record.a_is_mesh = std::holds_alternative<Mesh>(a);
  record.b_is_mesh = std::holds_alternative<Mesh>(b);
  record.read_ms = watch.ms();

  on_interrupt(OnInterrupt::remember);
  const BooleanResult result = compute(args, a, b, record);
  write_outputs(args, result, record);
  record.total_ms = watch.ms();
  record.host_peak_bytes = host_peak_bytes();
  record.mesh.triangles = static_cast<std::int64_t>(result.mesh.triangles.size());
  if (!args.quiet) record.shape = shape_words(result.mesh, args.threads);
  if (!args.report.empty()) {
    record.op = word_of(args.op);
    record.shown_options = report_of(boolean_options, args);
    record.files = {{"a", args.a}, {"b", args.b}, {"output", args.output}, {"cloud", or_null(args.cloud)}};
    record.mesh = measure(result.mesh, args.threads);
    record.shape = shape_words(record.mesh);
    write_file_atomically(args.report, json_text(to_json(record)));
  }
  if (!args.quiet) print_note(file_words(args.output) + summary(record));
  return 0;
}

}  // namespace

Command boolean_command() {
  return make_command({"boolean", "Unite, intersect or subtract two solids given by points or meshes."},
                      boolean_options, run);
}

}  // namespace pointskin::cli
