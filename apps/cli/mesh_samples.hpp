// Meshes that are read where oriented points are wanted.
#pragma once

#include <string>

#include <pointskin/cloud.hpp>
#include <pointskin/io.hpp>

namespace pointskin::cli {

/// Reads the mesh file `path`, whose vertices have no normals, as a cloud of its vertices with the normals of the faces
/// around them (add_vertex_normals), and says so in a warning. Vertices without faces get zero normals.
/// @param cloud  receives the vertices, or stays as it was
/// @returns false for files that hold no faces, and for stdin, which cannot be read a second time
/// @throws Error as read_mesh
bool read_vertices_of_mesh(const std::string& path, const ReadOptions& options, Cloud& cloud);

}  // namespace pointskin::cli
