// pointskin_accuracy MESH --shape NAME: how far a mesh's vertices lie from the true surface.
#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <vector>

#include "arguments.hpp"
#include "shapes.hpp"

namespace {

constexpr const char* kUsage =
    "usage: pointskin_accuracy MESH [--shape gyroid]\n"
    "\n"
    "Prints rms, mean and max of |F / grad F| over the vertices of MESH, in world units, and the mean with its sign\n"
    "(positive: outside). SHAPE is one that pointskin_generate knows.\n";

int run(const std::vector<std::string>& words) {
  using namespace pointskin;
  std::string path, name = "gyroid";
  bench::Arguments arguments(words);
  while (const auto word = arguments.next()) {
    if (*word == "-h" || *word == "--help") return std::fputs(kUsage, stdout), 0;
    if (*word == "--shape")
      name = arguments.value();
    else if (path.empty() && word->front() != '-')
      path = *word;
    else
      arguments.refuse();
  }
  if (path.empty()) return std::fputs(kUsage, stderr), 2;
  const auto shape = bench::make_shape(name);
  const Mesh mesh = read_mesh(path);
  if (mesh.vertices.empty()) throw Error(ErrorCode::empty_result, path + " has no vertices");

  double squares = 0, total = 0, bias = 0, largest = 0;
  for (const Vec3f& v : mesh.vertices) {
    const double distance =
        bench::signed_distance(*shape, {mesh.origin[0] + v.x, mesh.origin[1] + v.y, mesh.origin[2] + v.z});
    squares += distance * distance;
    total += std::abs(distance);
    bias += distance;
    largest = std::max(largest, std::abs(distance));
  }
  const auto n = static_cast<double>(mesh.vertices.size());
  std::printf("shape %s vertices %zu triangles %zu rms %.3e mean %.3e max %.3e bias %+.2e\n", name.c_str(),
              mesh.vertices.size(), mesh.triangles.size(), std::sqrt(squares / n), total / n, largest, bias / n);
  return 0;
}

}  // namespace

int main(int argc, char** argv) { return pointskin::bench::run_main("pointskin_accuracy", argc, argv, run); }
