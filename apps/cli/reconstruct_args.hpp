// The command line of `pointskin reconstruct`.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include <pointskin/reconstruct.hpp>

#include "fit_args.hpp"
#include "given_options.hpp"
#include "normal_args.hpp"
#include "poisson_recon.hpp"
#include "problem_pictures.hpp"

namespace pointskin::cli {

struct ReconstructArgs : FitArgs, DeviceArgs {
  std::vector<std::string> inputs;
  std::vector<std::string> named_inputs;  ///< of --in; come after inputs
  std::string output;                     ///< empty: none
  std::string report;                     ///< empty: none
  std::string shift = "auto";
  bool split = false;  ///< a file for each block
  std::string temp;    ///< for temporary data; empty: that of the system
  NormalArgs normals;
  double width_world = 0;  ///< > 0: chooses the depth
  int repeat = 0;
  bool each = false;                ///< a mesh of every input, not one of all
  std::optional<DeviceArgs> asked;  ///< with --each: what was given, of which a run has a share
  bool problems = false;            ///< list regions whose topology is doubtful; a mesh is not needed then
  bool overwrite = false;           ///< results may replace inputs
  bool ascii = false;               ///< PLY as text
  ProblemPictureArgs pictures;
  std::string poisson_recon_data;  ///< pull factor of --data, or kDataAlone; empty: not given
  GivenOptions given;
  bool colors = false, dry_run = false, quiet = false, verbose = false;
};

/// The options of `pointskin reconstruct`, or of `pointskin problems`.
OptionTable reconstruct_options(ReconstructArgs& args);

/// Options as the library wants them. The depth is not settled yet when a width is given.
/// @throws Error usage if a value is out of range or two contradict each other
Options library_options(const ReconstructArgs& args);

/// Smallest depth whose cells are at most `width_world` wide in a cube of side `cube_world`.
/// @throws Error usage if that depth is beyond 20
int depth_for_width(double cube_world, double width_world);

}  // namespace pointskin::cli
