// pointskin fluid: particles of a simulation, frame after frame, to meshes.
#include <algorithm>
#include <memory>
#include <mutex>
#include <string>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <pointskin/error.hpp>
#include <pointskin/fluid.hpp>
#include <pointskin/io.hpp>

#include "args.hpp"
#include "at_once.hpp"
#include "commands.hpp"
#include "console.hpp"
#include "file_plan.hpp"
#include "fluid_args.hpp"
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

/// One frame and what became of it.
struct FluidFrameRecord {
  scene::FrameFile input;
  std::string output;
  bool is_last = false;
  std::string shape;  ///< of the last mesh, in words
  std::int64_t particles = 0, dropped = 0, triangles = 0;
  FluidReport run;
  MeshReport mesh;  ///< with --report
  double read_ms = 0, surface_ms = 0, write_ms = 0, total_ms = 0;
};

/// A frame may take the place of its own particles; those of the others are still to be read.
void check_names(const FluidArgs& args, const std::vector<FluidFrameRecord>& frames) {
  FilePlan plan{{}, {{"--report", args.report, OutputKind::report}}, args.overwrite};
  for (const FluidFrameRecord& frame : frames) plan.add_frame(frame.input.path, frame.output, OutputKind::result);
  check_files(plan);
}

void check_outputs(const FluidArgs& args, const std::vector<FluidFrameRecord>& frames) {
  scene::check_patterns(args.input, args.output, "-o");
  check_mesh_output(frames.front().output);
  check_names(args, frames);
  if (!args.report.empty()) check_replaceable(args.report);
}

/// Reads, makes and writes frames, with memory that is used again. One a thread.
class FluidWorker {
 public:
  FluidWorker(const FluidArgs& args, const FluidOptions& options, const Device& device)
      : args_(args), options_(options), surfacer_(device), threads_(device.threads) {}

  void run(FluidFrameRecord& frame) {
    throw_if_interrupted();
    const Stopwatch start;
    const Cloud cloud = read_cloud(frame.input.path, {.shift = parse_shift(args_.shift), .threads = threads_});
    frame.particles = cloud.size();
    frame.dropped = cloud.dropped;
    frame.read_ms = start.ms();
    throw_if_interrupted();
    const Stopwatch made;
    try {
      surfacer_.surface(cloud, options_, mesh_);
    } catch (const Error& error) {
      throw Error(error.code(), fmt::format("{}: {}", frame.input.path, error.what()));
    }
    frame.run = surfacer_.report();
    frame.triangles = static_cast<std::int64_t>(mesh_.triangles.size());
    frame.surface_ms = made.ms();
    throw_if_interrupted();
    const Stopwatch writing;
    write_mesh(frame.output, mesh_, threads_);
    frame.write_ms = writing.ms();
    if (!frame.input.number.empty())
      frame_was_written();
    else
      file_was_written();
    if (frame.input.number.empty() && args_.report.empty()) ignore_interrupts();
    frame.total_ms = start.ms();
    if (!args_.report.empty()) frame.mesh = measure(mesh_, threads_);
    if (frame.is_last && !args_.quiet)
      frame.shape = args_.report.empty() ? shape_words(mesh_, threads_) : shape_words(frame.mesh);
  }

 private:
  const FluidArgs& args_;
  FluidOptions options_;
  FluidSurfacer surfacer_;
  int threads_;
  Mesh mesh_;
};

/// All frames: the first alone, so that the memory of one is known, then as many together as fit.
class Sequence {
 public:
  Sequence(const FluidArgs& args, const FluidOptions& options, const Device& device,
           std::vector<FluidFrameRecord>& frames)
      : args_(args), options_(options), device_(device), frames_(frames), line_(!args.quiet && stderr_is_terminal()) {}

  /// @throws the error of the first frame that failed
  void run() {
    {
      FluidWorker first(args_, options_, device_);
      first.run(frames_.front());
      done(frames_.front());
      at_once_ = frames_at_once();
      if (at_once_ == 1)
        for (std::size_t i = 1; i < frames_.size(); ++i) {
          first.run(frames_[i]);
          done(frames_[i]);
        }
    }
    if (at_once_ > 1) run_together();
    line_.clear();
  }

  [[nodiscard]] int at_once() const { return at_once_; }

 private:
  void done(const FluidFrameRecord& frame) {
    const std::lock_guard lock(mutex_);
    if (frame.dropped > 0)
      print_warning(fmt::format("{}: {} particles were dropped: a coordinate is not finite, or beyond 1e38",
                                frame.input.path, frame.dropped));
    ++done_;
    line_.update({"frames", static_cast<double>(done_) / static_cast<double>(frames_.size())});
  }

  /// A GPU works on one frame after another.
  [[nodiscard]] int frames_at_once() const {
    const auto left = static_cast<std::int64_t>(frames_.size()) - 1;
    if (device_.kind == DeviceKind::cuda || left < 2) return 1;
    const std::int64_t wanted = args_.at_once > 0 ? args_.at_once : thread_count(args_.threads);
    const std::int64_t memory =
        args_.max_memory.empty() ? device_.available_bytes() / 5 * 4 : parse_bytes(args_.max_memory, "--max-memory");
    // Frames grow: half as much again, and the file, the particles and the mesh on the host.
    const FluidFrameRecord& first = frames_.front();
    const std::int64_t each =
        first.run.device_peak_bytes * 3 / 2 + 64 * first.particles + 64 * first.triangles + (std::int64_t{1} << 20);
    return static_cast<int>(std::clamp<std::int64_t>(std::min(memory / each, left), 1, wanted));
  }

  void run_together() {
    const Device share = Device::cpu(std::max(1, thread_count(args_.threads) / at_once_));
    run_at_once(1, frames_.size(), at_once_, [&] {
      return [this, worker = std::make_unique<FluidWorker>(args_, options_, share)](std::size_t i) {
        worker->run(frames_[i]);
        done(frames_[i]);
      };
    });
  }

  const FluidArgs& args_;
  const FluidOptions& options_;
  const Device& device_;
  std::vector<FluidFrameRecord>& frames_;
  ProgressLine line_;
  std::mutex mutex_;
  std::size_t done_ = 0;
  int at_once_ = 1;
};

Json frame_json(const FluidFrameRecord& frame) {
  const FluidReport& run = frame.run;
  Json mesh = to_json(frame.mesh);
  mesh["volume"] = frame.mesh.volume;
  return {{"input", frame.input.path},
          {"output", frame.output},
          {"particles", frame.particles},
          {"dropped", frame.dropped},
          {"depth", run.depth},
          {"corners", {{"coarse", run.coarse_corners}, {"fine", run.fine_corners}}},
          {"rounds", run.rounds},
          {"removed_components", run.removed_components},
          {"mesh", mesh},
          {"ms",
           {{"read", frame.read_ms},
            {"upload", run.upload_ms},
            {"particles", run.particles_ms},
            {"field", run.field_ms},
            {"extract", run.extract_ms},
            {"finish", run.finish_ms},
            {"download", run.download_ms},
            {"surface", frame.surface_ms},
            {"write", frame.write_ms},
            {"total", frame.total_ms}}}};
}

void write_report(const FluidArgs& args, const Device& device, const std::vector<FluidFrameRecord>& frames, int at_once,
                  double total_ms) {
  Json json = {{"version", 1}, {"command", "fluid"}};
  json["device"] = to_json(device);
  json["options"] = report_of(fluid_options, args);
  json["at_once"] = at_once;
  json["frames"] = Json::array();
  std::int64_t peak = 0;
  std::vector<double> surface_ms;
  for (const FluidFrameRecord& frame : frames) {
    json["frames"].push_back(frame_json(frame));
    peak = std::max(peak, frame.run.device_peak_bytes);
    surface_ms.push_back(frame.surface_ms);
  }
  json["ms"] = {{"surface_median", spread_of(surface_ms).median}, {"total", total_ms}};
  json["memory"] = {{"host_peak_bytes", host_peak_bytes()}, {"device_peak_bytes", peak}};
  write_file_atomically(args.report, json_text(json));
}

/// What CLI11 cannot know: which of the options belong together.
void check_given(const FluidArgs& args) {
  const bool simulates = !args.simulation.scene.empty();
  if (simulates && !args.input.empty())
    throw_usage(args.input + " is not read because of --simulate; leave one of them out");
  if (simulates && (args.first || args.last))
    throw_usage("--first and --last belong to sequences of files; use --frames");
  if (simulates) return;
  if (args.input.empty()) throw_usage("IN is required: particles of a frame, or --simulate SCENE");
  if (args.output.empty()) throw_usage("--output is required");
  if (args.options.particle_radius == 0)
    throw_usage("particle_radius is required and must be positive: --particle-radius R");
  if (!args.simulation.particles_out.empty()) throw_usage("--particles-out needs --simulate");
}

int run(const FluidArgs& args) {
  const Stopwatch start;
  check_given(args);
  const FluidOptions options = library_options(args);
  if (!args.simulation.scene.empty())
    return run_simulation(args.simulation, {args.output, args.report, args, args.quiet, options,
                                            [&args](bool on_gpu) { warn_about_unused(args, on_gpu); },
                                            report_of(simulation_report_options, args)});
  parse_shift(args.shift);
  if (!args.max_memory.empty()) parse_bytes(args.max_memory, "--max-memory");
  if (args.at_once < 0 || args.at_once > 4096)
    throw_usage(fmt::format("--at-once: {} is not in [0, 4096]", args.at_once));
  const Device device = args.chosen();
  std::vector<FluidFrameRecord> frames;
  for (scene::FrameFile& file : scene::find_frames(args.input, args.first, args.last)) {
    frames.emplace_back();
    frames.back().output = scene::with_number(args.output, file.number);
    frames.back().input = std::move(file);
  }
  check_outputs(args, frames);
  warn_about_unused(args, device.kind == DeviceKind::cuda);
  frames.back().is_last = true;

  on_interrupt(OnInterrupt::remember);
  Sequence sequence(args, options, device, frames);
  sequence.run();
  const double total_ms = start.ms();
  if (!args.report.empty()) write_report(args, device, frames, sequence.at_once(), total_ms);
  if (args.quiet) return 0;
  std::vector<double> surface_ms;
  for (const FluidFrameRecord& frame : frames) surface_ms.push_back(frame.surface_ms);
  const FluidFrameRecord& last = frames.back();
  print_note(fmt::format("{}{}particles {}, depth {}, triangles {}, {}; ms: surface {:.1f}{}, total {:.1f}; {} at once",
                         file_words(args.output),
                         frames.size() > 1 ? fmt::format("frames {}; the last one: ", frames.size()) : "",
                         last.particles, last.run.depth, last.triangles, last.shape, spread_of(surface_ms).median,
                         frames.size() > 1 ? " in the middle" : "", total_ms, sequence.at_once()));
  return 0;
}

}  // namespace

Command fluid_command() {
  return make_command({"fluid", "Make closed meshes of a simulation's particles."}, fluid_options, run);
}

}  // namespace pointskin::cli
