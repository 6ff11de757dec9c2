// pointskin_scale: a cloud reconstructed in blocks, sweep by sweep.
#include <sys/resource.h>

#include <algorithm>
#include <chrono>
#include <cstdio>
#include <filesystem>
#include <memory>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/device.hpp>

#include "arguments.hpp"
#include "exec/any_space.hpp"
#include "exec/cpu.hpp"
#include "io/cloud_parts.hpp"
#include "octree/frame.hpp"
#include "scale/block_run.hpp"
#include "scale/cloud_extent.hpp"
#include "scale/sorted_cloud.hpp"
#include "scale/write_blocks.hpp"

namespace {

using namespace pointskin;

constexpr const char* kUsage =
    "usage: pointskin_scale CLOUD [--depth 8] [--memory 1000] [--coarse-level K] [--blocks N] [--ring R]\n"
    "                       [--threads 0] [--device cpu] [--temp DIR] [-o MESH.ply]\n"
    "\n"
    "Reads a binary PLY or NPY file in parts, sorts its points on the disk, and reconstructs them in blocks, as many\n"
    "as so many MB of memory ask for unless they are named: of the process, or of the GPU that works on them. Prints\n"
    "what each sweep takes, how large blocks are with their rings, and the largest resident set.\n";

double seconds_since(std::chrono::steady_clock::time_point begin) {
  return std::chrono::duration<double>(std::chrono::steady_clock::now() - begin).count();
}

double peak_megabytes() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  return static_cast<double>(usage.ru_maxrss) / 1e3;
}

int run(const std::vector<std::string>& words) {
  scale::BlockOptions options;
  options.folder = std::filesystem::temp_directory_path().string();
  std::string path, output, device = "cpu";
  std::int64_t megabytes = 1000;
  int threads = 0;
  bench::Arguments arguments(words);
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return std::fputs(kUsage, stdout), 0;
    if (*word == "--depth")
      options.depth = static_cast<int>(arguments.whole_number());
    else if (*word == "--coarse-level")
      options.coarse_level = static_cast<int>(arguments.whole_number());
    else if (*word == "--blocks")
      options.blocks = static_cast<int>(arguments.whole_number());
    else if (*word == "--ring")
      options.ring = static_cast<int>(arguments.whole_number());
    else if (*word == "--memory")
      megabytes = arguments.whole_number();
    else if (*word == "--threads")
      threads = static_cast<int>(arguments.whole_number());
    else if (*word == "--device")
      device = arguments.value();
    else if (*word == "-o")
      output = arguments.value();
    else if (*word == "--temp")
      options.folder = arguments.value();
    else
      path = *word;
  }
  constexpr std::int64_t kProgram = 64;  // MB, and some room
  const std::int64_t bytes = std::max<std::int64_t>(1, megabytes - kProgram) * 1'000'000;
  options.memory_bytes = bytes;
  options.part_samples = std::max<std::int64_t>(1 << 14, bytes / 1000);  // of 60 bytes, and of bricks around each
  exec::Cpu ex(threads);
  const auto parts = io::CloudParts::open(ex, path);
  if (parts == nullptr) return std::fprintf(stderr, "%s cannot be read in parts\n", path.c_str()), 1;
  const auto begin = std::chrono::steady_clock::now();
  parts->choose_origin(ex, std::nullopt);
  scale::CloudExtent extent = scale::find_extent(ex, *parts, false);
  std::sort(extent.strays.indices.begin(), extent.strays.indices.end());
  const octree::Frame frame = octree::frame_around(extent.strays.core, 1.1);
  std::printf("%-14s %8.2f s\n", "extent", seconds_since(begin));
  const auto sort_begin = std::chrono::steady_clock::now();
  const scale::SortedCloud cloud(ex, *parts, {options.folder, bytes / 8, frame, extent.strays.indices});
  std::printf("%-14s %8.2f s, %.0f MB resident at most\n", "sort", seconds_since(sort_begin), peak_megabytes());
  scale::BlockReport report;
  std::optional<exec::AnySpace> gpu;
  if (device != "cpu") gpu.emplace(Device::parse(device));
  const scale::BlockMeshes meshes = gpu ? scale::reconstruct_blocks(*gpu, ex, cloud, options, report)
                                        : scale::reconstruct_blocks(ex, cloud, options, report);
  for (const scale::BlockReport::Sweep& sweep : report.sweeps)
    std::printf("%-14s %8.2f s\n", sweep.name, sweep.seconds);
  const auto write_begin = std::chrono::steady_clock::now();
  if (!output.empty()) {
    scale::write_ply(ex, meshes, {}, frame, parts->origin(), output);
    std::printf("%-14s %8.2f s\n", "write", seconds_since(write_begin));
  }
  std::printf("%-14s %8.2f s\n", "all", seconds_since(begin));
  std::printf(
      "samples %lld, read %.2f times; largest block %lld samples, %lld nodes; %d blocks, K %d with %lld nodes\n",
      static_cast<long long>(cloud.size()),
      static_cast<double>(report.samples_read) / static_cast<double>(cloud.size()),
      static_cast<long long>(report.most_samples), static_cast<long long>(report.most_nodes), report.blocks,
      report.coarse_level, static_cast<long long>(report.coarse_nodes));
  std::printf("vertices %lld, triangles %lld, isovalue %.9g; %.0f MB resident at most\n",
              static_cast<long long>(meshes.vertices()), static_cast<long long>(meshes.triangles()), report.isovalue,
              peak_megabytes());
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return pointskin::bench::run_main("pointskin_scale", argc, argv, run); }
