// pointskin_frames: moving points, reconstructed frame after frame; upload and download of the mesh included.
#include <pointskin/reconstruct.hpp>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "shapes.hpp"

namespace {

using namespace pointskin;

constexpr const char* kUsage =
    "usage: pointskin_frames [SHAPE] [--points 500000] [--depth 8] [--frames 100] [--device auto|cpu|cuda] [--threads "
    "0]\n"
    "\n"
    "Twists points of a shape of pointskin_generate (default: knot) and reconstructs every frame from host\n"
    "memory to host memory. Prints the median time of a frame, the slowest, and frames per second.\n";

/// The cloud twisted about the z axis by `angle` radians per unit of height. Normals follow the twist's Jacobian.
Cloud twisted(const Cloud& cloud, double angle) {
  Cloud result = cloud;
  for (std::size_t i = 0; i < cloud.positions.size(); ++i) {
    const Vec3f p = cloud.positions[i];
    const Vec3f n = cloud.normals[i];
    const auto c = static_cast<float>(std::cos(angle * p.z));
    const auto s = static_cast<float>(std::sin(angle * p.z));
    const Vec3f q{c * p.x - s * p.y, s * p.x + c * p.y, p.z};
    const Vec3f turned{c * n.x - s * n.y, s * n.x + c * n.y, n.z};
    const auto along = static_cast<float>(angle) * (q.y * turned.x - q.x * turned.y);
    const Vec3f m{turned.x, turned.y, turned.z + along};
    const float length = std::sqrt(m.x * m.x + m.y * m.y + m.z * m.z);
    result.positions[i] = q;
    result.normals[i] = {m.x / length, m.y / length, m.z / length};
  }
  return result;
}

Device device_of(const std::string& name, int threads) {
  if (name == "cpu") return Device::cpu(threads);
  return name == "cuda" ? Device::cuda(0) : Device::automatic();
}

int run(const std::vector<std::string>& words) {
  bench::SamplingOptions sampling;
  std::string shape = "knot", device = "auto";
  int frames = 100;
  Options options;
  bench::Arguments arguments(words);
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return std::fputs(kUsage, stdout), 0;
    if (*word == "--points")
      sampling.points = arguments.whole_number();
    else if (*word == "--depth")
      options.depth = static_cast<int>(arguments.whole_number());
    else if (*word == "--frames")
      frames = static_cast<int>(arguments.whole_number());
    else if (*word == "--device")
      device = arguments.value();
    else if (*word == "--threads")
      sampling.threads = static_cast<int>(arguments.whole_number());
    else if (word->front() != '-')
      shape = *word;
    else
      arguments.refuse();
  }
  constexpr int kPoses = 8;  // frames go round through them: what moves must not be computed within a frame
  const Cloud cloud = bench::sample_surface(*bench::make_shape(shape), sampling);
  std::vector<Cloud> poses;
  for (int i = 0; i < kPoses; ++i) poses.push_back(twisted(cloud, 0.1 * i));

  Reconstructor reconstructor(device_of(device, sampling.threads));
  Mesh mesh;
  std::vector<double> milliseconds;
  for (int frame = -kPoses; frame < frames; ++frame) {  // the first round warms up
    const auto start = std::chrono::steady_clock::now();
    reconstructor.reconstruct(poses[static_cast<std::size_t>(frame + kPoses) % kPoses], options, mesh);
    const std::chrono::duration<double, std::milli> took = std::chrono::steady_clock::now() - start;
    if (frame >= 0) milliseconds.push_back(took.count());
  }
  std::sort(milliseconds.begin(), milliseconds.end());
  const double median = milliseconds[milliseconds.size() / 2];
  const RunReport& report = reconstructor.report();
  std::printf("%zu points, depth %d, %zu triangles, %d frames: median %.2f ms, slowest %.2f ms, %.1f frames/s\n",
              cloud.positions.size(), options.depth, mesh.triangles.size(), frames, median, milliseconds.back(),
              1000 / median);
  std::printf("last frame: upload %.2f, octree %.2f, splat %.2f, solve %.2f, extract %.2f, download %.2f ms\n",
              report.upload_ms, report.octree_ms, report.splat_ms, report.solve_ms, report.extract_ms,
              report.download_ms);
  return 0;
}

}  // namespace

int main(int argc, char** argv) {
  try {
    return run({argv + 1, argv + argc});
  } catch (const std::exception& error) {
    std::fprintf(stderr, "pointskin_frames: %s\n", error.what());
    return 1;
  }
}
