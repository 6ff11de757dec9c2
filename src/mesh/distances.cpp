// Distances of all vertices or points from a reference.
#include <pointskin/error.hpp>
#include <pointskin/mesh.hpp>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <vector>

#include "core/vec3.hpp"
#include "exec/cpu_primitives.hpp"
#include "mesh/compared_side.hpp"
#include "mesh/signed_distance.hpp"

namespace pointskin {
namespace {

using exec::Cpu;

/// Positions per block: neighbours in a block start their search at each other's nearest triangle or point.
constexpr std::int64_t kBlock = 1024;

const std::vector<Vec3f>& positions_of(const ComparedSurface& surface) {
  return surface.mesh() != nullptr ? surface.mesh()->vertices : surface.cloud()->positions;
}

/// measure(p, hint) of every position, moved by `offset`; it sets the hint for the next one. NaN where a position is
/// not finite, which vertices that no triangle uses may be.
template <class Measure>
std::vector<double> measure_all(Cpu& ex, const std::vector<Vec3f>& positions, const Vec3d& offset,
                                const Measure& measure) {
  std::vector<double> result(positions.size());
  const auto n = static_cast<std::int64_t>(positions.size());
  ex.run_blocks(exec::block_count(n, kBlock), [&](std::int64_t block) {
    std::int32_t hint = -1;
    for (std::int64_t i = block * kBlock; i < std::min(n, (block + 1) * kBlock); ++i) {
      const Vec3f& p = positions[static_cast<std::size_t>(i)];
      const bool finite = std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z);
      result[static_cast<std::size_t>(i)] =
          finite ? measure(offset + to_double(p), hint) : std::numeric_limits<double>::quiet_NaN();
    }
  });
  return result;
}

const Mesh& watertight_mesh(const ComparedSurface& reference, int threads) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::invalid_input, what); };
  if (reference.mesh() == nullptr) fail("the reference is a cloud; signed distances need a watertight mesh");
  if (!measure(*reference.mesh(), threads).watertight())
    fail("the reference is not watertight; signed distances need to know its inside");
  return *reference.mesh();
}

}  // namespace

std::vector<double> distances(const ComparedSurface& surface, const ComparedSurface& reference,
                              const DistanceOptions& options) {
  Cpu ex(options.threads);
  mesh_detail::checked_diagonal(ex, surface, surface.mesh() != nullptr ? "the mesh" : "the cloud");
  mesh_detail::checked_diagonal(ex, reference, "the reference");
  // In the reference's coordinates, as compare().
  const Vec3d offset = surface.origin() - reference.origin();
  if (options.with_sign) {
    const mesh_detail::SignedDistance field(ex, watertight_mesh(reference, options.threads), Vec3d{0, 0, 0});
    return measure_all(ex, positions_of(surface), offset, [&](const Vec3d& p, std::int32_t& hint) {
      const mesh_detail::SurfacePlace place = field.at(p, hint);
      hint = place.slot;
      return 0.0 - place.distance;  // 0 stays above 0
    });
  }
  const auto side = mesh_detail::prepare(ex, reference, Vec3d{0, 0, 0});
  return measure_all(ex, positions_of(surface), offset, [&](const Vec3d& p, std::int32_t& hint) {
    const mesh_detail::Nearest nearest = side->nearest(p, hint);
    hint = nearest.slot;
    return std::sqrt(nearest.squared_distance);
  });
}

}  // namespace pointskin
