// pointskin deform: a cloud bent by handles and lattices, frame after frame.
#include <algorithm>
#include <chrono>
#include <filesystem>
#include <memory>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pointskin/deform.hpp>
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "deform_script.hpp"
#include "input.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "signals.hpp"
#include "statistics.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

struct DeformArgs {
  std::vector<std::string> inputs;
  std::string script, output, cloud, report;  ///< empty: none
  std::string device = "auto", shift = "auto";
  Options options;
  int threads = 0, frames = 1;
  bool frames_given = false, no_normals = false, quiet = false;
};

class Stopwatch {
 public:
  /// Milliseconds since construction.
  [[nodiscard]] double ms() const {
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start_).count();
  }

 private:
  std::chrono::steady_clock::time_point start_ = std::chrono::steady_clock::now();
};

[[noreturn]] void throw_usage(const std::string& story) { throw Error(ErrorCode::usage, story); }

/// Name of a frame's file: {} becomes its number, with as many digits as the last one has.
std::string frame_file(const DeformArgs& args, const std::string& pattern, int frame) {
  const std::size_t place = pattern.find("{}");
  if (!args.frames_given || place == std::string::npos) return pattern;
  const std::size_t digits = std::to_string(args.frames - 1).size();
  std::string number = std::to_string(frame);
  number.insert(0, digits - number.size(), '0');
  return pattern.substr(0, place) + number + pattern.substr(place + 2);
}

void check_pattern(const DeformArgs& args, const std::string& pattern, const char* option) {
  if (pattern.empty() || !args.frames_given) return;
  if (pattern.find("{}") == std::string::npos)
    throw_usage(fmt::format("{}: {} needs {{}}, where the frame's number goes, because of --frames", option, pattern));
}

/// Everything that can be found wrong before the input is opened.
void check_files(const DeformArgs& args) {
  if (args.output.empty() && args.cloud.empty()) throw_usage("no output; name a mesh with -o or a cloud with --cloud");
  if (args.frames_given && (args.frames < 2 || args.frames > 100'000))
    throw_usage(fmt::format("--frames: {} is not in [2, 100000]", args.frames));
  check_pattern(args, args.output, "-o");
  check_pattern(args, args.cloud, "--cloud");
  if (args.report == "-") throw_usage("--report: stdout carries the mesh only; name a file");
  if (args.output == "-" && args.cloud == "-") throw_usage("-o and --cloud both name stdout");
  if (!args.output.empty() && args.output == args.cloud) throw_usage("-o and --cloud name the same file");
  if (!args.report.empty() && (args.report == args.output || args.report == args.cloud))
    throw_usage("--report names the same file as -o or --cloud");
  std::vector<std::string> sources = args.inputs;
  sources.push_back(args.script);
  if (std::count(sources.begin(), sources.end(), "-") > 1) throw_usage("stdin (-) can be read only once");
  for (const std::string& source : sources) {
    std::error_code ignored;  // files that do not exist are not the same
    if (!args.report.empty() && std::filesystem::equivalent(source, args.report, ignored))
      throw_usage("--report would overwrite the input " + source);
  }
  if (!args.output.empty()) check_mesh_output(frame_file(args, args.output, 0));
  if (!args.cloud.empty()) {
    if (args.cloud != "-" && !has_extension(args.cloud, ".ply"))
      throw_usage(fmt::format("--cloud: {}: clouds are written as .ply only", args.cloud));
    check_mesh_output(frame_file(args, args.cloud, 0));
  }
  if (!args.report.empty()) check_replaceable(args.report);
}

Options library_options(const DeformArgs& args) {
  Options options = args.options;
  options.normals = !args.no_normals;
  options.progress = [](const Progress&) { return !interrupted(); };
  validate(options);
  return options;
}

/// The script, checked against the cloud.
Deformation checked(const DeformArgs& args, Deformation deformation, std::int64_t points) {
  try {
    validate(deformation, points);
  } catch (const Error& error) {
    throw Error(ErrorCode::invalid_input, fmt::format("{}: {}", args.script, error.what()));
  }
  return deformation;
}

Json mesh_json(const MeshReport& mesh) {
  return {{"vertices", mesh.vertices},   {"triangles", mesh.triangles},   {"closed", mesh.closed()},
          {"manifold", mesh.manifold()}, {"components", mesh.components}, {"euler", mesh.euler}};
}

/// Deforms, writes and measures one frame after another.
class Frames {
 public:
  Frames(const DeformArgs& args, Deformer& deformer, const Deformation& deformation)
      : args_(args), deformer_(deformer), deformation_(deformation) {}

  void run_all() {
    for (int frame = 0; frame < args_.frames; ++frame) run_one(frame);
  }

  [[nodiscard]] const Json& json() const { return json_; }
  [[nodiscard]] double median_ms() const { return spread_of(frame_ms_).median; }
  [[nodiscard]] std::int64_t triangles() const { return static_cast<std::int64_t>(mesh_.triangles.size()); }

 private:
  void run_one(int frame) {
    throw_if_interrupted();
    const double share = args_.frames_given ? static_cast<double>(frame) / (args_.frames - 1) : 1;
    const Stopwatch watch;
    deformer_.deform(scaled(deformation_, share));
    if (!args_.output.empty()) deformer_.reconstruct(mesh_);
    frame_ms_.push_back(watch.ms());
    const Stopwatch writing;
    throw_if_interrupted();
    if (!args_.output.empty()) write_mesh(frame_file(args_, args_.output, frame), mesh_, args_.threads);
    if (!args_.cloud.empty()) write_cloud(frame_file(args_, args_.cloud, frame), deformer_.cloud(), args_.threads);
    if (!args_.report.empty()) json_.push_back(describe(share, frame_ms_.back(), writing.ms()));
  }

  [[nodiscard]] Json describe(double share, double total_ms, double write_ms) const {
    const DeformReport& report = deformer_.report();
    const SpacingRatios spacing = deformer_.spacing();
    Json json = {{"share", share},
                 {"points", report.points},
                 {"inserted", report.inserted},
                 {"thinned", report.thinned},
                 {"spacing", {{"p05", spacing.p05}, {"median", spacing.median}, {"p95", spacing.p95}}}};
    if (!args_.output.empty()) json["mesh"] = mesh_json(measure(mesh_, args_.threads));
    json["ms"] = {{"sample", report.sample_ms}, {"map", report.map_ms}};
    if (!args_.output.empty()) json["ms"]["mesh"] = report.mesh_ms;
    json["ms"]["total"] = total_ms;
    json["ms"]["write"] = write_ms;
    return json;
  }

  const DeformArgs& args_;
  Deformer& deformer_;
  const Deformation& deformation_;
  Mesh mesh_;
  std::vector<double> frame_ms_;
  Json json_ = Json::array();
};

Json options_json(const DeformArgs& args) {
  const auto or_null = [](const std::string& text) { return text.empty() ? Json(nullptr) : Json(text); };
  return {{"depth", args.options.depth},
          {"screening", args.options.screening},
          {"iterations", args.options.iterations},
          {"scale", args.options.scale},
          {"samples_per_node", args.options.samples_per_node},
          {"attributes", args.options.attributes},
          {"normals", !args.no_normals},
          {"keep_strays", args.options.keep_strays},
          {"frames", args.frames},
          {"device", args.device},
          {"threads", args.threads},
          {"shift", args.shift},
          {"inputs", args.inputs},
          {"script", args.script},
          {"output", or_null(args.output)},
          {"cloud", or_null(args.cloud)}};
}

Cloud read_input(const DeformArgs& args) {
  Cloud cloud = read_clouds(args.inputs, {.shift = parse_shift(args.shift), .threads = args.threads});
  const std::int64_t not_finite = cloud.dropped;
  const std::int64_t no_normal = drop_zero_normals(cloud);
  if (not_finite > 0) print_warning(fmt::format("{} points were dropped: a coordinate is not finite", not_finite));
  if (no_normal > 0) print_warning(fmt::format("{} points were dropped: their normal has zero length", no_normal));
  return cloud;
}

int run(const DeformArgs& args) {
  const Options options = library_options(args);
  parse_shift(args.shift);
  check_files(args);
  const Device device = parse_device(args.device, args.threads);
  Deformation deformation = read_deformation(args.script);
  const Stopwatch reading;
  Cloud cloud = read_input(args);
  const double read_ms = reading.ms();
  deformation = checked(args, std::move(deformation), cloud.size());

  on_interrupt(OnInterrupt::remember);
  Deformer deformer(cloud, options, device);
  const RunReport& at_rest = deformer.report().run;
  if (at_rest.strays > 0) print_warning(strays_text(at_rest.strays, at_rest.farthest_strays.front()));
  Json json = {{"version", 1}, {"command", "deform"}};
  json["device"] = {{"kind", device.kind == DeviceKind::cuda ? "cuda" : "cpu"}, {"name", device.name()}};
  json["input"] = {{"points", cloud.size() + cloud.dropped},
                   {"used", deformer.report().rest_points},
                   {"dropped", cloud.dropped},
                   {"strays", at_rest.strays}};
  json["options"] = options_json(args);
  cloud = Cloud();

  Frames frames(args, deformer, deformation);
  frames.run_all();
  const DeformReport& report = deformer.report();
  json["frames"] = frames.json();
  json["ms"] = {
      {"read", read_ms}, {"upload", report.upload_ms}, {"rest", report.rest_ms}, {"frame_median", frames.median_ms()}};
  if (!args.report.empty()) write_file_atomically(args.report, json_text(json));
  if (!args.quiet)
    print_note(
        fmt::format("points {}, of them inserted {}, thinned {}; triangles {}; {} frames: median {:.1f} ms, "
                    "{:.1f} frames per second",
                    report.points, report.inserted, report.thinned, frames.triangles(), args.frames, frames.median_ms(),
                    1000 / frames.median_ms()));
  return 0;
}

void define_files(CLI::App& command, DeformArgs& args) {
  const std::string group = "Files";
  const auto file = [&](const char* name, std::string& target, const char* type, const char* description) {
    return command.add_option(name, target, description)->type_name(type)->group(group);
  };
  command.add_option("IN", args.inputs, "oriented clouds, merged; - reads stdin")->required();
  file("--script", args.script, "FILE", "the deformation as JSON; - reads stdin")->required();
  file("-o,--output", args.output, "OUT", "mesh: .ply, .obj or .stl; - writes PLY to stdout");
  file("--cloud", args.cloud, "OUT", "deformed points: .ply, - writes to stdout");
  file("--report", args.report, "FILE", "write what was done as JSON; also measures how far apart samples are");
  file("--shift", args.shift, "S", "offset subtracted while working: auto, none or x,y,z in world units")
      ->capture_default_str();
  command.add_option("--frames", args.frames, "N frames from the rest pose to the deformation; {} in OUT: number")
      ->type_name("N")
      ->group(group)
      ->each([&args](const std::string&) { args.frames_given = true; });
}

void define_surface(CLI::App& command, DeformArgs& args) {
  const std::string group = "Surface";
  Options& options = args.options;
  const auto value = [&](const char* name, auto& target, const char* type, const char* description) {
    command.add_option(name, target, description)->type_name(type)->group(group)->capture_default_str();
  };
  value("--depth", options.depth, "D", "octree depth D in levels, 1 to 20; cells are cube / 2^D wide");
  value("--screening", options.screening, "W", "weight of the points, no unit, >= 0; 0: unscreened");
  value("--iterations", options.iterations, "N", "relaxations per level, 1 to 1000");
  value("--scale", options.scale, "F", "working cube / bounding cube of the points, 1 to 100");
  value("--samples-per-node", options.samples_per_node, "N", "points a cell should hold, 0 to 100");
  command.add_flag("--keep-strays", options.keep_strays, "use stray points, too")->group(group);
  command.add_flag("--keep-attributes", options.attributes, "carry properties of the points to the vertices")
      ->group(group);
  command.add_flag("--no-normals", args.no_normals, "leave vertex normals out of the mesh")->group(group);
}

}  // namespace

void add_deform(CLI::App& program, Job& job) {
  CLI::App* command = add_command(program, "deform", "Bend a cloud by handles and lattices, and fit meshes to it.");
  auto args = std::make_shared<DeformArgs>();
  define_files(*command, *args);
  define_surface(*command, *args);
  command->add_option("--device", args->device, "auto, cpu, cuda or cuda:N")
      ->type_name("DEV")
      ->group("Device and limits")
      ->capture_default_str();
  add_threads_option(*command, args->threads, "Device and limits");
  command->add_flag("-q,--quiet", args->quiet, "errors and warnings only")->group("Messages");
  finish_command(*command, job, args, run);
}

}  // namespace pointskin::cli
