// Normals from a depth map: the plane through a cell and its neighbours, of which those that are much nearer or farther
// do not count, since they belong to something else.
#include <algorithm>
#include <cmath>

#include "render/depth_map.hpp"

namespace pointskin::render_detail {
namespace {

/// Change of the nearness over a cell to the right and downwards.
struct Slope {
  float x, y;
};

/// Sums of a fit of nearness as a linear function of column and row.
struct PlaneSums {
  float w = 0, x = 0, y = 0, xx = 0, xy = 0, yy = 0, n = 0, xn = 0, yn = 0;

  void add(float dx, float dy, float dn, float weight) {
    w += weight;
    x += weight * dx;
    y += weight * dy;
    xx += weight * dx * dx;
    xy += weight * dx * dy;
    yy += weight * dy * dy;
    n += weight * dn;
    xn += weight * dx * dn;
    yn += weight * dy * dn;
  }

  /// A little stiffness keeps slopes of few neighbours small.
  [[nodiscard]] Slope slope() const {
    const float cxx = xx - x * x / w + 0.05F, cyy = yy - y * y / w + 0.05F, cxy = xy - x * y / w;
    const float cxn = xn - x * n / w, cyn = yn - y * n / w;
    const float determinant = cxx * cyy - cxy * cxy;
    return {(cxn * cyy - cyn * cxy) / determinant, (cyn * cxx - cxn * cxy) / determinant};
  }
};

class NormalsOfDepth {
 public:
  NormalsOfDepth(const DepthMap& map, int reach) : map_(map), reach_(reach) {}

  [[nodiscard]] Vec3f at(std::int32_t column, std::int32_t row) const {
    const float near = map_.nearness(map_.index(column, row));
    if (near == 0) return {};
    const Slope slope = reach_ == 1 ? Slope{least_change(column, row, 1, 0), least_change(column, row, 0, 1)}
                                    : plane(column, row, near).slope();
    // Nearness is linear on a plane, so its slope gives two directions along the plane.
    const Vec3f here = map_.place(column, row, near);
    const Vec3f right = map_.place(column + 1, row, std::max(near + slope.x, 0.5F * near)) - here;
    const Vec3f down = map_.place(column, row + 1, std::max(near + slope.y, 0.5F * near)) - here;
    Vec3f normal = cross(down, right);
    if (dot(normal, map_.to_viewer(here)) < 0) normal = -1.0F * normal;
    const float length = std::sqrt(dot(normal, normal));
    return length > 0 ? (1 / length) * normal : Vec3f{0, 0, 1};
  }

 private:
  /// Of the changes to both sides the smaller one: the other may lead to another surface.
  [[nodiscard]] float least_change(std::int32_t column, std::int32_t row, std::int32_t dx, std::int32_t dy) const {
    const float near = map_.nearness(map_.index(column, row));
    float least = 0;
    bool found = false;
    for (const std::int32_t side : {1, -1}) {
      if (!map_.holds(column + side * dx, row + side * dy)) continue;
      const float other = map_.nearness(map_.index(column + side * dx, row + side * dy));
      const float change = static_cast<float>(side) * (other - near);
      if (other == 0 || (found && std::abs(change) >= std::abs(least))) continue;
      least = change;
      found = true;
    }
    return least;
  }

  [[nodiscard]] PlaneSums plane(std::int32_t column, std::int32_t row, float near) const {
    // A neighbour counts up to a slope of about 75 degrees.
    const float cell = 4 * map_.slant(near);
    PlaneSums sums;
    for (int dy = -reach_; dy <= reach_; ++dy)
      for (int dx = -reach_; dx <= reach_; ++dx) {
        if (!map_.holds(column + dx, row + dy)) continue;
        const float other = map_.nearness(map_.index(column + dx, row + dy));
        if (other == 0) continue;
        const float steps = std::sqrt(static_cast<float>(dx * dx + dy * dy));
        const float off = (other - near) / (cell * std::max(steps, 1.0F));
        const float weight = std::max(0.0F, 1 - off * off);
        sums.add(static_cast<float>(dx), static_cast<float>(dy), other - near, weight);
      }
    return sums;
  }

  const DepthMap& map_;
  int reach_;
};

}  // namespace

std::vector<Vec3f> normals_of(exec::Cpu& ex, const DepthMap& map, int reach) {
  const NormalsOfDepth depth(map, reach);
  std::vector<Vec3f> normals(static_cast<std::size_t>(map.width()) * static_cast<std::size_t>(map.height()));
  ex.run_blocks(map.height(), [&](std::int64_t r) {
    const auto row = static_cast<std::int32_t>(r);
    for (std::int32_t column = 0; column < map.width(); ++column)
      normals[map.index(column, row)] = depth.at(column, row);
  });
  return normals;
}

}  // namespace pointskin::render_detail
