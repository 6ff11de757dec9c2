// Finds out before the work whether its result could be written.
#pragma once

#include <span>
#include <string>

#include <pointskin/formats.hpp>

namespace pointskin::cli {

/// Checks that a cloud or mesh could be written to `path`, whatever its extension: the folder takes new files; for "-"
/// that stdout is open and no terminal. Special files such as /dev/null pass.
/// @throws Error usage, output_not_written
void check_result(const std::string& path);

/// The same, and that the extension is that of a format in which meshes are written.
void check_mesh_output(const std::string& path, std::span<const FormatInfo> formats = file_formats());

/// Checks that `path` is "-" or has the extension of a format in which clouds are written.
/// @param story  of the error: {0} stands for `named` (empty: the path), {1} for such extensions
/// @throws Error usage
void check_cloud_name(const std::string& path, const char* story, const std::string& named = "");

/// Checks that a file could be put in place of `path`; leaves nothing behind.
/// @throws Error output_not_written, with the reason of the operating system
void check_replaceable(const std::string& path);

}  // namespace pointskin::cli
