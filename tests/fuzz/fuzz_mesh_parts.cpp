// Fuzzes the reader of meshes in parts: the input is a PLY file. What it reads must be what read_mesh() reads, in any parts.
#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include <pointskin/error.hpp>
#include <pointskin/io.hpp>

#include "exec/cpu.hpp"
#include "io/ply_mesh_parts.hpp"
#include "whole_and_parts.hpp"

using namespace pointskin;
using fuzz::require;
using fuzz::same_bytes;

namespace {

/// f(first, count) for parts of `count` rows of n.
template <class F>
void in_parts(std::int64_t n, std::int64_t count, const F& f) {
  for (std::int64_t first = 0; first < n; first += count) f(first, std::min(count, n - first));
}

struct Arrays {
  std::vector<Vec3f> vertices;
  std::vector<Triangle> triangles;
};

/// @throws Error as the reader
Arrays read_in_parts(io::PlyMeshParts& file, std::int64_t rows) {
  exec::Cpu ex(1);
  file.find_origin(ex);
  Arrays arrays;
  arrays.vertices.resize(static_cast<std::size_t>(file.vertices()));
  arrays.triangles.resize(static_cast<std::size_t>(file.triangles()));
  io::PlyMeshParts::Bytes buffer;
  in_parts(file.vertices(), rows, [&](std::int64_t first, std::int64_t count) {
    file.read_vertices(first, count, buffer, arrays.vertices.data() + first);
  });
  in_parts(file.triangles(), rows, [&](std::int64_t first, std::int64_t count) {
    file.read_triangles(first, count, buffer, arrays.triangles.data() + first);
  });
  return arrays;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  const fuzz::InputFile file("fuzz.ply", data, size);
  const std::string path = file.path();
  const std::optional<Mesh> whole =
      fuzz::read_or_nothing([&] { return read_mesh(path, {.shift = std::nullopt, .threads = 1}); });
  try {
    if (const auto parts = io::PlyMeshParts::open(path)) {
      const Arrays all = read_in_parts(*parts, 1 << 20), few = read_in_parts(*parts, 3);
      require(same_bytes(all.vertices, few.vertices) && same_bytes(all.triangles, few.triangles));
      require(whole && same_bytes(all.vertices, whole->vertices) && same_bytes(all.triangles, whole->triangles));
    }
  } catch (const Error& error) {
    require(!whole || error.code() == ErrorCode::over_limit);  // which a face that is no triangle is
  }
  return 0;
}
