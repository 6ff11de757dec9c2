#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <new>
#include <stdexcept>

#include "io/blocks.hpp"
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

void check_triangles(exec::Cpu& ex, const Mesh& mesh) {
  constexpr std::int64_t kBlockRows = 1 << 14;
  const auto vertices = static_cast<std::int64_t>(mesh.vertices.size());
  const auto triangles = static_cast<std::int64_t>(mesh.triangles.size());
  io::run_in_order(ex, (triangles + kBlockRows - 1) / kBlockRows, [&](std::int64_t b) {
    for (std::int64_t t = b * kBlockRows; t < std::min(triangles, (b + 1) * kBlockRows); ++t)
      for (const std::int32_t corner : mesh.triangles[static_cast<std::size_t>(t)])
        if (corner < 0 || corner >= vertices)
          throw Error(ErrorCode::invalid_input, fmt::format("a triangle names vertex {} of {}", corner, vertices));
  });
}

/// Errors of the data are found by `format`, before the file is opened: they leave the disk alone.
template <class Format>
void format_and_write(exec::Cpu& ex, const std::string& path, const Format& format) {
  try {
    io::write_blocks(ex, path, format());
  } catch (const std::bad_alloc&) {
    throw Error(ErrorCode::over_limit, "out of memory; while writing " + io::printable(path));
  } catch (const std::length_error&) {
    throw Error(ErrorCode::over_limit, "out of memory; while writing " + io::printable(path));
  }
}

/// PLY as `options` want it.
io::Blocks format_ply(const WriteOptions& options, const io::VertexArrays& vertices,
                      const std::vector<Triangle>* triangles) {
  return options.ascii ? io::format_ply_ascii(vertices, triangles) : io::format_ply(vertices, triangles);
}

}  // namespace

void write_mesh(const std::string& path, const Mesh& mesh, int threads) {
  write_mesh(path, mesh, WriteOptions{.ascii = false, .threads = threads});
}

void write_mesh(const std::string& path, const Mesh& mesh, const WriteOptions& options) {
  const std::string extension = output_format(path);
  exec::Cpu ex(options.threads);
  check_triangles(ex, mesh);
  format_and_write(ex, path, [&] {
    if (extension == ".obj") return io::format_obj(mesh);
    if (extension == ".stl") return io::format_stl(mesh);
    return format_ply(options, {mesh.origin, mesh.vertices, mesh.normals, mesh.attributes}, &mesh.triangles);
  });
}

void write_cloud(const std::string& path, const Cloud& cloud, int threads) {
  write_cloud(path, cloud, WriteOptions{.ascii = false, .threads = threads});
}

void write_cloud(const std::string& path, const Cloud& cloud, const WriteOptions& options) {
  exec::Cpu ex(options.threads);
  format_and_write(ex, path, [&] {
    return format_ply(options, {cloud.origin, cloud.positions, cloud.normals, cloud.attributes}, nullptr);
  });
}

}  // namespace pointskin
