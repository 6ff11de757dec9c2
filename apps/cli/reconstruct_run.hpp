// One run of `pointskin reconstruct`: points read, a mesh made and written.
#pragma once

#include <memory>
#include <string>

#include <pointskin/reconstruct.hpp>

#include "reconstruct_args.hpp"
#include "report.hpp"
#include "stopwatch.hpp"

namespace pointskin::cli {

/// Where the mesh goes, as far as it matters to properties of it: runs that are only timed make one, too.
std::string mesh_file(const ReconstructArgs& args);

/// Reads, reconstructs and writes what `args` name, the report included. Names have been checked.
/// @param watch          since the run began
/// @param reconstructor  is used, or made where there is none
/// @throws Error
Record run_reconstruction(const ReconstructArgs& args, const Stopwatch& watch,
                          std::unique_ptr<Reconstructor>& reconstructor);

}  // namespace pointskin::cli
