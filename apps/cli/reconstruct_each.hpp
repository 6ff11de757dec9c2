// pointskin reconstruct --each: many clouds, a mesh of every one.
#pragma once

#include "reconstruct_args.hpp"

namespace pointskin::cli {

/// Everything that can be found wrong before an input is opened. @throws Error usage, output_not_written
void check_each(const ReconstructArgs& args);

/// Reconstructs all clouds, on the CPU as many at once as there are threads and memory; goes on where one fails.
/// @throws Error with the code of the first cloud, in the order they were named in, that failed
int reconstruct_each(const ReconstructArgs& args);

}  // namespace pointskin::cli
