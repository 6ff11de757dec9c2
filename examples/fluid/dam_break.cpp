// A dam breaks: a second of water, a mesh a frame, on the GPU if there is one.
//
//   dam_break [PARTICLES] [FRAMES] [FOLDER]
#include <pointskin/pointskin.hpp>

#include <cstdio>
#include <cstdlib>
#include <exception>
#include <string>

int main(int argc, char** argv) try {
  const long particles = argc > 1 ? std::atol(argv[1]) : 20'000;
  const int frames = argc > 2 ? std::atoi(argv[2]) : 60;
  const std::string folder = argc > 3 ? argv[3] : ".";

  namespace sim = pointskin::simulation;
  sim::Simulation water(sim::make_scene(sim::SceneKind::dam_break, particles));
  pointskin::FluidOptions options;
  options.cube_size = 1;  // in particle radii
  pointskin::Mesh mesh;   // its memory is used again
  for (int frame = 0; frame < frames; ++frame) {
    water.step(1.0 / 60);
    water.surface(options, mesh);
    pointskin::write_mesh(folder + "/frame_" + std::to_string(frame) + ".ply", mesh);
    std::printf("frame %d: %zu triangles, %.3f J\n", frame, mesh.triangles.size(), water.report().kinetic_energy);
  }
  return 0;
} catch (const std::exception& error) {
  std::fprintf(stderr, "%s\n", error.what());
  return 1;
}
