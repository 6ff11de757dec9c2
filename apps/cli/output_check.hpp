// Finds out before the work whether its result could be written.
#pragma once

#include <string>

namespace pointskin::cli {

/// Checks that a mesh could be written to `path`: a known extension, a folder that takes new files; for "-" that stdout
/// is open and no terminal. Special files such as /dev/null pass.
/// @throws Error usage, output_not_written
void check_mesh_output(const std::string& path);

/// Checks that a file could be put in place of `path`; leaves nothing behind.
/// @throws Error output_not_written, with the reason of the operating system
void check_replaceable(const std::string& path);

}  // namespace pointskin::cli
