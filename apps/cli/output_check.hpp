// Finds out before the work whether its result could be written.
#pragma once

#include <string>
#include <vector>

namespace pointskin::cli {

struct OutputFile {
  const char* option;  ///< that names it
  std::string file;    ///< empty: not asked for
};

/// Checks that no two outputs are the same file, that stdin is read once, that only the first output goes to stdout,
/// and that only the first may replace an input.
/// @throws Error usage
void check_distinct(const std::vector<std::string>& inputs, const std::vector<OutputFile>& outputs);

/// Checks that a mesh could be written to `path`: a known extension, a folder that takes new files; for "-" that stdout
/// is not a terminal. Special files such as /dev/null pass.
/// @throws Error usage, output_not_written
void check_mesh_output(const std::string& path);

/// Checks that a file could be put in place of `path`; leaves nothing behind.
/// @throws Error output_not_written, with the reason of the operating system
void check_replaceable(const std::string& path);

}  // namespace pointskin::cli
