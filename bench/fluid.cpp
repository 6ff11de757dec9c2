// pointskin_fluid: a wave of particles, a surface frame after frame; upload and download included.
#include <pointskin/fluid.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "arguments.hpp"

namespace {

using namespace pointskin;

constexpr const char* kUsage =
    "usage: pointskin_fluid [--particles 32768] [--cube-size 1] [--kernel isotropic|anisotropic] [--smoothing 0]\n"
    "                       [--frames 50] [--device auto|cpu|cuda] [--threads 0]\n"
    "\n"
    "Makes surfaces of a pool of particles with a wave that runs through it and drops above it. Prints the median "
    "time\n"
    "of a frame, the slowest, frames per second, and the phases of the last frame.\n";

/// A pool of about n particles of radius 1, four times as wide as deep, its surface a wave; and one drop in a hundred.
Cloud pool(std::int64_t n, double phase) {
  const double depth = std::cbrt(static_cast<double>(n) / 16);
  const auto side = static_cast<int>(4 * depth);
  Cloud cloud;
  std::uint64_t state = 12345;
  const auto random = [&] {
    state = state * 6364136223846793005ULL + 1442695040888963407ULL;
    return static_cast<double>(state >> 40) * 0x1p-24 - 0.5;
  };
  for (int x = 0; x < side; ++x)
    for (int y = 0; y < side; ++y) {
      const double top = depth * (1 + 0.3 * std::sin(2 * 3.141592653589793 * x / side + phase));
      for (int z = 0; z < top; ++z)
        cloud.positions.push_back({static_cast<float>(2 * x + 0.4 * random()),
                                   static_cast<float>(2 * y + 0.4 * random()),
                                   static_cast<float>(2 * z + 0.4 * random())});
      if ((x * side + y) % 13 == 0)
        cloud.positions.push_back(
            {static_cast<float>(2 * x), static_cast<float>(2 * y), static_cast<float>(2 * top + 8 + 6 * random())});
    }
  return cloud;
}

int run(const std::vector<std::string>& words) {
  std::string device = "auto";
  std::int64_t particles = 32768;
  int frames = 50;
  int threads = 0;
  FluidOptions options;
  options.particle_radius = 1;
  options.cube_size = 1;
  bench::Arguments arguments(words);
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return std::fputs(kUsage, stdout), 0;
    if (*word == "--particles")
      particles = arguments.whole_number();
    else if (*word == "--cube-size")
      options.cube_size = arguments.number();
    else if (*word == "--kernel")
      options.kernel = arguments.value() == "anisotropic" ? FluidKernel::anisotropic : FluidKernel::isotropic;
    else if (*word == "--smoothing")
      options.smoothing_iterations = static_cast<int>(arguments.whole_number());
    else if (*word == "--frames")
      frames = static_cast<int>(arguments.whole_number());
    else if (*word == "--device")
      device = arguments.value();
    else if (*word == "--threads")
      threads = static_cast<int>(arguments.whole_number());
    else
      arguments.refuse();
  }
  constexpr int kPoses = 4;
  std::vector<Cloud> poses;
  for (int i = 0; i < kPoses; ++i) poses.push_back(pool(particles, 1.5 * i));
  FluidSurfacer surfacer(Device::parse(device, threads));
  Mesh mesh;
  std::vector<double> milliseconds;
  for (int frame = -kPoses; frame < frames; ++frame) {  // the first round warms up
    const auto start = std::chrono::steady_clock::now();
    surfacer.surface(poses[static_cast<std::size_t>(frame + kPoses) % kPoses], options, mesh);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    if (frame >= 0) milliseconds.push_back(took.count());
  }
  std::sort(milliseconds.begin(), milliseconds.end());
  const double median = milliseconds.empty() ? 0 : milliseconds[milliseconds.size() / 2];
  const FluidReport& report = surfacer.report();
  std::printf("%lld particles, depth %d, %zu triangles, %d frames: median %.2f ms, slowest %.2f ms, %.1f frames/s\n",
              static_cast<long long>(report.particles), report.depth, mesh.triangles.size(), frames, median,
              milliseconds.empty() ? 0 : milliseconds.back(), 1000 / median);
  std::printf(
      "last frame: upload %.2f, particles %.2f, field %.2f, extract %.2f, finish %.2f, download %.2f ms; "
      "%lld coarse and %lld fine corners\n",
      report.upload_ms, report.particles_ms, report.field_ms, report.extract_ms, report.finish_ms, report.download_ms,
      static_cast<long long>(report.coarse_corners), static_cast<long long>(report.fine_corners));
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return pointskin::bench::run_main("pointskin_fluid", argc, argv, run); }
