// Pictures of the places that `pointskin problems` finds.
#pragma once

#include <string>
#include <vector>

#include <pointskin/mesh.hpp>
#include <pointskin/problems.hpp>

#include "option_table.hpp"

namespace pointskin::cli {

struct ProblemPictureArgs {
  std::string folder;  ///< empty: no pictures
  int most = 10;       ///< regions
  std::string up = "y";
};

/// The files of a region's views; empty for a region that is not drawn.
using PictureNames = std::vector<std::string>;

OptionGroup problem_options(ProblemPictureArgs& args);

/// Checks the options, and that pictures could be written into the folder, or the folder be made. Leaves nothing
/// behind.
/// @throws Error usage, output_not_written
void check_problem_pictures(const ProblemPictureArgs& args);

/// Options for find_problems. @throws Error usage
ProblemOptions problem_options(const ProblemPictureArgs& args, int threads);

/// Draws the views of the first regions into the folder, problem_01_1.png and so on, each of which appears whole.
/// @param progress  show how far they are, on a terminal
/// @returns the names, one list a region; nothing if no pictures are asked for
/// @throws Error output_not_written, interrupted
std::vector<PictureNames> write_problem_pictures(const Mesh& mesh, const std::vector<ProblemRegion>& regions,
                                                 const ProblemPictureArgs& args, int threads, bool progress);

}  // namespace pointskin::cli
