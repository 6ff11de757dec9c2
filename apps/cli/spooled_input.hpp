// Input that comes through a pipe and is read more than once.
#pragma once

#include <string>

namespace pointskin::cli {

/// True if `path` ("-": stdin) names a pipe or a socket.
bool is_pipe(const std::string& path);

/// Reads a pipe to its end into a file without a name, which takes its place: as stdin, or under the path that is returned. The file
/// vanishes with the process, however that ends.
/// @param folder  of the file; empty: that of the system for temporary files
/// @returns "-" for stdin
/// @throws Error invalid_input if the pipe cannot be read; output_not_written if the folder takes no such file, or the disk is full
std::string spool_pipe(const std::string& path, const std::string& folder);

}  // namespace pointskin::cli
