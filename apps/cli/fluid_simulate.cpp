#include "fluid_simulate.hpp"

#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include <pointskin/simulation.hpp>
#include "args.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "json_text.hpp"
#include "output_check.hpp"
#include "progress.hpp"
#include "report.hpp"
#include "run_memory.hpp"
#include "scene/frame_files.hpp"
#include "signals.hpp"
#include "statistics.hpp"
#include "stopwatch.hpp"
#include "summary_words.hpp"

namespace pointskin::cli {
namespace {

using Json = nlohmann::ordered_json;

void check_ranges(const SimulateArgs& args) {
  const auto check = [](const char* option, auto value, auto least, auto most) {
    if (!(value >= least && value <= most))
      throw_usage(fmt::format("{}: {} is not in [{}, {}]", option, value, least, most));
  };
  check("--frames", args.frames, 1, 1'000'000);
  check("--fps", args.fps, 1.0, 10'000.0);
  check("--particles", args.particles, simulation::kFewestParticles, simulation::kMostParticles);
  check("--iterations", args.iterations, 1, 100);
  check("--viscosity", args.viscosity, 0.0, 1.0);
  check("--vorticity", args.vorticity, 0.0, 1e6);
}

void check_names(const SimulateArgs& args, const SimulateOutput& output) {
  FilePlan plan{{}, {{"--report", output.report, OutputKind::report}}};
  const std::vector<OutputFile> patterns = {{"-o", output.output}, {"--particles-out", args.particles_out}};
  for (const OutputFile& pattern : patterns) {
    for (int frame = 0; frame < args.frames && !pattern.file.empty(); ++frame)
      plan.outputs.push_back(
          {pattern.option, scene::frame_file(pattern.file, frame, args.frames), pattern.kind, frame});
  }
  check_files(plan);
}

/// Everything that can be found wrong before the first frame.
simulation::SceneKind check(const SimulateArgs& args, const SimulateOutput& output) {
  const auto kind = simulation::parse_scene(args.scene);
  if (!kind) {
    std::vector<std::string> names;
    for (const simulation::SceneKind known : simulation::all_scenes()) names.emplace_back(simulation::name_of(known));
    throw_usage("--simulate: " + not_one_of(args.scene, names));
  }
  check_ranges(args);
  if (output.output.empty() && args.particles_out.empty() && output.report.empty())
    throw_usage("no output; name meshes with -o, particles with --particles-out or a --report");
  scene::check_pattern(output.output, "-o", "--simulate");
  scene::check_pattern(args.particles_out, "--particles-out", "--simulate");
  check_names(args, output);
  if (!output.output.empty()) check_mesh_output(scene::frame_file(output.output, 0, args.frames));
  if (!args.particles_out.empty()) {
    check_cloud_name(args.particles_out, "--particles-out: {}: particles are written as {} only");
    check_result(scene::frame_file(args.particles_out, 0, args.frames));
  }
  if (!output.report.empty()) check_replaceable(output.report);
  return *kind;
}

simulation::SimulationOptions library_options(const SimulateArgs& args) {
  simulation::SimulationOptions options;
  options.iterations = args.iterations;
  options.viscosity = args.viscosity;
  options.vorticity = args.vorticity;
  validate(options);
  return options;
}

Cloud cloud_of(simulation::ParticleStates particles) {
  Cloud cloud;
  cloud.positions = std::move(particles.positions);
  constexpr std::pair<const char*, float Vec3f::*> kAxes[3] = {
      {"velocity_x", &Vec3f::x}, {"velocity_y", &Vec3f::y}, {"velocity_z", &Vec3f::z}};
  for (const auto& [name, axis] : kAxes) {
    std::vector<float> values;
    values.reserve(particles.velocities.size());
    for (const Vec3f& v : particles.velocities) values.push_back(v.*axis);
    cloud.attributes.push_back({name, std::move(values)});
  }
  return cloud;
}

/// Steps, makes surfaces, writes and reports, one frame after another.
class SimulatedFrames {
 public:
  SimulatedFrames(const SimulateArgs& args, const SimulateOutput& output, simulation::Simulation& fluid)
      : args_(args), output_(output), fluid_(fluid) {}

  void run_all(ProgressLine& progress) {
    for (int frame = 0; frame < args_.frames; ++frame) {
      throw_if_interrupted();
      progress.update({"simulate", static_cast<double>(frame) / args_.frames});
      run_one(frame);
    }
  }

  /// The frames' lines of the report, joined by commas.
  [[nodiscard]] const std::string& lines() const { return lines_; }
  [[nodiscard]] const std::vector<double>& step_ms() const { return step_ms_; }
  [[nodiscard]] const std::vector<double>& surface_ms() const { return surface_ms_; }
  /// Of the last frame; empty without meshes.
  [[nodiscard]] const Mesh& mesh() const { return mesh_; }

 private:
  void run_one(int frame) {
    if (frame > 0) fluid_.step(1 / args_.fps);
    step_ms_.push_back(fluid_.report().ms);
    if (fluid_.report().lost > 0)
      throw Error(ErrorCode::internal,
                  fmt::format("frame {}: {} particles left the tank", frame, fluid_.report().lost));
    const Stopwatch surfacing;
    if (!output_.output.empty()) {
      fluid_.surface(output_.surface, mesh_);
      surface_ms_.push_back(surfacing.ms());
    }
    throw_if_interrupted();
    const Stopwatch writing;
    if (!output_.output.empty())
      write_mesh(scene::frame_file(output_.output, frame, args_.frames), mesh_, output_.device.threads);
    if (!args_.particles_out.empty()) write_particles(frame);
    frame_was_written();
    if (!output_.report.empty()) add_line(describe(writing.ms()));
  }

  void write_particles(int frame) {
    std::optional<UndisturbedScope> whole;  // a frame is both of its files
    if (!output_.output.empty()) whole.emplace();
    write_cloud(scene::frame_file(args_.particles_out, frame, args_.frames), cloud_of(fluid_.particles()),
                output_.device.threads);
  }

  /// As text: many frames would make a tree of values that outgrows the simulation.
  void add_line(const Json& json) { lines_ += (lines_.empty() ? "\n    " : ",\n    ") + json.dump(); }

  [[nodiscard]] Json describe(double write_ms) const {
    const simulation::SimulationReport& r = fluid_.report();
    Json json = {{"frame", r.frame},
                 {"seconds", r.seconds},
                 {"particles", r.particles},
                 {"substeps", r.substeps},
                 {"mean_density_error", r.mean_density_error},
                 {"max_density_error", r.max_density_error},
                 {"kinetic_energy", r.kinetic_energy},
                 {"potential_energy", r.potential_energy},
                 {"max_speed", r.max_speed},
                 {"crowded", r.crowded}};
    if (!output_.output.empty()) {
      const MeshReport mesh = measure(mesh_, output_.device.threads);
      json["mesh"] = {{"vertices", mesh.vertices},   {"triangles", mesh.triangles},   {"closed", mesh.closed()},
                      {"manifold", mesh.manifold()}, {"components", mesh.components}, {"watertight", mesh.watertight()},
                      {"volume", mesh.volume}};
    }
    json["ms"] = {{"simulate", r.ms}};
    if (!output_.output.empty()) json["ms"]["surface"] = surface_ms_.back();
    json["ms"]["write"] = write_ms;
    json["host_peak_bytes"] = host_peak_bytes();
    return json;
  }

  const SimulateArgs& args_;
  const SimulateOutput& output_;
  simulation::Simulation& fluid_;
  Mesh mesh_;
  std::vector<double> step_ms_, surface_ms_;
  std::string lines_;
};

void write_report(const SimulateArgs& args, const SimulateOutput& output, const simulation::Simulation& fluid,
                  const SimulatedFrames& frames) {
  const Device& device = fluid.device();
  const simulation::Scene& scene = fluid.scene();
  Json json = {{"version", 1}, {"command", "fluid --simulate"}};
  json["device"] = to_json(device);
  json["scene"] = {{"name", args.scene},
                   {"particles", fluid.report().particles},
                   {"spacing", scene.spacing},
                   {"tank", {scene.tank.x, scene.tank.y, scene.tank.z}}};
  json["options"] = output.shown_options;
  const std::string place = "frames go here";
  json["frames"] = place;
  json["ms"] = {{"simulate_median", spread_of(frames.step_ms()).median}};
  if (!frames.surface_ms().empty()) json["ms"]["surface_median"] = spread_of(frames.surface_ms()).median;
  json["memory"] = {{"host_peak_bytes", host_peak_bytes()}, {"device_peak_bytes", fluid.peak_bytes()}};
  std::string text = json_text(json);
  const std::string quoted = '"' + place + '"';
  text.replace(text.find(quoted), quoted.size(), "[" + frames.lines() + "\n  ]");
  write_file_atomically(output.report, text);
}

}  // namespace

OptionGroup simulation_options(SimulateArgs& args) {
  return {
      "Simulation",
      {option("--simulate SCENE", "simulate dam-break, double-dam-break, drop, obstacle or stir instead of reading IN",
              &args.scene, {"simulate", 1, kNeverNull}),
       option("--frames N", "frames to write, the first at rest; {} in names: number", &args.frames,
              {"frames", 3, kFromOne}),
       option("--particles N", "particles of the scene, 200 to 64000000", &args.particles,
              {"particles", 2, R"({"minimum": 200})"}),
       option("--fps F", "frames per simulated second", &args.fps, {"fps", 4, kFromOne}),
       option("--iterations N", "of the density constraint a substep, 1 to 100", &args.iterations,
              {"iterations", 5, kFromOne}),
       option("--viscosity C", "of XSPH, no unit, 0 to 1", &args.viscosity, {"viscosity", 6, kFromZero}),
       option("--vorticity E", "of vorticity confinement, no unit, 0: none", &args.vorticity,
              {"vorticity", 7, kFromZero}),
       option("--particles-out OUT", "particles of every frame: .ply with velocity_x, _y, _z", &args.particles_out,
              {"particles_out", 62})}};
}

int run_simulation(const SimulateArgs& args, const SimulateOutput& output) {
  const simulation::SceneKind kind = check(args, output);
  const simulation::SimulationOptions options = library_options(args);
  const Device device = output.device.chosen();
  if (output.warn) output.warn(device.kind == DeviceKind::cuda);
  on_interrupt(OnInterrupt::remember);
  simulation::Simulation fluid(simulation::make_scene(kind, args.particles), options, device);
  SimulatedFrames frames(args, output, fluid);
  {
    ProgressLine progress(!output.quiet && stderr_is_terminal());
    frames.run_all(progress);
  }
  if (!output.report.empty()) write_report(args, output, fluid, frames);
  if (output.quiet) return 0;
  const double step_ms = spread_of(frames.step_ms()).median;
  std::string text = fmt::format("{}{}: {} particles, {}; simulation: median {:.1f} ms",
                                 file_words(output.output.empty() ? args.particles_out : output.output), args.scene,
                                 fluid.report().particles, counted(args.frames, "frame"), step_ms);
  if (!frames.surface_ms().empty())
    text += fmt::format("; surface: median {:.1f} ms; the last one: triangles {}, {}",
                        spread_of(frames.surface_ms()).median, frames.mesh().triangles.size(),
                        shape_words(frames.mesh(), output.device.threads));
  print_note(text);
  return 0;
}

}  // namespace pointskin::cli
