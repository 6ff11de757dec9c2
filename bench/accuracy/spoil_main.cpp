// pointskin_spoil CLOUD -o OUT.ply: a cloud with the faults of real ones.
#include <pointskin/io.hpp>

#include <cstdio>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "mesh_points.hpp"
#include "rotated.hpp"
#include "shapes.hpp"
#include "spoil.hpp"

namespace {

constexpr const char* kUsage =
    "usage: pointskin_spoil (CLOUD | (--shape NAME | --mesh MESH) [--points 100000]) -o OUT.ply [options]\n"
    "\n"
    "Writes a cloud with faults, as binary PLY. Lengths are in units of the diagonal of the points' box, shares of 1.\n"
    "Faults come in this order:\n"
    "  --shape              a shape that pointskin_generate knows, instead of a file\n"
    "  --mesh               a mesh, of which points are drawn with the normals of its triangles\n"
    "  --rotation       0   turns that mesh by one of two fixed rotations, 1 or 2\n"
    "  --outside            only points that look away from the middle of the box\n"
    "  --density-ratio  1   along the longest side, the densest end to the thinnest\n"
    "  --holes          0   share of the points that is cut out\n"
    "  --hole-count     5   of so many places\n"
    "  --lines          0   distance of scan lines to which points are moved\n"
    "  --keep           0   so many points, drawn at random; 0: all\n"
    "  --sigma          0   of the Gaussian noise on each coordinate\n"
    "  --normal-noise   0   sigma on each component of the unit normal\n"
    "  --flipped        0   share of the normals that is turned round\n"
    "  --quantum        0   coordinates are multiples of it\n"
    "  --outliers       0   share of the result that is outliers, with random normals\n"
    "  --clusters       0   in so many balls; 0: uniform in the box enlarged by a fifth\n"
    "  --seed           1\n";

int run(const std::vector<std::string>& words) {
  using namespace pointskin;
  bench::SpoilOptions options;
  bench::SamplingOptions sampling{.points = 100'000};
  std::string in, shape, mesh, out;
  int rotation = 0;
  bench::Arguments arguments(words);
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return std::fputs(kUsage, stdout), 0;
    if (*word == "-o" || *word == "--out")
      out = arguments.value();
    else if (*word == "--shape")
      shape = arguments.value();
    else if (*word == "--mesh")
      mesh = arguments.value();
    else if (*word == "--rotation")
      rotation = static_cast<int>(arguments.whole_number());
    else if (*word == "--points")
      sampling.points = arguments.whole_number();
    else if (*word == "--outside")
      options.outside = true;
    else if (*word == "--density-ratio")
      options.density_ratio = arguments.number();
    else if (*word == "--holes")
      options.holes = arguments.number();
    else if (*word == "--hole-count")
      options.hole_count = static_cast<int>(arguments.whole_number());
    else if (*word == "--lines")
      options.lines = arguments.number();
    else if (*word == "--keep")
      options.keep = arguments.whole_number();
    else if (*word == "--sigma")
      options.sigma = arguments.number();
    else if (*word == "--normal-noise")
      options.normal_noise = arguments.number();
    else if (*word == "--flipped")
      options.flipped = arguments.number();
    else if (*word == "--quantum")
      options.quantum = arguments.number();
    else if (*word == "--outliers")
      options.outliers = arguments.number();
    else if (*word == "--clusters")
      options.clusters = static_cast<int>(arguments.whole_number());
    else if (*word == "--seed")
      options.seed = sampling.seed = static_cast<std::uint64_t>(arguments.whole_number());
    else if (in.empty() && word->front() != '-')
      in = *word;
    else
      arguments.refuse();
  }
  if (out.empty() || (in.empty() ? 0 : 1) + (shape.empty() ? 0 : 1) + (mesh.empty() ? 0 : 1) != 1)
    return std::fputs(kUsage, stderr), 2;
  const auto draw = [&] {
    if (!shape.empty()) return bench::sample_surface(*bench::make_shape(shape), sampling);
    if (mesh.empty()) return read_cloud(in);
    Mesh surface = read_mesh(mesh);
    if (rotation != 0) bench::rotate(surface, rotation);
    return bench::points_of(surface, sampling.points, sampling.seed);
  };
  write_cloud(out, bench::spoil(draw(), options));
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return pointskin::bench::run_main("pointskin_spoil", argc, argv, run); }
