// pointskin_scan MESH | --shape NAME -o OUT.ply: the cloud of a virtual range scanner.
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <cstdio>
#include <memory>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "rotated.hpp"
#include "scan.hpp"

namespace {

constexpr const char* kUsage =
    "usage: pointskin_scan (MESH | --shape NAME) -o OUT.ply [options]\n"
    "\n"
    "Takes depth images from several places and writes their points with normals, as binary PLY. Lengths are in units\n"
    "of the diagonal of the surface's box.\n"
    "  --shape            a shape that pointskin_generate knows\n"
    "  --rotation         turns MESH by one of two fixed rotations, 1 or 2\n"
    "  --views            16    places of the camera, even around the surface\n"
    "  --resolution       300   pixels along each side of a depth image\n"
    "  --distance         1.5   mean distance of the cameras\n"
    "  --spread           0.4   distances are 1 - spread to 1 + spread times that\n"
    "  --sigma            0     sigma of the noise along the ray\n"
    "  --misregistration  0     sigma of each view's shift, and of what its turn moves at half the diagonal\n"
    "  --outliers         0     share of points that are uniform in the box enlarged by a fifth\n"
    "  --grazing          75    degrees; points seen at a larger angle to their normal are dropped\n"
    "  --window           1     normals are fitted to (2 window + 1)^2 pixels of the noisy image\n"
    "  --exact-normals          normals of the surface instead\n"
    "  --normal-noise     0     sigma on each component of exact normals\n"
    "  --seed             1\n"
    "  --threads          0     CPU threads; 0: all\n";

int run(const std::vector<std::string>& words) {
  using namespace pointskin;
  bench::ScanOptions options;
  std::string mesh, shape, out;
  int rotation = 0;
  bench::Arguments arguments(words);
  const auto whole = [&] { return static_cast<int>(arguments.whole_number()); };
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return std::fputs(kUsage, stdout), 0;
    if (*word == "-o" || *word == "--out")
      out = arguments.value();
    else if (*word == "--shape")
      shape = arguments.value();
    else if (*word == "--rotation")
      rotation = whole();
    else if (*word == "--views")
      options.views = whole();
    else if (*word == "--resolution")
      options.resolution = whole();
    else if (*word == "--distance")
      options.distance = arguments.number();
    else if (*word == "--spread")
      options.spread = arguments.number();
    else if (*word == "--sigma")
      options.sigma = arguments.number();
    else if (*word == "--misregistration")
      options.misregistration = arguments.number();
    else if (*word == "--outliers")
      options.outliers = arguments.number();
    else if (*word == "--grazing")
      options.grazing = arguments.number();
    else if (*word == "--window")
      options.window = whole();
    else if (*word == "--exact-normals")
      options.normals = bench::ScanNormals::exact;
    else if (*word == "--normal-noise")
      options.normal_noise = arguments.number();
    else if (*word == "--seed")
      options.seed = static_cast<std::uint64_t>(arguments.whole_number());
    else if (*word == "--threads")
      options.threads = whole();
    else if (mesh.empty() && word->front() != '-')
      mesh = *word;
    else
      arguments.refuse();
  }
  if (out.empty() || mesh.empty() == shape.empty()) return std::fputs(kUsage, stderr), 2;
  const auto known = shape.empty() ? nullptr : bench::make_shape(shape);
  Mesh surface;
  if (!known) surface = read_mesh(mesh);
  if (rotation != 0) bench::rotate(surface, rotation);
  const auto scene = known ? bench::scene_of(*known) : bench::scene_of(surface);
  write_cloud(out, bench::scan(*scene, options), options.threads);
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return pointskin::bench::run_main("pointskin_scan", argc, argv, run); }
