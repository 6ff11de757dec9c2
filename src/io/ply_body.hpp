// The body of a PLY file: its vertices as columns, its faces as triangles.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include <pointskin/mesh.hpp>

#include "exec/cpu.hpp"
#include "io/parsed_columns.hpp"
#include "io/ply_header.hpp"
#include "io/source.hpp"

namespace pointskin::io {

struct PlyBody {
  ParsedColumns parsed;             ///< values of vertices that could not be viewed in place
  PointTable vertices;              ///< views into the file or into `parsed`
  std::vector<Triangle> triangles;  ///< only if asked for
};

/// What the readers of both encodings need.
struct PlyInput {
  const Source& source;
  const PlyHeader& header;
  bool want_faces = false;  ///< false: faces are walked over, so that a truncated file is still noticed
};

/// Reads a binary body. Vertices without lists are viewed in place; faces that are all triangles are read in parallel.
/// @throws Error invalid_input with the byte
void read_binary_body(exec::Cpu& ex, const PlyInput& input, PlyBody& body);

/// Throws Error invalid_input about the corner of a face that is not in [0, vertices).
[[noreturn]] void fail_on_corner(const Source& source, std::int64_t index, std::int64_t vertices, std::size_t byte);

/// Binary rows of an element without lists as columns, in place.
PointTable view_rows(const PlyElement& element, PlyEncoding encoding, const char* data, std::int64_t rows);

/// Reads a text body, one row a line, in parallel.
/// @throws Error invalid_input with the line
void read_ascii_body(exec::Cpu& ex, const PlyInput& input, PlyBody& body);

/// Number of the vertex list among the face's properties.
/// @throws Error invalid_input if there is none or its items are no integers
std::size_t find_corner_list(const Source& source, const PlyElement& face);

/// Number of vertices that the header promises.
std::int64_t vertex_count(const PlyHeader& header);

/// Adds all properties of the element that are no lists, and takes their memory.
void add_scalars(const PlyElement& element, ParsedColumns& parsed);

}  // namespace pointskin::io
