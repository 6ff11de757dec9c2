// Where clouds and solids are from, in documents.
#pragma once

#include <filesystem>
#include <string>

#include <nlohmann/json.hpp>

#include "scene/json_reader.hpp"
#include "scene/operations.hpp"

namespace pointskin::scene {

inline constexpr std::int64_t kMostShapePoints = 100'000'000;

/// The keys file, or shape and points, of an object that may have others. Files become absolute, seen from `folder`.
/// @throws Error invalid_input, naming the place
SolidSource read_source(const JsonReader& json, const std::filesystem::path& folder);

/// Adds these keys.
void write_source(const SolidSource& source, const std::filesystem::path& folder, nlohmann::ordered_json& json);

/// How `folder` names the absolute path `file`; the path itself for an empty folder, or where no way leads to it.
std::string file_seen_from(const std::string& file, const std::filesystem::path& folder);

/// A source as Insert::source holds it: the file, or "shape:NAME:POINTS", which no absolute path is. And back.
std::string source_text(const SolidSource& source);
SolidSource source_of_text(const std::string& text);

}  // namespace pointskin::scene
