// pointskin_fluid_frames: a simulated fluid, frame after frame, alone and with its surface.
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include <algorithm>
#include <charconv>
#include <chrono>
#include <cstdio>
#include <string>
#include <utility>
#include <vector>

#include <nlohmann/json.hpp>

#include <pointskin/simulation.hpp>
#include "arguments.hpp"

namespace {

using namespace pointskin;
using Json = nlohmann::ordered_json;

constexpr const char* kUsage =
    "usage: pointskin_fluid_frames [SCENE] [--particles N,N,...] [--frames 60] [--settle 30] [--cube-size 1] [--fps "
    "60]\n"
    "                              [--iterations 4] [--device auto|cpu|cuda] [--threads 0] [--json FILE] [--check]\n"
    "\n"
    "Runs a scene (default: dam-break) for every number of particles (default: 8K to 8M, on a CPU to 128K): --settle\n"
    "frames that do not count, then --frames of simulation alone, then as many with surfaces. Prints the medians of a\n"
    "frame in milliseconds, the slowest, and frames per second; meshes are copied to host memory. --cube-size is in\n"
    "particle radii. --json writes the same to a file. --check looks at every mesh (not timed) and ends with 1 if one "
    "is\n"
    "not watertight or a particle is lost.\n";

struct Given {
  std::string scene = "dam-break", device = "auto", json;
  std::vector<std::int64_t> particles;
  int frames = 60, settle = 30, threads = 0;
  double fps = 60;
  bool check = false;
  simulation::SimulationOptions options;
  FluidOptions surface;
};

struct Spread {
  double median = 0, slowest = 0;
};

Spread spread_of(std::vector<double> ms) {
  std::sort(ms.begin(), ms.end());
  return {ms[ms.size() / 2], ms.back()};
}

/// Milliseconds of `work`.
template <class Work>
double time_of(const Work& work) {
  const auto start = std::chrono::steady_clock::now();
  work();
  return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - start).count();
}

Json run_one(const Given& given, const simulation::Scene& scene, const Device& device, int& failures) {
  simulation::Simulation fluid(scene, given.options, device);
  Mesh mesh;
  for (int frame = 0; frame < given.settle; ++frame) fluid.step(1 / given.fps);
  fluid.surface(given.surface, mesh);
  std::vector<double> alone;
  std::vector<double> both;
  std::vector<double> step;
  std::vector<double> download;
  int substeps = 0;
  for (int frame = 0; frame < given.frames; ++frame) {
    alone.push_back(time_of([&] { fluid.step(1 / given.fps); }));
    substeps += fluid.report().substeps;
  }
  for (int frame = 0; frame < given.frames; ++frame) {
    both.push_back(time_of([&] {
      fluid.step(1 / given.fps);
      fluid.surface(given.surface, mesh);
    }));
    step.push_back(fluid.report().ms);
    download.push_back(fluid.surface_report().download_ms);
    if (given.check && (!measure(mesh, given.threads).watertight() || fluid.report().lost > 0)) ++failures;
  }
  const Spread a = spread_of(alone);
  const Spread b = spread_of(both);
  return {{"particles", fluid.report().particles},
          {"depth", fluid.surface_report().depth},
          {"triangles", mesh.triangles.size()},
          {"substeps", static_cast<double>(substeps) / given.frames},
          {"simulation_ms", {{"median", a.median}, {"slowest", a.slowest}}},
          {"simulation_fps", 1000 / a.median},
          {"with_surface_ms", {{"median", b.median}, {"slowest", b.slowest}}},
          {"with_surface_fps", 1000 / b.median},
          {"with_surface_parts_ms", {{"simulation", spread_of(step).median}, {"download", spread_of(download).median}}},
          {"mean_density_error", fluid.report().mean_density_error},
          {"lost", fluid.report().lost},
          {"device_peak_bytes", fluid.peak_bytes()}};
}

std::vector<std::int64_t> parse_list(const std::string& text) {
  std::vector<std::int64_t> out;
  for (std::size_t from = 0; from <= text.size();) {
    const std::size_t comma = std::min(text.find(',', from), text.size());
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data() + from, text.data() + comma, value);
    if (error != std::errc() || end != text.data() + comma)
      throw Error(ErrorCode::usage, "'" + text + "' after --particles is no list of whole numbers");
    out.push_back(value);
    from = comma + 1;
  }
  return out;
}

bool parse(const std::vector<std::string>& words, Given& given) {
  given.surface.cube_size = 1;
  bench::Arguments arguments(words);
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return false;
    if (*word == "--particles")
      given.particles = parse_list(arguments.value());
    else if (*word == "--frames")
      given.frames = static_cast<int>(std::max<std::int64_t>(1, arguments.whole_number()));
    else if (*word == "--settle")
      given.settle = static_cast<int>(arguments.whole_number());
    else if (*word == "--cube-size")
      given.surface.cube_size = arguments.number();
    else if (*word == "--fps")
      given.fps = arguments.number();
    else if (*word == "--iterations")
      given.options.iterations = static_cast<int>(arguments.whole_number());
    else if (*word == "--device")
      given.device = arguments.value();
    else if (*word == "--threads")
      given.threads = static_cast<int>(arguments.whole_number());
    else if (*word == "--json")
      given.json = arguments.value();
    else if (*word == "--check")
      given.check = true;
    else if (word->front() != '-')
      given.scene = *word;
    else
      arguments.refuse();
  }
  return true;
}

int run(const std::vector<std::string>& words) {
  Given given;
  if (!parse(words, given)) return std::fputs(kUsage, stdout), 0;
  const auto kind = simulation::parse_scene(given.scene);
  if (!kind) throw Error(ErrorCode::usage, "'" + given.scene + "' is no scene; see --help");
  const Device device = Device::parse(given.device, given.threads);
  if (given.particles.empty()) {
    given.particles = {8'192, 32'768, 131'072};
    if (device.kind == DeviceKind::cuda) given.particles.insert(given.particles.end(), {1'048'576, 8'388'608});
  }
  std::printf("%s on %s, %d frames of 1/%g s, cells of %g particle radii\n", given.scene.c_str(), device.name().c_str(),
              given.frames, given.fps, given.surface.cube_size);
  std::printf("%10s %9s %12s %9s %14s %9s %10s %9s\n", "particles", "substeps", "simulation", "frames/s",
              "with surface", "frames/s", "triangles", "MB");
  Json results = Json::array();
  int failures = 0;
  for (const std::int64_t particles : given.particles) {
    const Json r = run_one(given, simulation::make_scene(*kind, particles), device, failures);
    std::printf("%10lld %9.1f %9.2f ms %9.1f %11.2f ms %9.1f %10lld %9.0f\n", static_cast<long long>(particles),
                r["substeps"].get<double>(), r["simulation_ms"]["median"].get<double>(),
                r["simulation_fps"].get<double>(), r["with_surface_ms"]["median"].get<double>(),
                r["with_surface_fps"].get<double>(), r["triangles"].get<long long>(),
                r["device_peak_bytes"].get<double>() / 1e6);
    std::fflush(stdout);
    results.push_back(r);
  }
  if (!given.json.empty()) {
    const Json all = {{"version", 1},
                      {"scene", given.scene},
                      {"device", device.name()},
                      {"frames", given.frames},
                      {"fps", given.fps},
                      {"iterations", given.options.iterations},
                      {"cube_size", given.surface.cube_size},
                      {"results", results}};
    write_file_atomically(given.json, all.dump(2) + "\n");
  }
  if (given.check) std::printf("%d frames were not as they should be\n", failures);
  return failures == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) { return bench::run_main("pointskin_fluid_frames", argc, argv, run); }
