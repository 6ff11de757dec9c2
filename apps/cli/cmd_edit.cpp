// pointskin edit: a cloud and a script of strokes, removals and copied parts in, mesh and what every step did out.

#include <fmt/format.h>

#include <pointskin/edit.hpp>
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "edit_script.hpp"
#include "file_plan.hpp"
#include "fit_args.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "report.hpp"
#include "run_memory.hpp"
#include "signals.hpp"
#include "stopwatch.hpp"
#include "summary_words.hpp"
#include "unused_options.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

struct EditArgs : FitArgs, DeviceArgs {
  std::vector<std::string> inputs;
  std::string script;
  std::string output, save, cloud, report;  ///< empty: none
  std::string shift = "auto";
  bool overwrite = false, warm_start = true, quiet = false;
  GivenOptions given;
};

OptionGroup file_options(EditArgs& args) {
  const OptionRules named = {.check = needs_a_name};
  return {"Files",
          {clouds_row(args.inputs),
           option("--script FILE", "operations, as JSON", &args.script, {"script", 61, kNeverNull},
                  {.required = true, .check = needs_a_name}),
           output_row(args.output, named),
           option("--cloud FILE", "write the edited points, with the property added, as PLY", &args.cloud,
                  {"cloud", 63}, named),
           option("--save FILE", "write the operations that are done, as a script", &args.save, {"save", 64}, named),
           report_row(args.report, "write what every step did as JSON"), overwrite_row(args.overwrite),
           shift_row(args.shift)}};
}

OptionTable edit_options(EditArgs& args) {
  return {file_options(args),
          fit_options(args).without({"--offset"}),  // a session has none
          device_options(args),
          {kSurfaceGroup,
           {option("--cold", "solve every surface anew, instead of from the one before", negated(args.warm_start),
                   {"warm_start", 24})}},
          quiet_option(args.quiet)};
}

/// @param parts  files that the script names
void check_names(const EditArgs& args, const std::vector<std::string>& parts) {
  std::vector<std::string> inputs = args.inputs;
  inputs.insert(inputs.end(), {args.script, args.envelope});
  inputs.insert(inputs.end(), parts.begin(), parts.end());
  check_distinct(inputs,
                 {{"-o", args.output},
                  {"--save", args.save, OutputKind::file},
                  {"--cloud", args.cloud, OutputKind::file},
                  {"--report", args.report, OutputKind::report}},
                 args.overwrite);
}

/// Everything that can be found wrong before an input is opened.
void check_outputs(const EditArgs& args) {
  check_names(args, {});
  if (!args.output.empty()) check_mesh_output(args.output);
  if (!args.cloud.empty()) check_cloud_name(args.cloud, "--cloud: {}: clouds are written as {} only");
  for (const std::string& path : {args.save, args.cloud, args.report})
    if (!path.empty()) check_replaceable(path);
}

Json topology_json(const Topology& topology) {
  return {{"components", topology.components}, {"genus", topology.genus}, {"euler", topology.euler}};
}

Json step_json(const StepReport& step) {
  return {{"operation", step.operation},
          {"added", step.added},
          {"removed", step.removed},
          {"flipped", step.flipped},
          {"points", step.points},
          {"triangles", step.triangles},
          {"snapped", step.snapped},
          {"warm", step.warm},
          {"before", topology_json(step.before)},
          {"after", topology_json(step.after)},
          {"ms", {{"edit", step.edit_ms}, {"reconstruct", step.reconstruct_ms}, {"total", step.total_ms}}}};
}

/// What every step did, and the mesh in the end.
void describe(const EditSession& session, const EditArgs& args, Json& json) {
  Json steps = Json::array();
  for (const StepReport& step : session.steps()) steps.push_back(step_json(step));
  json["steps"] = steps;
  json["mesh"] = to_json(measure(session.mesh(), args.threads));
}

std::string line_of(const StepReport& step, std::size_t number) {
  const std::string flipped = step.flipped > 0 ? fmt::format(", {} turned", step.flipped) : "";
  return fmt::format("{}: {}: {} points added, {} removed{}; components {} -> {}, genus {} -> {}; {:.1f} ms", number,
                     step.operation, step.added, step.removed, flipped, step.before.components, step.after.components,
                     step.before.genus, step.after.genus, step.total_ms);
}

/// Operations that were done and left the points as they were.
void warn_if_nothing(const StepReport& step, std::size_t number, const EditArgs& args) {
  if (step.added == 0 && step.removed == 0 && step.flipped == 0)
    print_warning(fmt::format("operations[{}] of {}: the {} changes no point", number, args.script, step.operation));
}

void run_script(const EditScript& script, const EditArgs& args, EditSession& session) {
  const auto camera_of_picture = [&session](const RenderOptions& options) {
    return camera_of(session.mesh(), options);
  };
  if (script.size() == 0) print_warning(fmt::format("{}: has no operations", args.script));
  for (std::size_t i = 0; i < script.size(); ++i) {
    throw_if_interrupted();
    const ScriptStep step = script.step(i, camera_of_picture);
    try {
      if (step.kind == ScriptStep::Kind::apply) session.apply(step.operation);
      if (step.kind == ScriptStep::Kind::undo && !session.undo()) throw_usage("there is nothing to undo");
      if (step.kind == ScriptStep::Kind::redo && !session.redo()) throw_usage("there is nothing to redo");
    } catch (const Error& error) {
      throw error.while_doing(fmt::format("running operations[{}] of {}", i, args.script));
    }
    if (step.kind != ScriptStep::Kind::apply) continue;
    const StepReport done = session.steps().back();
    if (!args.quiet) print_note(line_of(done, i));
    warn_if_nothing(done, i, args);
  }
}

void warn_about_options(const EditArgs& args, const Options& options) {
  warn_about_unused(args.given, options, args.output, false);
  if (!args.output.empty()) return;
  warn_unused(args.given, {"--no-normals", "--density", "--weakness"}, kNoMesh);
  if (args.cloud.empty()) warn_unused(args.given, {"--keep-attributes"}, "where neither mesh nor cloud is written");
}

/// Reads, merges and cleans the inputs, and says what is left out.
Cloud read_base(const EditArgs& args, const Options& options) {
  Cloud base = read_clouds(args.inputs, {.shift = parse_shift(args.shift), .threads = args.threads});
  drop_unusable(base);
  warn_about_unused(args.given, options, base, args.output);
  if (!options.keep_strays) warn_about_strays(base, args.threads);
  if (options.envelope != nullptr)  // the session does not tell how many are outside
    warn_about_envelope({.samples_outside = count_outside_box(base, *options.envelope)}, base.size());
  return base;
}

std::string summary(const EditSession& session, const EditArgs& args, double total_ms) {
  const Mesh& mesh = session.mesh();
  const std::string file = args.output.empty() ? args.cloud : args.output;
  return fmt::format("{}operations {}, triangles {}, {}; ms: total {:.1f}; memory {} host", file_words(file),
                     session.steps().size(), mesh.triangles.size(), shape_words(mesh, args.threads), total_ms,
                     format_bytes(static_cast<double>(host_peak_bytes())));
}

int run(const EditArgs& args) {
  const Stopwatch watch;
  EditOptions options;
  options.reconstruction = args.options;
  validate(options.reconstruction);
  options.warm_start = args.warm_start;
  parse_shift(args.shift);
  check_outputs(args);
  const Device device = args.chosen();
  const EditScript script(args.script);
  check_names(args, script.parts());
  warn_about_options(args, options.reconstruction);
  options.reconstruction.envelope = read_envelope(args.envelope, args.threads);
  Cloud base = read_base(args, options.reconstruction);
  Json json = {{"version", 1}, {"command", "edit"}, {"device", to_json(device)}};
  json["input"] = {{"points", base.size() + base.dropped}, {"dropped", base.dropped}};
  json["options"] = report_of(edit_options, args);
  json["ms"]["read"] = watch.ms();

  on_interrupt(OnInterrupt::remember);
  options.reconstruction.progress = [](const Progress&) { return !interrupted(); };
  EditSession session(base, options, device);
  base = Cloud();
  run_script(script, args, session);
  throw_if_interrupted();
  if (!args.cloud.empty()) write_cloud(args.cloud, session.cloud(), args.threads);
  if (!args.save.empty()) write_file_atomically(args.save, json_text(script_of(session.operations(), args.save)));
  if (!args.output.empty()) write_mesh(args.output, session.mesh(), args.threads);
  const double total_ms = watch.ms();
  json["ms"]["total"] = total_ms;
  if (!args.report.empty()) {
    describe(session, args, json);
    json["memory"]["host_peak_bytes"] = host_peak_bytes();
    write_file_atomically(args.report, json_text(json));
  }
  if (!args.quiet) print_note(summary(session, args, total_ms));
  return 0;
}

}  // namespace

Command edit_command() {
  return make_command({"edit", "Guide, repair and extend a surface by a script of operations."}, edit_options, run);
}

}  // namespace pointskin::cli
