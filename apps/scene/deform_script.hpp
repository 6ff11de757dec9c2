// Deformations as JSON (docs/cli.md, "deform").
#pragma once

#include <string>

#include <nlohmann/json.hpp>

#include <pointskin/deform.hpp>

#include "scene/json_reader.hpp"

namespace pointskin::scene {

/// Reads a deformation. Every key must be known, every value of the right kind.
/// @param name  of the script, for errors
/// @throws Error invalid_input, in one line that says where in the script and what was expected
Deformation parse_deformation(const std::string& text, const std::string& name);

/// The same of a file; "-" is stdin.
/// @throws Error invalid_input, also if the file cannot be read
Deformation read_deformation(const std::string& path);

/// The keys `handles` and `lattices` of an object that may have others.
Deformation read_deformation(const JsonReader& json);

/// Sets the two keys; read_deformation() gives the same numbers back.
void write_deformation(const Deformation& deformation, nlohmann::ordered_json& json);

}  // namespace pointskin::scene
