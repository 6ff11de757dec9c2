// pointskin edit: a cloud and a script of operations in, or a document with both; mesh and what every step did out.

#include <fmt/format.h>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "edit_document.hpp"
#include "file_plan.hpp"
#include "fit_args.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "report.hpp"
#include "run_memory.hpp"
#include "scene/scene.hpp"
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
          {clouds_row(args.inputs, {}),
           option("--script FILE", "operations, as JSON, or all of a scene: clouds and options, too", &args.script,
                  {"script", 61, kNeverNull}, {.required = true, .check = needs_a_name}),
           output_row(args.output, named),
           option("--cloud FILE", "write the edited points, with the property added, as PLY", &args.cloud,
                  {"cloud", 63}, named),
           option("--save FILE", "write clouds, options and the operations that are done, as such a script", &args.save,
                  {"save", 64}, named),
           report_row(args.report, "write what every step did as JSON"), overwrite_row(args.overwrite),
           shift_row(args.shift)}};
}

OptionTable edit_options(EditArgs& args) {
  return {file_options(args),
          fit_options(args).without({"--offset"}),  // a session has none
          device_options(args),
          memory_options(args.options.max_memory_bytes),
          {kSurfaceGroup,
           {option("--cold", "solve every surface anew, instead of from the one before", negated(args.warm_start),
                   {"warm_start", 24})}},
          quiet_option(args.quiet)};
}

/// @param named  files that the document names
void check_names(const EditArgs& args, const std::vector<std::string>& named) {
  std::vector<std::string> inputs = args.inputs;
  inputs.insert(inputs.end(), {args.script, args.envelope});
  inputs.insert(inputs.end(), named.begin(), named.end());
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

Json step_json(const scene::StepRecord& step) {
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
          {"ms", {{"edit", step.edit_ms}, {"reconstruct", step.reconstruct_ms}, {"total", step.total_ms}}},
          {"notes", step.notes}};
}

/// What every step did, and the mesh in the end.
void describe(const scene::Scene& scene, const EditArgs& args, Json& json) {
  Json steps = Json::array();
  for (std::size_t i = 0; i < scene.done(); ++i) steps.push_back(step_json(scene.record(i)));
  json["steps"] = steps;
  json["mesh"] = to_json(measure(scene.mesh(), args.threads));
}

std::string line_of(const scene::StepRecord& step, std::size_t number) {
  const std::string flipped = step.flipped > 0 ? fmt::format(", {} turned", step.flipped) : "";
  return fmt::format("{}: {}: {} points added, {} removed{}; components {} -> {}, genus {} -> {}; {:.1f} ms", number,
                     step.operation, step.added, step.removed, flipped, step.before.components, step.after.components,
                     step.before.genus, step.after.genus, step.total_ms);
}

/// Says what a step did, and warns of one that was to change points and changed none.
void say(const scene::StepRecord& step, std::size_t number, const EditArgs& args) {
  if (!args.quiet) print_note(line_of(step, number));
  if (!args.quiet)
    for (const std::string& note : step.notes) print_note(fmt::format("{}: {}", number, note));
  if (step.operation != "options" && step.added == 0 && step.removed == 0 && step.flipped == 0 &&
      step.operation != "deform")
    print_warning(fmt::format("operations[{}] of {}: the {} changes no point", number, args.script, step.operation));
}

/// Does entry `i` of the document.
void run_entry(const Json& entry, std::size_t i, const EditArgs& args, scene::Sources& sources, scene::Scene& scene) {
  const auto camera_of_picture = [&](RenderOptions options) {
    options.threads = args.threads;
    return camera_of(scene.mesh(), options);
  };
  const bool goes_back = scene::is_undo(entry) || scene::is_redo(entry);
  scene::SceneOperation operation;
  if (!goes_back)
    operation =
        scene::operation_of(entry, fmt::format("{}.operations[{}]", args.script, i), "/", camera_of_picture, &sources);
  try {
    if (!goes_back) scene.apply(operation);
    if (scene::is_undo(entry) && !scene.undo()) throw_usage("there is nothing to undo");
    if (scene::is_redo(entry) && !scene.redo()) throw_usage("there is nothing to redo");
  } catch (const Error& error) {
    throw error.while_doing(fmt::format("running operations[{}] of {}", i, args.script));
  }
  if (!goes_back) say(scene.record(scene.done() - 1), i, args);
}

void run_document(const scene::Document& document, const EditArgs& args, scene::Scene& scene) {
  if (document.operations.empty()) print_warning(fmt::format("{}: has no operations", args.script));
  scene::Sources sources(args.threads);
  for (std::size_t i = 0; i < document.done; ++i) {
    throw_if_interrupted();
    run_entry(document.operations[i], i, args, sources, scene);
  }
}

void warn_about_options(const EditArgs& args, const Options& options) {
  warn_about_unused(args.given, options, args.output, false);
  if (!args.output.empty()) return;
  warn_unused(args.given, {"--no-normals", "--density", "--weakness"}, kNoMesh);
  if (args.cloud.empty()) warn_unused(args.given, {"--keep-attributes"}, "where neither mesh nor cloud is written");
}

/// The document, and in `args` what it says and the command line does not.
scene::Document read_script(EditArgs& args) {
  scene::Document document = scene::read_document(args.script);
  take_options(document, edit_options(args), args.given, args.options);
  validate(args.options);
  if (!args.given.has("--cold")) args.warm_start = document.warm_start;
  if (!args.given.has("--shift")) args.shift = document.base.shift;
  if (!args.inputs.empty()) document.base.clouds.clear();
  for (const std::string& input : args.inputs)
    if (input != "-") document.base.clouds.push_back(scene::cloud_of_file(input));
  if (args.inputs.empty() && document.base.clouds.empty())
    throw_usage(fmt::format("no cloud; name one as IN, or in {} under clouds", args.script));
  return document;
}

/// The inputs as the command line names them, or the clouds of the document; says what changed since it was written.
Cloud read_inputs(const EditArgs& args, const scene::Document& document) {
  const ReadOptions options{.shift = parse_shift(args.shift), .threads = args.threads};
  const MissingNormals missing = begins_with_normals(document) ? MissingNormals::allowed : MissingNormals::refused;
  if (!args.inputs.empty()) return read_clouds(args.inputs, options, missing);
  for (const std::string& notice : scene::check_clouds(document.base)) print_warning(notice);
  scene::ReadFacts facts;
  Cloud base = scene::merge_sources(document.base.clouds, options, missing, facts);
  for (const std::string& notice : facts.notices) print_warning(notice);
  return base;
}

/// Reads, merges and cleans the inputs, and says what is left out.
Cloud read_base(const EditArgs& args, const scene::Document& document, const Options& options) {
  Cloud base = read_inputs(args, document);
  if (base.has_normals())
    drop_unusable(base);
  else
    warn_about_dropped(base.dropped);
  warn_about_unused(args.given, options, base, args.output);
  if (!options.keep_strays) warn_about_strays(base, args.threads);
  if (options.envelope != nullptr)  // the scene does not tell how many are outside
    warn_about_envelope({.samples_outside = count_outside_box(base, *options.envelope)}, base.size());
  return base;
}

/// The document with what was done: cameras as matrices, and no way back; what was undone in it stays so.
void save(const scene::Scene& scene, scene::Document document, const EditArgs& args) {
  std::vector<Json> operations;
  for (std::size_t i = 0; i < scene.done(); ++i) operations.push_back(scene::to_json(scene.operation(i), ""));
  const auto undone = document.operations.begin() + static_cast<std::ptrdiff_t>(document.done);
  operations.insert(operations.end(), undone, document.operations.end());
  document.done = scene.done();
  document.operations = std::move(operations);
  document.options = args.options;
  document.warm_start = args.warm_start;
  document.base.shift = args.shift;
  if (document.base.clouds.size() < args.inputs.size()) document.base.clouds.clear();  // one was stdin
  scene::stamp_clouds(document.base);
  if (!args.envelope.empty())
    print_warning("--save: the file does not hold the envelope; name it again with --envelope");
  scene::write_document(args.save, document);
}

void write_points(const scene::Scene& scene, const EditArgs& args) {
  Cloud cloud = scene.cloud();
  if (!args.options.attributes)
    std::erase_if(cloud.attributes, [](const Attribute& attribute) { return attribute.name != "added"; });
  write_cloud(args.cloud, cloud, args.threads);
}

std::string edit_summary(const scene::Scene& scene, const EditArgs& args, double total_ms) {
  const Mesh& mesh = scene.mesh();
  const std::string file = args.output.empty() ? args.cloud : args.output;
  return fmt::format("{}operations {}, triangles {}, {}; ms: total {:.1f}; memory {} host", file_words(file),
                     scene.done(), mesh.triangles.size(), shape_words(mesh, args.threads), total_ms,
                     format_bytes(static_cast<double>(host_peak_bytes())));
}

scene::SceneOptions scene_options(const EditArgs& args, const Options& reconstruction) {
  scene::SceneOptions options;
  options.reconstruction = reconstruction;
  options.warm_start = args.warm_start;
  options.progress = [](const Progress&) { return !interrupted(); };
  return options;
}

void write_outputs(const scene::Scene& scene, const scene::Document& document, const EditArgs& args) {
  throw_if_interrupted();
  if (!args.cloud.empty()) {
    write_points(scene, args);
    file_was_written();
  }
  if (!args.save.empty()) {
    save(scene, document, args);
    file_was_written();
  }
  if (!args.output.empty()) {
    write_mesh(args.output, scene.mesh(), args.threads);
    file_was_written();
  }
  if (args.report.empty()) ignore_interrupts();
}

int run(const EditArgs& given) {
  const Stopwatch watch;
  EditArgs args = given;
  validate(args.options);
  parse_shift(args.shift);
  check_outputs(args);
  const Device device = args.chosen();
  const scene::Document document = read_script(args);
  check_names(args, files_of(document));
  warn_about_options(args, args.options);
  Options reconstruction = args.options;
  reconstruction.envelope = read_envelope(args.envelope, args.threads);
  Cloud base = read_base(args, document, reconstruction);
  Json json = {{"version", 1}, {"command", "edit"}, {"device", to_json(device)}};
  json["input"] = {{"points", base.size() + base.dropped}, {"dropped", base.dropped}};
  json["options"] = report_of(edit_options, args);
  json["ms"] = {{"read", watch.ms()}};

  on_interrupt(OnInterrupt::remember);
  const RunMemory memory(device, reconstruction, reconstruction.max_memory_bytes);
  memory.check(base);
  reconstruction.max_memory_bytes = memory.limit_of_run();
  const Workspace workspace(device);
  memory.limit(workspace);
  scene::Scene scene = memory.within_limit(
      [&] { return scene::Scene(std::move(base), scene_options(args, reconstruction), workspace); });
  memory.within_limit([&] { run_document(document, args, scene); });
  write_outputs(scene, document, args);
  const double total_ms = watch.ms();
  json["ms"]["total"] = total_ms;
  if (!args.report.empty()) {
    describe(scene, args, json);
    json["memory"] = {{"host_peak_bytes", host_peak_bytes()}};
    write_file_atomically(args.report, json_text(json));
    ignore_interrupts();
  }
  if (!args.quiet) print_note(edit_summary(scene, args, total_ms));
  return 0;
}

}  // namespace

Command edit_command() {
  return make_command({"edit", "Guide, repair and extend a surface by a script of operations."}, edit_options, run);
}

}  // namespace pointskin::cli
