// One reader per format. They parse memory, so that tests and fuzzers need no files.
#pragma once

#include <string>

#include <pointskin/cloud.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "exec/cpu.hpp"
#include "io/point_table.hpp"
#include "io/source.hpp"

namespace pointskin::io {

enum class Format { ply, text, obj, stl, off, vtk, json };

/// The format of `source`: "ply" or "# vtk DataFile" magic, else the extension of its name, else (no extension, stdin)
/// its content.
/// @throws Error invalid_input for an unknown extension
Format detect_format(const Source& source, bool want_mesh);

/// Extension of `path` in lower case with its dot; empty if there is none.
std::string extension_of(const std::string& path);

/// Parse `source` as `format`. Clouds of mesh formats are their vertices.
/// @throws Error invalid_input
Cloud parse_cloud(const Source& source, Format format, const ReadOptions& options);
Mesh parse_mesh(const Source& source, Format format, const ReadOptions& options);

/// The format readers behind parse_cloud and parse_mesh.
Cloud parse_text(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_vtk(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_json_points(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_ply_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_ply_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_obj(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_stl(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_off(exec::Cpu& ex, const Source& source, const ReadOptions& options);

/// Makes the vertices of a mesh from columns; its triangles are moved in. Normals get unit length.
/// @throws Error invalid_input if a coordinate is not finite, over_limit if 32-bit ids do not reach
Mesh assemble_mesh(exec::Cpu& ex, const Source& source, const PointTable& table, std::vector<Triangle>&& triangles,
                   const ReadOptions& options);

/// @throws Error over_limit if triangles could not name so many vertices
void check_vertex_count(const Source& source, std::int64_t vertices);

}  // namespace pointskin::io
