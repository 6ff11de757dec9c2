// pointskin_bend: a cloud bent by 90 degrees, frame after frame; the mesh is copied to host memory.
#include <pointskin/deform.hpp>
#include <pointskin/io.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <numbers>
#include <string>
#include <vector>

#include "arguments.hpp"

namespace {

using namespace pointskin;

constexpr const char* kUsage =
    "usage: pointskin_bend CLOUD [--axis y] [--depth 8] [--frames 60] [--device auto|cpu|cuda] [--threads 0] "
    "[--check]\n"
    "\n"
    "Holds the lower third of a cloud, turns the upper third by 90 degrees, bends what is between, in equal steps "
    "from\n"
    "the rest pose on. Prints the median time of a frame, the slowest, and frames per second, with the copy of the "
    "mesh;\n"
    "then the parts of a frame. --check measures every mesh and the distances of its samples (not timed) and ends with "
    "1\n"
    "if one is not watertight, or 5 in 100 samples lie more than twice or less than half as far apart as at rest.\n";

/// The bend of the cloud's middle third along an axis.
Deformation bend(const Cloud& cloud, std::size_t axis) {
  const Bounds box = bounds_of(cloud.positions);
  const Vec3d lower{double{box.lower.x} + cloud.origin[0], double{box.lower.y} + cloud.origin[1],
                    double{box.lower.z} + cloud.origin[2]};
  const Vec3d upper{double{box.upper.x} + cloud.origin[0], double{box.upper.y} + cloud.origin[1],
                    double{box.upper.z} + cloud.origin[2]};
  Vec3d low{};
  Vec3d middle{};
  for (std::size_t a = 0; a < 3; ++a) middle[a] = (lower[a] + upper[a]) / 2;
  low = middle;
  low[axis] = lower[axis] + (upper[axis] - lower[axis]) / 3;
  Vec3d high = middle;
  high[axis] = lower[axis] + (upper[axis] - lower[axis]) * 2 / 3;
  Vec3d up{};
  up[axis] = 1;
  Vec3d down{};
  down[axis] = -1;
  RigidMotion turn;
  turn.axis = {};
  turn.axis[(axis + 1) % 3] = 1;
  turn.point = middle;
  turn.angle = std::numbers::pi / 2;
  return {{{HalfSpace{low, down}, RigidMotion{}}, {HalfSpace{high, up}, turn}}, {}};
}

struct BendArguments {
  std::string cloud, device = "auto";
  std::size_t axis = 1;
  int frames = 60, threads = 0;
  bool check = false;
  Options options;
};

/// Every frame's milliseconds; `failures` counts frames that are not as they should be.
std::vector<double> run_frames(Deformer& deformer, const Deformation& deformation, const BendArguments& given,
                               int& failures) {
  Mesh mesh;
  std::vector<double> milliseconds;
  for (int frame = 0; frame < given.frames; ++frame) {
    const Deformation part = scaled(deformation, static_cast<double>(frame) / std::max(given.frames - 1, 1));
    const auto start = std::chrono::steady_clock::now();
    deformer.deform(part);
    deformer.reconstruct(mesh);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    milliseconds.push_back(took.count());
    if (!given.check) continue;
    const MeshReport report = measure(mesh, given.threads);
    const SpacingRatios spacing = deformer.spacing();
    const bool good = report.watertight() && spacing.p05 > 0.5 && spacing.p95 < 2;
    failures += good ? 0 : 1;
    std::printf("frame %3d: %zu triangles, %s, inserted %lld, thinned %lld, spacing %.2f %.2f %.2f\n", frame,
                mesh.triangles.size(), report.watertight() ? "watertight" : "NOT watertight",
                static_cast<long long>(deformer.report().inserted), static_cast<long long>(deformer.report().thinned),
                spacing.p05, spacing.median, spacing.p95);
  }
  return milliseconds;
}

int run(const std::vector<std::string>& words) {
  BendArguments given;
  bench::Arguments arguments(words);
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return std::fputs(kUsage, stdout), 0;
    if (*word == "--axis")
      given.axis = std::min<std::size_t>(std::string("xyz").find(arguments.value()), 2);
    else if (*word == "--depth")
      given.options.depth = static_cast<int>(arguments.whole_number());
    else if (*word == "--frames")
      given.frames = static_cast<int>(std::max<std::int64_t>(1, arguments.whole_number()));
    else if (*word == "--device")
      given.device = arguments.value();
    else if (*word == "--threads")
      given.threads = static_cast<int>(arguments.whole_number());
    else if (*word == "--check")
      given.check = true;
    else if (word->front() != '-' && given.cloud.empty())
      given.cloud = *word;
    else
      arguments.refuse();
  }
  if (given.cloud.empty()) return std::fputs(kUsage, stderr), 2;

  const Cloud cloud = read_cloud(given.cloud);
  const Deformation deformation = bend(cloud, given.axis);
  Deformer deformer(cloud, given.options, Device::parse(given.device, given.threads));
  Mesh warm;
  deformer.deform(deformation);
  deformer.reconstruct(warm);
  int failures = 0;
  std::vector<double> milliseconds = run_frames(deformer, deformation, given, failures);
  std::sort(milliseconds.begin(), milliseconds.end());
  const double median = milliseconds[milliseconds.size() / 2];
  const DeformReport& report = deformer.report();
  std::printf("%lld points, depth %d, %d frames on %s: median %.2f ms, slowest %.2f ms, %.1f frames/s\n",
              static_cast<long long>(report.points), given.options.depth, given.frames,
              deformer.device().name().c_str(), median, milliseconds.back(), 1000 / median);
  std::printf(
      "last frame: sample %.2f, map %.2f, octree %.2f, splat %.2f, solve %.2f, extract %.2f, download %.2f ms\n",
      report.sample_ms, report.map_ms, report.run.octree_ms, report.run.splat_ms, report.run.solve_ms,
      report.run.extract_ms, report.run.download_ms);
  return failures == 0 ? 0 : 1;
}

}  // namespace

int main(int argc, char** argv) { return bench::run_main("pointskin_bend", argc, argv, run); }
