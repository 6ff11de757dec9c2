#include "mesh/oriented_samples.hpp"
#include "core/vec3.hpp"

#include <pointskin/error.hpp>

#include <algorithm>
#include <cmath>
#include <limits>

#include "exec/cpu_primitives.hpp"
#include "mesh/mesh_checks.hpp"
#include "mesh/surface_samples.hpp"

namespace pointskin::mesh_detail {
namespace {}  // namespace

Bounds bounds_of_solid(const Mesh& mesh, int threads) {
  const auto fail = [](const char* what) { throw Error(ErrorCode::invalid_input, what); };
  if (mesh.triangles.empty()) fail("the mesh has no triangles; a Boolean needs a closed mesh");
  const MeshReport report = measure(mesh, threads);
  exec::Cpu ex(threads);
  const CornerBounds box = corner_bounds(ex, mesh);
  if (!box.finite) fail("the mesh has vertices that are not finite");
  if (!report.closed()) fail("the mesh is not closed; a Boolean needs a closed mesh");
  if (!report.oriented()) fail("the triangles of the mesh are not oriented consistently");
  if (!(report.volume > 0)) fail("the mesh has no volume, or is turned inside out");
  return {to_float(box.lower), to_float(box.upper)};
}

Cloud sample_surface(const Mesh& mesh, double spacing, int threads) {
  exec::Cpu ex(threads);
  const MeshReport report = measure(mesh, threads);
  const double wanted = std::ceil(report.area / (spacing * spacing));
  if (wanted > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "the mesh would need more than 2^31 - 1 samples; choose a smaller depth");
  const auto n = std::max(static_cast<std::int64_t>(wanted), std::int64_t{1});
  const SurfaceSampler sampler(ex, mesh, Vec3d{});
  Cloud cloud;
  cloud.origin = mesh.origin;
  cloud.positions.resize(static_cast<std::size_t>(n));
  cloud.normals.resize(static_cast<std::size_t>(n));
  Vec3f* const positions = cloud.positions.data();
  Vec3f* const normals = cloud.normals.data();
  for_each(ex, "samples", n, [&](std::int64_t i) {
    const SurfaceSample sample = sampler.sample(i, n);
    positions[i] = to_float(sample.point);
    normals[i] = to_float(sample.normal);
  });
  return cloud;
}

}  // namespace pointskin::mesh_detail
