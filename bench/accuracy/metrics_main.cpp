// pointskin_metrics MESH: distances, normals and topology of a mesh against the truth, as JSON.
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <cstdio>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "metrics.hpp"
#include "rotated.hpp"

namespace {

constexpr const char* kUsage =
    "usage: pointskin_metrics MESH (--shape NAME | --truth MESH [--rotation N]) [--points 0]\n"
    "                         [--samples 500000] [--tau 0.001] [--threads 0]\n"
    "\n"
    "Prints JSON: distances both ways in world units, in % of the truth's diagonal and in mean sample spacings,\n"
    "agreement of normals, F-score, components, Euler number and genus.\n"
    "  --shape    a shape that pointskin_generate knows: distances to its exact surface\n"
    "  --truth    a mesh: exact distances between points and triangles\n"
    "  --rotation turns the truth by one of two fixed rotations, 1 or 2\n"
    "  --points   size of the cloud that MESH was made from; the spacing is sqrt(area / points)\n"
    "  --samples  points drawn area-uniformly from either surface\n"
    "  --tau      threshold of the F-score, as a fraction of the truth's diagonal\n";

int run(const std::vector<std::string>& words) {
  using namespace pointskin;
  std::string path, shape, truth;
  std::int64_t points = 0;
  int rotation = 0;
  CompareOptions options{.tau = 0.001};
  bench::Arguments arguments(words);
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return std::fputs(kUsage, stdout), 0;
    if (*word == "--shape")
      shape = arguments.value();
    else if (*word == "--truth")
      truth = arguments.value();
    else if (*word == "--rotation")
      rotation = static_cast<int>(arguments.whole_number());
    else if (*word == "--points")
      points = arguments.whole_number();
    else if (*word == "--samples")
      options.samples = arguments.whole_number();
    else if (*word == "--tau")
      options.tau = arguments.number();
    else if (*word == "--threads")
      options.threads = static_cast<int>(arguments.whole_number());
    else if (path.empty() && word->front() != '-')
      path = *word;
    else
      arguments.refuse();
  }
  if (path.empty() || shape.empty() == truth.empty()) return std::fputs(kUsage, stderr), 2;
  const Mesh mesh = read_mesh(path);
  Mesh true_mesh;
  if (shape.empty()) true_mesh = read_mesh(truth);
  if (rotation != 0) bench::rotate(true_mesh, rotation);
  const bench::Metrics metrics = shape.empty()
                                     ? bench::measure_against(mesh, truth, true_mesh, options)
                                     : bench::measure_against(mesh, shape, *bench::make_shape(shape), options);
  std::puts(bench::to_json(metrics, options, points).dump(2).c_str());
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return pointskin::bench::run_main("pointskin_metrics", argc, argv, run); }
