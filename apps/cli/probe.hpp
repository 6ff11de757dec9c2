// Looks at the start of a file to tell a mesh from a cloud.
#pragma once

#include <string>

namespace pointskin::cli {

/// Copies stdin to memory if it is a pipe, so that its start can be looked at before it is read.
/// @throws Error invalid_input if it cannot be read, over_limit if memory runs out
void make_stdin_seekable();

/// True if `path` is a mesh format by name, or a PLY whose header announces faces. False also if it cannot be opened:
/// the reader tells why. "-" must be seekable.
bool may_hold_faces(const std::string& path);

}  // namespace pointskin::cli
