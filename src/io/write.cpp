#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <algorithm>
#include <cmath>
#include <new>
#include <span>
#include <stdexcept>
#include <vector>

#include "core/format.hpp"
#include "io/blocks.hpp"
#include "io/formats.hpp"
#include "io/mesh_checks.hpp"
#include "io/output.hpp"
#include "io/writers.hpp"

namespace pointskin {
namespace {

/// Calls check(first, part) for parts of an array, on all threads. The first that throws counts.
template <class T, class Check>
void check_parts(exec::Cpu& ex, const std::vector<T>& all, const Check& check) {
  constexpr std::size_t kPart = 1 << 14;
  io::run_in_order(ex, static_cast<std::int64_t>((all.size() + kPart - 1) / kPart), [&](std::int64_t b) {
    const std::size_t first = static_cast<std::size_t>(b) * kPart;
    check(first, std::span<const T>(all).subspan(first, std::min(kPart, all.size() - first)));
  });
}

void check_triangles(exec::Cpu& ex, const Mesh& mesh) {
  const auto vertices = static_cast<std::int64_t>(mesh.vertices.size());
  check_parts(ex, mesh.triangles,
              [&](std::size_t /*first*/, std::span<const Triangle> part) { io::check_corners(vertices, part); });
}

void check_finite(exec::Cpu& ex, const char* what, const std::vector<Vec3f>& vectors) {
  check_parts(ex, vectors,
              [&](std::size_t first, std::span<const Vec3f> part) { io::check_finite(what, first, part); });
}

void check_finite(const Vec3d& origin) {
  if (!std::isfinite(origin.x) || !std::isfinite(origin.y) || !std::isfinite(origin.z))
    throw Error(ErrorCode::invalid_input, "the origin is not finite");
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

}  // namespace

void write_mesh(const std::string& path, const Mesh& mesh, int threads) {
  write_mesh(path, mesh, WriteOptions{.ascii = false, .threads = threads});
}

void write_mesh(const std::string& path, const Mesh& mesh, const WriteOptions& options) {
  const io::Format& format = io::mesh_format(path);
  exec::Cpu ex(options.threads);
  check_triangles(ex, mesh);
  check_finite(ex, "vertex", mesh.vertices);
  check_finite(ex, "the normal of vertex", mesh.normals);
  check_finite(mesh.origin);
  format_and_write(ex, path, [&] { return format.run.write_mesh(mesh, options); });
}

void write_mesh(const std::string& path, const Workspace& workspace, const DeviceMesh& mesh,
                const WriteOptions& options) {
  const bool in_blocks = io::mesh_format(path).run.write_mesh == io::format_ply_mesh && !options.ascii;
  if (!in_blocks || !mesh.attributes.empty()) return write_mesh(path, download(workspace, mesh), options);
  exec::Cpu ex(options.threads);
  check_finite(mesh.origin);
  format_and_write(ex, path, [&] { return io::format_device_ply(workspace, mesh, options.double_coordinates); });
}

void write_cloud(const std::string& path, const Cloud& cloud, int threads) {
  write_cloud(path, cloud, WriteOptions{.ascii = false, .threads = threads});
}

void write_cloud(const std::string& path, const Cloud& cloud, const WriteOptions& options) {
  exec::Cpu ex(options.threads);
  check_finite(ex, "point", cloud.positions);
  check_finite(cloud.origin);
  format_and_write(ex, path, [&] { return io::cloud_format(path).run.write_cloud(cloud, options); });
}

}  // namespace pointskin
