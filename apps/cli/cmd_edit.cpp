// pointskin edit: a cloud and a script of strokes, removals and copied parts in, mesh and what every step did out.
#include <algorithm>
#include <memory>

#include <fmt/format.h>

#include <pointskin/edit.hpp>
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "edit_script.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "reconstruct_args.hpp"
#include "signals.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

struct EditArgs {
  ReconstructArgs fit;  ///< inputs, output, report and the options of the surface and of the device
  std::string script;
  std::string save;   ///< empty: none
  std::string cloud;  ///< empty: none
  bool cold = false;
};

void check_files(const EditArgs& args) {
  const auto usage = [](const std::string& story) { throw Error(ErrorCode::usage, story); };
  if (std::count(args.fit.inputs.begin(), args.fit.inputs.end(), "-") > 1) usage("stdin (-) can be read only once");
  if (!args.fit.output.empty()) check_mesh_output(args.fit.output);
  for (const std::string& path : {args.save, args.cloud, args.fit.report})
    if (!path.empty()) check_replaceable(path);
  if (!args.cloud.empty() && !has_extension(args.cloud, ".ply")) usage("--cloud: points are written as .ply");
}

Cloud read_base(const EditArgs& args) {
  Cloud cloud = read_clouds(args.fit.inputs, {.shift = parse_shift(args.fit.shift), .threads = args.fit.threads});
  const std::int64_t no_normal = drop_zero_normals(cloud);
  if (no_normal > 0) print_warning(fmt::format("{} points were dropped: their normal has zero length", no_normal));
  return cloud;
}

Json to_json(const Topology& topology) {
  return {{"components", topology.components}, {"genus", topology.genus}, {"euler", topology.euler}};
}

Json to_json(const StepReport& step) {
  return {{"operation", step.operation},
          {"added", step.added},
          {"removed", step.removed},
          {"points", step.points},
          {"triangles", step.triangles},
          {"snapped", step.snapped},
          {"warm", step.warm},
          {"before", to_json(step.before)},
          {"after", to_json(step.after)},
          {"ms", {{"edit", step.edit_ms}, {"reconstruct", step.reconstruct_ms}, {"total", step.total_ms}}}};
}

Json report_of(const EditSession& session, const EditArgs& args) {
  Json steps = Json::array();
  for (const StepReport& step : session.steps()) steps.push_back(to_json(step));
  const MeshReport mesh = measure(session.mesh(), args.fit.threads);
  return {{"version", 1},
          {"command", "edit"},
          {"device",
           {{"kind", session.device().kind == DeviceKind::cuda ? "cuda" : "cpu"}, {"name", session.device().name()}}},
          {"steps", steps},
          {"mesh",
           {{"vertices", mesh.vertices},
            {"triangles", mesh.triangles},
            {"closed", mesh.closed()},
            {"manifold", mesh.manifold()},
            {"components", mesh.components},
            {"euler", mesh.euler}}}};
}

std::string line_of(const StepReport& step, std::size_t number) {
  return fmt::format("{}: {}: {} points added, {} removed; components {} -> {}, genus {} -> {}; {:.1f} ms", number,
                     step.operation, step.added, step.removed, step.before.components, step.after.components,
                     step.before.genus, step.after.genus, step.total_ms);
}

void run_script(const EditScript& script, const EditArgs& args, EditSession& session) {
  const auto camera_of_picture = [&session](const RenderOptions& options) {
    return camera_of(session.mesh(), options);
  };
  for (std::size_t i = 0; i < script.size(); ++i) {
    throw_if_interrupted();
    const ScriptStep step = script.step(i, camera_of_picture);
    try {
      if (step.kind == ScriptStep::Kind::apply) session.apply(step.operation);
      if (step.kind == ScriptStep::Kind::undo && !session.undo())
        throw Error(ErrorCode::usage, "there is nothing to undo");
      if (step.kind == ScriptStep::Kind::redo && !session.redo())
        throw Error(ErrorCode::usage, "there is nothing to redo");
    } catch (const Error& error) {
      throw error.while_doing(fmt::format("running operations[{}] of {}", i, args.script));
    }
    if (!args.fit.quiet && step.kind == ScriptStep::Kind::apply) print_note(line_of(session.steps().back(), i));
  }
}

int run(const EditArgs& args) {
  EditOptions options;
  options.reconstruction = library_options(args.fit);
  options.warm_start = !args.cold;
  parse_shift(args.fit.shift);
  check_files(args);
  const Device device = parse_device(args.fit.device, args.fit.threads);
  const EditScript script(args.script);
  const Cloud base = read_base(args);
  on_interrupt(OnInterrupt::remember);
  options.reconstruction.progress = [](const Progress&) { return !interrupted(); };
  EditSession session(base, options, device);
  run_script(script, args, session);
  throw_if_interrupted();
  if (!args.cloud.empty()) write_cloud(args.cloud, session.cloud(), args.fit.threads);
  if (!args.save.empty()) write_file_atomically(args.save, json_text(script_of(session.operations(), args.save)));
  if (!args.fit.report.empty()) write_file_atomically(args.fit.report, json_text(report_of(session, args)));
  if (!args.fit.output.empty()) write_mesh(args.fit.output, session.mesh(), args.fit.threads);
  return 0;
}

void define_files(CLI::App& command, EditArgs& args) {
  const std::string group = "Files";
  const auto file = [&](const char* name, std::string& target, const char* type, const char* description) {
    return command.add_option(name, target, description)
        ->type_name(type)
        ->group(group)
        ->check([](const std::string& name) { return std::string(name.empty() ? "needs the name of a file" : ""); });
  };
  command.add_option("IN", args.fit.inputs, "oriented clouds, merged; - reads stdin")->required();
  file("--script", args.script, "FILE", "operations, as JSON")->required();
  file("-o,--output", args.fit.output, "OUT", "mesh: .ply, .obj or .stl; - writes PLY to stdout");
  file("--cloud", args.cloud, "FILE", "write the edited points, with the property added, as PLY");
  file("--save", args.save, "FILE", "write the operations that are done, as a script");
  file("--report", args.fit.report, "FILE", "write what every step did as JSON");
  command.add_option("--shift", args.fit.shift, "offset subtracted while working: auto, none or x,y,z in world units")
      ->type_name("S")
      ->group(group)
      ->capture_default_str();
}

}  // namespace

void add_edit(CLI::App& program, Job& job) {
  CLI::App* command = add_command(program, "edit", "Guide, repair and extend a surface by a script of operations.");
  auto args = std::make_shared<EditArgs>();
  define_files(*command, *args);
  define_surface_options(*command, args->fit);
  define_device_options(*command, args->fit);
  command->add_flag("--cold", args->cold, "solve every surface anew, instead of from the one before")->group("Surface");
  command->add_flag("-q,--quiet", args->fit.quiet, "errors and warnings only")->group("Messages");
  finish_command(*command, job, args, run);
}

}  // namespace pointskin::cli
