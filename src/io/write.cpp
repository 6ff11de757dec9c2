#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <fmt/format.h>

#include <new>
#include <stdexcept>

#include "io/output.hpp"
#include "io/readers.hpp"
#include "io/writers.hpp"

namespace pointskin {
namespace {

/// ".ply", ".obj" or ".stl". Streams have no name to go by and get PLY.
std::string output_format(const std::string& path) {
  const std::string extension = io::extension_of(path);
  if (path == "-" || (extension.empty() && io::is_stream(path))) return ".ply";
  if (extension == ".ply" || extension == ".obj" || extension == ".stl") return extension;
  throw Error(ErrorCode::usage, io::printable(path) + ": unknown extension; use .ply, .obj or .stl");
}

void check_triangles(const Mesh& mesh) {
  const auto vertices = static_cast<std::int64_t>(mesh.vertices.size());
  for (const Triangle& triangle : mesh.triangles)
    for (const std::int32_t corner : triangle)
      if (corner < 0 || corner >= vertices)
        throw Error(ErrorCode::invalid_input, fmt::format("a triangle names vertex {} of {}", corner, vertices));
}

/// Formats first and opens the file after: errors of the data leave the disk alone.
template <class Format>
void format_and_write(const std::string& path, const Format& format) {
  try {
    io::write_parts(path, format());
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::over_limit, "out of memory; while writing " + io::printable(path));
  } catch (const std::length_error&) {
    throw Error(ErrorCode::over_limit, "out of memory; while writing " + io::printable(path));
  }
}

}  // namespace

void write_mesh(const std::string& path, const Mesh& mesh, int threads) {
  const std::string extension = output_format(path);
  check_triangles(mesh);
  exec::Cpu ex(threads);
  format_and_write(path, [&] {
    if (extension == ".obj") return io::format_obj(ex, mesh);
    if (extension == ".stl") return io::format_stl(ex, mesh);
    return io::format_ply(ex, {mesh.origin, mesh.vertices, mesh.normals, mesh.attributes}, &mesh.triangles);
  });
}

void write_cloud(const std::string& path, const Cloud& cloud, int threads) {
  exec::Cpu ex(threads);
  format_and_write(path, [&] {
    return io::format_ply(ex, {cloud.origin, cloud.positions, cloud.normals, cloud.attributes}, nullptr);
  });
}

}  // namespace pointskin
