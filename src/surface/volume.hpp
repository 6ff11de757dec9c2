// The volume of a closed mesh in the unit cube, in integers: exact, in any order of the triangles.
#pragma once

#include <cstdint>

#include <pointskin/vector.hpp>

#include "core/array_view.hpp"
#include "core/host_device.hpp"
#include "exec/space.hpp"
#include "surface/extract.hpp"

namespace pointskin::surface {

/// Vertices are rounded to 2^-n of the cube's side: a sixteenth of a cell, or so that six times the cube's volume fits.
inline int depth_of_quanta(int depth) { return depth <= 16 ? depth + 4 : 20; }

/// Six times the signed volume of the tetrahedron of a triangle and the cube's corner at 0, in quanta^3, modulo 2^64.
/// The sum over a closed mesh in the unit cube is less than 2^63.
struct SixVolumes {
  ArrayView<const Triangle> triangles;
  ArrayView<const Vec3f> positions;
  float quanta;  // in the unit cube's side

  [[nodiscard]] PSK_HD std::uint64_t rounded(float v) const {
    return static_cast<std::uint64_t>(static_cast<std::int64_t>(v * quanta + 0.5F));
  }
  PSK_HD std::uint64_t operator()(std::int64_t t) const {
    const std::int32_t* v = triangles[t].data();
    std::uint64_t p[3][3];
    for (int k = 0; k < 3; ++k) {
      const Vec3f at = positions[v[k]];
      p[k][0] = rounded(at.x);
      p[k][1] = rounded(at.y);
      p[k][2] = rounded(at.z);
    }
    const std::uint64_t x = p[1][1] * p[2][2] - p[1][2] * p[2][1];
    const std::uint64_t y = p[1][2] * p[2][0] - p[1][0] * p[2][2];
    const std::uint64_t z = p[1][0] * p[2][1] - p[1][1] * p[2][0];
    return p[0][0] * x + p[0][1] * y + p[0][2] * z;
  }
};

/// Of a mesh of the extraction from an octree whose finest cells are 2^-depth wide. The mesh must live as long.
inline SixVolumes volumes_of(int depth, const Surface& mesh) {
  return {mesh.triangles.cview(), mesh.positions.cview(),
          static_cast<float>(std::int64_t{1} << depth_of_quanta(depth))};
}

/// 1 if a closed mesh encloses a volume, -1 if it is inside out, 0 if what it encloses is no more than rounding alone can
/// make of nothing: (1/16 cell)^3 for each triangle. A mesh of the extraction, with about two triangles a cell, has more
/// where it is a thousandth of a cell thick. O(triangles), one host round trip.
template <exec::Space Exec>
int sign_of_volume(Exec& ex, int depth, const Surface& mesh);

}  // namespace pointskin::surface
