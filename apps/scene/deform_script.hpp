// Deformations as JSON (docs/cli.md, "deform").
#pragma once

#include <string>

#include <pointskin/deform.hpp>

namespace pointskin::scene {

/// Reads a deformation. Every key must be known, every value of the right kind.
/// @param name  of the script, for errors
/// @throws Error invalid_input, in one line that says where in the script and what was expected
Deformation parse_deformation(const std::string& text, const std::string& name);

/// The same of a file; "-" is stdin.
/// @throws Error invalid_input, also if the file cannot be read
Deformation read_deformation(const std::string& path);

}  // namespace pointskin::scene
