#include "mesh/compared_side.hpp"

#include <pointskin/error.hpp>

#include <cmath>
#include <limits>

#include "mesh/mesh_checks.hpp"
#include "mesh/point_tree.hpp"
#include "mesh/triangle_tree.hpp"

namespace pointskin::mesh_detail {
namespace {

class MeshSide : public ComparedSide {
 public:
  MeshSide(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset)
      : sampler_(ex, mesh, offset), tree_(ex, mesh, offset) {}

  [[nodiscard]] std::int64_t samples(std::int64_t wanted) const override { return wanted; }
  [[nodiscard]] SurfaceSample sample(std::int64_t i, std::int64_t n) const override { return sampler_.sample(i, n); }
  [[nodiscard]] Nearest nearest(const Vec3d& p, std::int32_t hint) const override { return tree_.nearest(p, hint); }
  [[nodiscard]] Vec3d normal(std::int32_t slot) const override {
    return normalized(tree_.triangle(slot).area_vector());
  }

 private:
  SurfaceSampler sampler_;
  TriangleTree tree_;
};

class CloudSide : public ComparedSide {
 public:
  CloudSide(exec::Cpu& ex, const Cloud& cloud, const Vec3d& offset)
      : cloud_(cloud), tree_(ex, cloud.positions, offset) {}

  [[nodiscard]] std::int64_t samples(std::int64_t wanted) const override { return std::min(wanted, cloud_.size()); }
  [[nodiscard]] SurfaceSample sample(std::int64_t i, std::int64_t n) const override {
    const auto slot = static_cast<std::int32_t>(i * cloud_.size() / n);
    return {tree_.point(slot), normal(slot)};
  }
  [[nodiscard]] Nearest nearest(const Vec3d& p, std::int32_t hint) const override { return tree_.nearest(p, hint); }
  [[nodiscard]] Vec3d normal(std::int32_t slot) const override {
    if (!cloud_.has_normals()) return {0, 0, 0};
    return normalized(to_double(cloud_.normals[static_cast<std::size_t>(tree_.id(slot))]));
  }

 private:
  const Cloud& cloud_;
  PointTree tree_;
};

double diagonal_of(exec::Cpu& ex, const Mesh& mesh, const std::string& role) {
  if (mesh.triangles.empty()) throw Error(ErrorCode::invalid_input, role + " has no triangle");
  try {
    check_indices(ex, mesh);
  } catch (const Error& error) {
    throw error.while_doing("checking " + role);
  }
  const CornerBounds box = corner_bounds(ex, mesh);
  if (!box.finite) throw Error(ErrorCode::invalid_input, role + " has a vertex that is not finite");
  return box.diagonal();
}

double diagonal_of(const Cloud& cloud, const std::string& role) {
  if (cloud.positions.empty()) throw Error(ErrorCode::invalid_input, role + " has no points");
  if (cloud.size() > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, role + " has more points than 32-bit ids can name");
  for (const Vec3f& p : cloud.positions)
    if (!std::isfinite(p.x) || !std::isfinite(p.y) || !std::isfinite(p.z))
      throw Error(ErrorCode::invalid_input, role + " has a point that is not finite");
  const Bounds box = bounds_of(cloud.positions);
  return length(to_double(box.upper) - to_double(box.lower));
}

}  // namespace

std::unique_ptr<ComparedSide> prepare(exec::Cpu& ex, const ComparedSurface& surface, const Vec3d& offset) {
  if (surface.mesh() != nullptr) return std::make_unique<MeshSide>(ex, *surface.mesh(), offset);
  return std::make_unique<CloudSide>(ex, *surface.cloud(), offset);
}

double checked_diagonal(exec::Cpu& ex, const ComparedSurface& surface, const std::string& role) {
  if (surface.mesh() != nullptr) return diagonal_of(ex, *surface.mesh(), role);
  return diagonal_of(*surface.cloud(), role);
}

}  // namespace pointskin::mesh_detail
