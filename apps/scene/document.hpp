// A scene as one JSON document: clouds, options and operations. Scripts of `pointskin edit`, the history of the studio,
// its messages and its session files are all such documents. docs/scene.schema.json describes the format.
#pragma once

#include <cstddef>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <nlohmann/json.hpp>

#include <pointskin/reconstruct.hpp>

#include "scene/camera_json.hpp"
#include "scene/operations.hpp"
#include "scene/sources.hpp"

namespace pointskin::scene {

inline constexpr int kDocumentVersion = 1;

/// What a scene begins with.
struct Base {
  std::vector<CloudSource> clouds;  ///< merged in this order; empty: named elsewhere, as on a command line
  std::string shift = "auto";       ///< as --shift: auto, none or x,y,z
};

/// A document that has been read and checked. `operations` are as they were written but for the files,
/// which have absolute paths, because a camera may be that of a picture of the surface that there is when its turn comes.
struct Document {
  Base base;
  Options options;                                 ///< what the document does not say has its default
  bool warm_start = true;                          ///< SceneOptions::warm_start; the key stands among the options
  std::vector<std::string> options_given;          ///< keys that the document says
  std::vector<nlohmann::ordered_json> operations;  ///< with entries undo and redo, if it is a script with such
  std::size_t done = 0;  ///< so many of them are done, the rest were undone; operations.size() with undo entries
};

/// Base::shift as readers want it: unset for auto. @throws Error invalid_input for anything else than described there
std::optional<Vec3d> shift_of(const std::string& text);

/// Reads a document and checks all that can be checked before there is a surface: keys, types, ranges, numbers that
/// are not finite; not whether files are there.
/// @param text  JSON
/// @param name  of the file, for errors
/// @param folder  that files in it are seen from; they become absolute paths
/// @throws Error invalid_input in one line that names the place, as "name.operations[3].camera: ..."
Document parse_document(const std::string& text, const std::string& name, const std::filesystem::path& folder);

/// The same of a file, seen from its folder. @throws Error invalid_input also where it cannot be read
Document read_document(const std::string& path);

/// A document as JSON. Clouds and files of operations are named as seen from `folder`.
nlohmann::ordered_json to_json(const Document& document, const std::filesystem::path& folder);

/// Writes a session file atomically (write_file_atomically), with clouds and other files as seen from its folder.
/// @throws Error output_not_written
void write_document(const std::string& path, const Document& document);

/// Reads the clouds of `base` as far as to take their SHA-256, and compares it with what the document says.
/// @returns a line for every cloud that changed since
/// @throws Error invalid_input, naming the file, for one that is missing or cannot be read. O(bytes)
std::vector<std::string> check_clouds(const Base& base);

/// Sets the SHA-256 of every cloud that is a file. @throws Error invalid_input as check_clouds
void stamp_clouds(Base& base);

/// An operation of a document, checked. Parts and solids are read (Insert::part, Combine::solid).
/// @param name  of the place, for errors
/// @param sources  that keeps what was read last; null: files are read anew
/// @throws Error invalid_input, in one line that names the place; as read_cloud and read_mesh for files
SceneOperation operation_of(const nlohmann::json& json, const std::string& name, const std::filesystem::path& folder,
                            const CameraOfPicture& camera_of_picture, Sources* sources = nullptr);

/// Checks an operation, or an undo or redo entry, without a surface and without reading files.
/// @throws Error invalid_input, in one line that names the place
void check_operation(const nlohmann::json& json, const std::string& name);

/// Whether an entry of a script is that.
bool is_undo(const nlohmann::json& json);
bool is_redo(const nlohmann::json& json);

/// The files that an operation names, absolute. @param json  checked
std::vector<std::string> files_of(const nlohmann::json& json, const std::filesystem::path& folder);

/// An operation with all cameras as matrices and files named as seen from `folder` (absolute paths where that is
/// empty): operation_of() gives it back as it was.
nlohmann::ordered_json to_json(const SceneOperation& operation, const std::filesystem::path& folder);

}  // namespace pointskin::scene
