// The file formats that are known: what they are called, and what their files can hold.
#pragma once

#include <span>
#include <string>
#include <vector>

#include <pointskin/export.hpp>

namespace pointskin PSK_EXPORT {

/// Which attributes of vertices the files hold that are written in a format.
enum class HeldAttributes {
  none,
  colours,  ///< red, green and blue, all uint8
  all,
};

/// How the numbers of the files are written.
enum class NumberCoding { text, binary, either };

/// A file format.
struct FormatInfo {
  std::string name;                     ///< as people write it, "PLY"
  std::vector<std::string> extensions;  ///< in lower case, with their dots: ".ply"
  HeldAttributes attributes = HeldAttributes::all;
  NumberCoding coding = NumberCoding::text;
  std::string read{};            ///< what is read of its files, for people: "positions, normals, all scalars"
  std::string written{};         ///< what is written; empty: nothing is
  std::string library{};         ///< the one that it is read and written with; empty: Pointskin's own code
  std::string tested_against{};  ///< other programs whose files are read in the tests, and that read ours
  bool built = true;             ///< false: this build was made without its library, and does nothing of it
  bool reads_clouds = false;     ///< read_cloud; of a mesh its vertices
  bool reads_meshes = false;     ///< read_mesh
  bool writes_clouds = false;
  bool writes_meshes = false;
};

/// All formats. The first is what streams get that have no name to go by, PLY; it holds everything. O(1).
std::span<const FormatInfo> file_formats();

/// The extension of `path` in lower case with its dot; empty if there is none.
std::string extension_of(const std::string& path);

/// The one of `formats` that the extension of `path` names; null if there is none. The file is not looked at.
const FormatInfo* format_of(const std::string& path, std::span<const FormatInfo> formats = file_formats());

/// The extensions of the formats that can do something, in a sentence: extension_list(&FormatInfo::writes_meshes) is
/// ".ply, .obj or .stl". In the order of `formats`.
std::string extension_list(bool FormatInfo::*can, std::span<const FormatInfo> formats = file_formats());

/// The names of the formats that can do something, as a list: format_names(&FormatInfo::reads_meshes) is
/// "PLY, OBJ, STL, OFF". In the order of `formats`.
std::string format_names(bool FormatInfo::*can, std::span<const FormatInfo> formats = file_formats());

/// True if read_mesh may find faces in the file `path`: it is of a format of meshes by its first bytes, else by its
/// name, and if it is a PLY, its header announces some. "-" is stdin, which must be seekable and stays where it is. Reads
/// 64 KiB at most; does not wait for pipes.
/// @throws Error invalid_input if it cannot be opened or read: a mesh must not be taken for a cloud then
bool may_hold_faces(const std::string& path);

}  // namespace pointskin
