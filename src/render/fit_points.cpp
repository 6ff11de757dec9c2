#include "render/fit_points.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::render_detail {
namespace {

bool is_finite(const Vec3f& p) { return std::isfinite(p.x) && std::isfinite(p.y) && std::isfinite(p.z); }

}  // namespace

FitPoints::FitPoints(const Mesh& mesh, const std::optional<WorldBox>& box)
    : positions_{mesh.vertices.data(), static_cast<std::int64_t>(mesh.vertices.size())} {
  if (box) {
    use_box(*box, mesh.origin);
    return;
  }
  used_.assign(mesh.vertices.size(), 0);
  for (const Triangle& t : mesh.triangles)
    for (const std::int32_t id : t) used_[static_cast<std::size_t>(id)] = 1;
  for (std::size_t v = 0; v < used_.size(); ++v)
    if (!is_finite(mesh.vertices[v])) used_[v] = 0;
}

FitPoints::FitPoints(const Cloud& cloud, const std::optional<WorldBox>& box, int threads)
    : positions_{cloud.positions.data(), static_cast<std::int64_t>(cloud.positions.size())} {
  if (box) {
    use_box(*box, cloud.origin);
    return;
  }
  const bool all = std::all_of(cloud.positions.begin(), cloud.positions.end(), is_finite);
  const Strays strays = all ? find_strays(cloud.positions, threads) : Strays();  // which wants finite positions
  if (all && strays.points.empty()) return;
  used_.assign(cloud.positions.size(), 1);
  for (std::size_t i = 0; i < used_.size(); ++i)
    if (!is_finite(cloud.positions[i])) used_[i] = 0;
  strays_ = static_cast<std::int64_t>(strays.points.size());
  for (const std::int64_t i : strays.points) used_[static_cast<std::size_t>(i)] = 0;
}

void FitPoints::use_box(const WorldBox& box, const Vec3d& origin) {
  const Vec3d corners[2] = {box.lower - origin, box.upper - origin};
  for (std::size_t k = 0; k < 8; ++k)
    corners_.push_back({static_cast<float>(corners[k & 1][0]), static_cast<float>(corners[k >> 1 & 1][1]),
                        static_cast<float>(corners[k >> 2][2])});
}

ArrayView<const Vec3f> FitPoints::view() const {
  if (corners_.empty()) return positions_;
  return {corners_.data(), static_cast<std::int64_t>(corners_.size())};
}

Box FitPoints::box(exec::Cpu& ex) const {
  return reduce(
      ex, Box(), [](Box& sum, const Vec3d& p) { sum.add(p, p); },
      [](Box& sum, const Box& part) { sum.add(part.lower, part.upper); });
}

Vec3d FitPoints::centre(exec::Cpu& ex) const {
  const Box box = this->box(ex);
  if (box.lower[0] > box.upper[0]) return {0, 0, 0};
  return 0.5 * (box.lower + box.upper);
}

double FitPoints::radius_about(exec::Cpu& ex, const Vec3d& place) const {
  const double squared = reduce(
      ex, 0.0, [&](double& most, const Vec3d& p) { most = std::max(most, squared_length(p - place)); },
      [](double& most, double part) { most = std::max(most, part); });
  return std::sqrt(squared);
}

}  // namespace pointskin::render_detail
