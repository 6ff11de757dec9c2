// The table of file formats. Every reader, writer, probe and check asks it; tests bring tables of their own.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/formats.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "exec/cpu.hpp"
#include "io/output.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// What is done with the files of a format. All parse and make memory, so that tests and fuzzers need no files.
struct FormatFunctions {
  /// True if a file that starts with `start` is of this format, whatever its name is.
  bool (*has_magic)(std::string_view start) = nullptr;
  /// True if a file whose name has no extension is taken for this format. Asked from the last format to the first.
  bool (*looks_like)(std::string_view bytes, bool want_mesh) = nullptr;
  /// True if the header of a mesh announces faces. Null: every file may hold some.
  bool (*announces_faces)(std::string_view start) = nullptr;
  /// Null where read_mesh is there: the vertices of the mesh.
  Cloud (*read_cloud)(exec::Cpu& ex, const Source& source, const ReadOptions& options) = nullptr;
  Mesh (*read_mesh)(exec::Cpu& ex, const Source& source, const ReadOptions& options) = nullptr;
  Blocks (*write_cloud)(const Cloud& cloud, const WriteOptions& options) = nullptr;
  Blocks (*write_mesh)(const Mesh& mesh, const WriteOptions& options) = nullptr;
};

/// An entry of the table. What it can do follows from its functions.
struct Format {
  Format(FormatInfo about, const FormatFunctions& functions);

  FormatInfo info;
  FormatFunctions run;
};

using Formats = std::span<const Format>;

/// The formats of the library.
Formats formats();

/// What the public functions tell of a table.
std::vector<FormatInfo> infos_of(Formats table);

/// The format in which `source` is read: the one that its first bytes tell, else its extension, else (no extension, stdin) its content.
/// @throws Error invalid_input for an unknown extension, or a format that is not read
const Format& read_format(const Source& source, bool want_mesh, Formats table = formats());

/// Reads `source` in that format.
/// @throws Error invalid_input for an unknown extension, for points where a mesh is wanted, or as the reader
Cloud parse_cloud(const Source& source, const ReadOptions& options, Formats table = formats());
Mesh parse_mesh(const Source& source, const ReadOptions& options, Formats table = formats());

/// may_hold_faces for a file `path` that starts with `start`.
bool may_hold_faces(const std::string& path, std::string_view start, Formats table = formats());

/// The format in which a mesh is written to `path`. Streams without an extension get the first one.
/// @throws Error usage if there is none
const Format& mesh_format(const std::string& path, Formats table = formats());

/// The same for a cloud: the first one also where the extension is not that of a format of clouds.
const Format& cloud_format(const std::string& path, Formats table = formats());

}  // namespace pointskin::io
