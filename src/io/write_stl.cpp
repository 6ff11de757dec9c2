#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstring>
#include <limits>
#include <string_view>
#include <utility>

#include "core/vec3.hpp"
#include "io/scalar.hpp"
#include "io/writers.hpp"

namespace pointskin::io {
namespace {

constexpr std::size_t kHeaderBytes = 84;
constexpr std::size_t kTriangleBytes = 50;
constexpr std::string_view kTitle = "binary STL of pointskin";  // must not start with "solid", which marks text

/// Unit normal of the triangle, from coordinates relative to the origin; zero for a triangle without area.
Vec3f normal_of(const Vec3f& a, const Vec3f& b, const Vec3f& c) {
  const Vec3d n = cross(to_double(b) - to_double(a), to_double(c) - to_double(a));
  const double size = length(n);
  if (!(size > 0)) return {};
  return {to_float(n.x / size), to_float(n.y / size), to_float(n.z / size)};
}

void store_triangle(const Mesh& mesh, const Triangle& triangle, char* out) {
  const auto at = [&](std::size_t corner) { return mesh.vertices[static_cast<std::size_t>(triangle[corner])]; };
  std::array<Vec3f, 4> values{normal_of(at(0), at(1), at(2))};
  for (std::size_t corner = 0; corner < 3; ++corner) {
    const Vec3d w = world(mesh.origin, at(corner));
    values[corner + 1] = {to_float(w[0]), to_float(w[1]), to_float(w[2])};
  }
  std::memcpy(out, values.data(), sizeof(values));
}

}  // namespace

Blocks format_stl(const Mesh& mesh, const WriteOptions& /*options*/) {
  const std::size_t count = mesh.triangles.size();
  if (count > std::numeric_limits<std::uint32_t>::max())
    throw Error(ErrorCode::over_limit, "STL holds at most 4294967295 triangles; write PLY instead");
  std::string header(kHeaderBytes, '\0');
  std::copy(kTitle.begin(), kTitle.end(), header.begin());
  const auto stored_count = static_cast<std::uint32_t>(count);
  std::memcpy(header.data() + kHeaderBytes - sizeof(stored_count), &stored_count, sizeof(stored_count));
  const auto append = [&mesh](std::size_t first, std::size_t last, std::string& bytes) {
    const std::size_t before = bytes.size();
    bytes.resize(before + (last - first) * kTriangleBytes);
    for (std::size_t t = first; t < last; ++t)
      store_triangle(mesh, mesh.triangles[t], bytes.data() + before + (t - first) * kTriangleBytes);
  };
  return cut_into_blocks(std::move(header), {{count, append}});
}

}  // namespace pointskin::io
