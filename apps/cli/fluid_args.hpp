// The command line of `pointskin fluid`.
#pragma once

#include <cstdint>
#include <optional>
#include <string>

#include <pointskin/fluid.hpp>

#include "fit_args.hpp"
#include "fluid_simulate.hpp"
#include "given_options.hpp"

namespace pointskin::cli {

struct FluidArgs : DeviceArgs {
  std::string input, output, report;  ///< report empty: none
  std::string shift = "auto";
  std::string max_memory;  ///< empty: what the machine has left
  FluidOptions options;
  SimulateArgs simulation;  ///< with a scene: instead of `input`
  std::optional<std::int64_t> first, last;
  int at_once = 0;
  bool overwrite = false, quiet = false;
  GivenOptions given;
};

/// Reports of files show all of it, those of simulations simulation_report_options.
OptionTable fluid_options(FluidArgs& args);
OptionTable simulation_report_options(FluidArgs& args);

/// Warns of options that the kind of run leaves without effect. @param on_gpu  the device is a GPU
void warn_about_unused(const FluidArgs& args, bool on_gpu);

/// The library's options. @throws Error usage if one is out of range
FluidOptions library_options(const FluidArgs& args);

}  // namespace pointskin::cli
