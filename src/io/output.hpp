// Files that appear whole or not at all.
#pragma once

#include <string>
#include <vector>

namespace pointskin::io {

/// True if `path` is "-" or names something that exists and is neither a regular file nor a folder.
bool is_stream(const std::string& path);

/// Replaces the file `path` by the parts, one after the other, by a rename from a temporary file in the same folder.
/// Streams are written directly, "-" is stdout.
/// @throws Error output_not_written with the reason of the operating system; a regular file is then what it was
void write_parts(const std::string& path, const std::vector<std::string>& parts);

}  // namespace pointskin::io
