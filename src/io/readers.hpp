// One reader per format, which the table of formats names (formats.hpp), and what they have in common.
#pragma once

#include <string_view>
#include <vector>

#include <pointskin/cloud.hpp>
#include <pointskin/io.hpp>
#include <pointskin/mesh.hpp>

#include "exec/cpu.hpp"
#include "io/point_table.hpp"
#include "io/source.hpp"

namespace pointskin::io {

/// Parse `source`. @throws Error invalid_input
Cloud parse_text(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_vtk_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_vtk_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_json_points(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_las(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_ptx(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_e57(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_pcd(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_vtk_xml_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_vtk_xml_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_bgeo(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_bnpts(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_binary_xyz(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_npy_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_npz_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_npz_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_ply_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_ply_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_obj(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_stl(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_off(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Mesh parse_gltf_mesh(exec::Cpu& ex, const Source& source, const ReadOptions& options);
Cloud parse_gltf_cloud(exec::Cpu& ex, const Source& source, const ReadOptions& options);

/// True if the file starts as binary glTF does.
bool is_glb(std::string_view start);

/// False if the start of the JSON tells of points and lines alone.
bool gltf_announces_faces(std::string_view start);

/// True if the file starts as files of the format do.
bool is_e57(std::string_view start);
bool is_pcd(std::string_view start);
bool is_bgeo(std::string_view start);

/// True if the file holds characters that no text has, and could be floats, three a point.
bool is_binary_xyz(const Source& source);

/// True if an element VTKFile is at the start.
bool is_vtk_xml(std::string_view start);

/// True if the file starts with "# vtk DataFile".
inline bool is_vtk(std::string_view start) { return start.starts_with("# vtk DataFile"); }

/// How files without a magic number are recognised: OFF by its first word, which is a keyword; STL by a length that
/// fits a binary file, or by the word "solid" at its start; JSON by its first bracket, where points are wanted.
bool looks_like_off(std::string_view bytes, bool want_mesh);
bool looks_like_stl(std::string_view bytes, bool want_mesh);
bool looks_like_json(std::string_view bytes, bool want_mesh);

/// Makes the vertices of a mesh from columns; its triangles are moved in. Normals get unit length.
/// @throws Error invalid_input if a coordinate is not finite, over_limit if 32-bit ids do not reach
Mesh assemble_mesh(exec::Cpu& ex, const Source& source, const PointTable& table, std::vector<Triangle>&& triangles,
                   const ReadOptions& options);

/// Throws Error invalid_input about the first row of `table` that has a coordinate that is not finite; there must be one.
/// @param first_row  number of the first row in the file
[[noreturn]] void fail_on_bad_vertex(const Source& source, const PointTable& table, std::int64_t first_row);

/// @throws Error over_limit if triangles could not name so many vertices
void check_vertex_count(const Source& source, std::int64_t vertices);

}  // namespace pointskin::io
