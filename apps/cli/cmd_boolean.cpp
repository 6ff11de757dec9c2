// pointskin boolean: the union, intersection or difference of two solids.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
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
#include "input.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "signals.hpp"

namespace pointskin::cli {
namespace {

class Stopwatch {
 public:
  /// Milliseconds since construction.
  [[nodiscard]] double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

using Solid = std::variant<Cloud, Mesh>;

[[noreturn]] void throw_usage(const std::string& story) { throw Error(ErrorCode::usage, story); }

/// Everything that can be found wrong before the inputs are opened.
void check_files(const BooleanArgs& args) {
  if (args.a == "-" && args.b == "-") throw_usage("stdin (-) can be read only once");
  std::vector<std::pair<std::string, std::string>> outputs = {{"-o", args.output}};
  for (const auto& [name, file] : {std::pair{"--cloud", args.cloud}, std::pair{"--report", args.report}}) {
    if (file == "-") throw_usage(fmt::format("{}: stdout carries the mesh only; name a file", name));
    if (!file.empty()) outputs.emplace_back(name, file);
  }
  for (std::size_t i = 0; i < outputs.size(); ++i) {
    const auto& [name, file] = outputs[i];
    for (std::size_t j = 0; j < i; ++j)
      if (file == outputs[j].second) throw_usage(fmt::format("{} and {} name the same file", outputs[j].first, name));
    for (const std::string& input : {args.a, args.b}) {
      std::error_code ignored;  // files that do not exist are not the same
      if (i > 0 && std::filesystem::equivalent(input, file, ignored))
        throw_usage(fmt::format("{} would overwrite the input {}", name, input));
    }
  }
  check_mesh_output(args.output);
  if (!args.cloud.empty() && !has_extension(args.cloud, ".ply"))
    throw_usage(fmt::format("--cloud: {} does not end in .ply", args.cloud));
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
                fmt::format("{}: holds no points with finite coordinates", name));
  if (!cloud->has_normals())
    throw Error(ErrorCode::no_normals, fmt::format("{}: has no normals; it needs outward normals nx, ny, nz", name));
  const std::int64_t not_finite = cloud->dropped;
  const std::int64_t no_normal = drop_zero_normals(*cloud);
  if (not_finite > 0)
    print_warning(fmt::format("{}: {} points were dropped: a coordinate is not finite", name, not_finite));
  if (no_normal > 0)
    print_warning(fmt::format("{}: {} points were dropped: their normal has zero length", name, no_normal));
  cloud->attributes.clear();
  dropped = cloud->dropped;
  return solid;
}

BooleanOperand operand_of(const Solid& solid) {
  if (const auto* cloud = std::get_if<Cloud>(&solid)) return *cloud;
  return std::get<Mesh>(solid);
}

void warn_about_strays(const char* name, const BooleanPart& part) {
  if (part.strays > 0)
    print_warning(fmt::format("{}: {} stray points far from all others are left out; use --keep-strays to keep them",
                              name, part.strays));
}

BooleanResult compute(const BooleanArgs& args, const Solid& a, const Solid& b, BooleanOp op, BooleanRecord& record) {
  Booleans booleans(record.device);
  ProgressLine line(!args.quiet && stderr_is_terminal());
  BooleanOptions options = record.options;
  options.reconstruction.progress = [&line](const Progress& progress) {
    line.update(progress);
    return !interrupted();
  };
  BooleanResult result = booleans.combine(operand_of(a), operand_of(b), op, options);
  line.clear();
  record.run = result.report;
  warn_about_strays("A", record.run.a);
  warn_about_strays("B", record.run.b);
  return result;
}

void write_outputs(const BooleanArgs& args, const BooleanResult& result, BooleanRecord& record) {
  throw_if_interrupted();
  const Stopwatch watch;
  if (!args.cloud.empty()) write_cloud(args.cloud, result.cloud, args.threads);
  write_mesh(args.output, result.mesh, args.threads);
  record.write_ms = watch.ms();
}

int run(const BooleanArgs& args) {
  const Stopwatch watch;
  BooleanRecord record;
  record.options = library_options(args);
  record.op = args.op;
  const BooleanOp op = operation_of(args.op);
  parse_shift(args.shift);
  check_files(args);
  record.device = parse_device(args.device, args.threads);

  Solid a = read_solid(args.a, args, record.a_dropped);
  Solid b = read_solid(args.b, args, record.b_dropped);
  record.a_is_mesh = std::holds_alternative<Mesh>(a);
  record.b_is_mesh = std::holds_alternative<Mesh>(b);
  record.read_ms = watch.ms();

  on_interrupt(OnInterrupt::remember);
  const BooleanResult result = compute(args, a, b, op, record);
  write_outputs(args, result, record);
  record.total_ms = watch.ms();
  record.host_peak_bytes = host_peak_bytes();
  record.mesh.triangles = static_cast<std::int64_t>(result.mesh.triangles.size());
  if (!args.report.empty()) {
    const auto named = [](const std::string& file) {
      return file.empty() ? nlohmann::ordered_json(nullptr) : nlohmann::ordered_json(file);
    };
    record.files = {{"a", args.a}, {"b", args.b}, {"output", args.output}, {"cloud", named(args.cloud)}};
    record.mesh = measure(result.mesh, args.threads);
    write_file_atomically(args.report, json_text(to_json(record)));
  }
  if (!args.quiet) print_note(summary(record));
  return 0;
}

}  // namespace

void add_boolean(CLI::App& program, Job& job) {
  CLI::App* command =
      add_command(program, "boolean", "Unite, intersect or subtract two solids given by points or meshes.");
  auto args = std::make_shared<BooleanArgs>();
  define_boolean_options(*command, *args);
  finish_command(*command, job, args, run);
}

}  // namespace pointskin::cli
