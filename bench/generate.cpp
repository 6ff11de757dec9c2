// pointskin_generate SHAPE -o OUT.ply: samples of a shape whose true surface is known.
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <cstdio>
#include <exception>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "shapes.hpp"

namespace {

constexpr const char* kUsage =
    "usage: pointskin_generate SHAPE -o OUT.ply [--points 500000] [--seed 1] [--noise 0] [--normal-noise 0]\n"
    "                          [--threads 0] [--area]\n"
    "\n"
    "Writes points drawn area-uniformly from a shape of radius about 1, with outward normals, as binary PLY.\n"
    "  SHAPE           gyroid, sphere, torus, knot, plate, slab, nested or hand; NAME@1 and NAME@2 are turned\n"
    "  --noise         sigma of the Gaussian noise on each coordinate, in world units\n"
    "  --normal-noise  sigma of the Gaussian noise on each component of the unit normal\n"
    "  --threads       CPU threads; 0: all\n"
    "  --area          print the area of the surface (good to about 0.2 %)\n";

int run(const std::vector<std::string>& words) {
  using namespace pointskin::bench;
  SamplingOptions options;
  std::string name, out;
  bool area = false;
  Arguments arguments(words);
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return std::fputs(kUsage, stdout), 0;
    if (*word == "-o" || *word == "--out")
      out = arguments.value();
    else if (*word == "--points")
      options.points = arguments.whole_number();
    else if (*word == "--seed")
      options.seed = static_cast<std::uint64_t>(arguments.whole_number());
    else if (*word == "--noise")
      options.noise = arguments.number();
    else if (*word == "--normal-noise")
      options.normal_noise = arguments.number();
    else if (*word == "--threads")
      options.threads = static_cast<int>(arguments.whole_number());
    else if (*word == "--area")
      area = true;
    else if (name.empty() && word->front() != '-')
      name = *word;
    else
      arguments.refuse();
  }
  if (name.empty() || (out.empty() && !area)) return std::fputs(kUsage, stderr), 2;
  const auto shape = make_shape(name);
  if (area) std::printf("area %.4f\n", estimate_area(*shape, 20'000'000, options.seed, options.threads));
  if (!out.empty()) pointskin::write_cloud(out, sample_surface(*shape, options), options.threads);
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return pointskin::bench::run_main("pointskin_generate", argc, argv, run); }
