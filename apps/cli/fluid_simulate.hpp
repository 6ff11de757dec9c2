// pointskin fluid --simulate: a scene of examples/fluid, its particles and its surface, frame after frame.
#pragma once

#include <cstdint>
#include <functional>
#include <string>

#include <nlohmann/json.hpp>

#include <pointskin/fluid.hpp>

#include "fit_args.hpp"

namespace pointskin::cli {

/// What is simulated, and where the particles go.
struct SimulateArgs {
  std::string scene;  ///< empty: no simulation
  std::int64_t particles = 32'768;
  int frames = 240;
  double fps = 60;
  int iterations = 4;
  double viscosity = 0.02, vorticity = 0;
  std::string particles_out;  ///< pattern; empty: none
};

/// What the command has in common for simulations and files.
struct SimulateOutput {
  std::string output;  ///< pattern of the meshes; empty: none
  std::string report;  ///< empty: none
  DeviceArgs device;
  bool quiet = false;
  FluidOptions surface;  ///< particle_radius 0: half the scene's spacing
  /// Called once everything has been checked. @param on_gpu  the device is a GPU
  std::function<void(bool on_gpu)> warn{};
  nlohmann::ordered_json shown_options{};  ///< for the report
};

OptionGroup simulation_options(SimulateArgs& args);

/// Runs the simulation and writes frame 0, the scene at rest, to frame `frames` - 1. Files appear whole or not at all;
/// a signal ends the run between two frames.
/// @returns the exit code
/// @throws Error usage if patterns or numbers are wrong, output_not_written, device_unavailable, interrupted
int run_simulation(const SimulateArgs& args, const SimulateOutput& output);

}  // namespace pointskin::cli
