#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <new>
#include <stdexcept>
#include <vector>

#include "io/blocks.hpp"
#include "io/formats.hpp"
#include "io/output.hpp"

namespace pointskin {
namespace {

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

void check_finite(exec::Cpu& ex, const char* what, const std::vector<Vec3f>& vectors) {
  constexpr std::int64_t kBlockRows = 1 << 14;
  const auto count = static_cast<std::int64_t>(vectors.size());
  io::run_in_order(ex, (count + kBlockRows - 1) / kBlockRows, [&](std::int64_t b) {
    for (std::int64_t i = b * kBlockRows; i < std::min(count, (b + 1) * kBlockRows); ++i) {
      const Vec3f& v = vectors[static_cast<std::size_t>(i)];
      if (!std::isfinite(v.x) || !std::isfinite(v.y) || !std::isfinite(v.z))
        throw Error(ErrorCode::invalid_input, fmt::format("{} {} is not finite", what, i));
    }
  });
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
