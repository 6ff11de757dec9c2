// Ambient occlusion: how much of the sky over a place its surroundings hide, as far as the picture shows them.
// Source: Jimenez, Wu, Pesce & Jarabo, "Practical real-time strategies for accurate indirect occlusion", SIGGRAPH 2016
// courses (the horizons of slices through the line of sight, and the integral between them).
// Differs: sixteen cells in a square share 32 directions, and a filter four cells wide averages over all of them; a
// place that nothing hides has exactly 1.
#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>

#include "render/depth_map.hpp"

namespace pointskin::render_detail {
namespace {

constexpr float kPi = std::numbers::pi_v<float>;
constexpr int kSlices = 2, kSteps = 8;
/// Of the radius; nearer than this what hides is the surface itself.
constexpr float kNearest = 0.02F;

class Occlusion {
 public:
  Occlusion(const DepthMap& map, const std::vector<Vec3f>& normals, float radius_cells)
      : map_(map), normals_(normals), radius_cells_(radius_cells) {
    for (std::size_t i = 0; i < directions_.size(); ++i) {
      const float angle = kPi * static_cast<float>(i) / static_cast<float>(directions_.size());
      directions_[i] = {std::cos(angle), std::sin(angle)};
    }
  }

  [[nodiscard]] float at(std::int32_t column, std::int32_t row) const {
    const std::size_t cell = map_.index(column, row);
    if (map_.nearness(cell) == 0) return 1;
    const Vec3f place = map_.place(column, row);
    const Vec3f viewer = map_.to_viewer(place);
    // The order of directions in the square: neighbours differ much.
    constexpr std::array<std::size_t, 16> kOrder = {0, 8, 2, 10, 12, 4, 14, 6, 3, 11, 1, 9, 15, 7, 13, 5};
    const std::size_t of_cell = kOrder[static_cast<std::size_t>(column & 3) + 4 * static_cast<std::size_t>(row & 3)];
    float open = 0, all = 0;
    for (std::size_t s = 0; s < kSlices; ++s) {
      const Direction& direction = directions_[of_cell + s * directions_.size() / kSlices];
      const float below = horizon({column, row, -direction.x, -direction.y}, place, viewer);
      const float above = horizon({column, row, direction.x, direction.y}, place, viewer);
      add_slice({below, above}, normals_[cell], viewer, {direction.x, -direction.y, 0}, open, all);
    }
    return all > 0 ? std::min(1.0F, open / all * 1.01F) : 1;
  }

 private:
  struct Direction {
    float x, y;
  };
  struct Walk {
    std::int32_t column, row;
    float x, y;
  };
  struct Horizons {
    float below, above;  // cosines of the angles from the line of sight, on both sides
  };

  /// Rounds without a call; walks do not leave the picture by more than the offset.
  [[nodiscard]] static std::int32_t nearest_cell(float at) {
    constexpr std::int32_t kOffset = 1 << 12;
    return static_cast<std::int32_t>(at + (static_cast<float>(kOffset) + 0.5F)) - kOffset;
  }

  /// Largest cosine of the angle between the line of sight and what stands along the walk; -1 if nothing does.
  [[nodiscard]] float horizon(const Walk& walk, const Vec3f& place, const Vec3f& viewer) const {
    const float radius = radius_cells_ / map_.cells_per_radius(map_.nearness(map_.index(walk.column, walk.row)));
    float highest = -1;
    for (int k = 1; k <= kSteps; ++k) {
      const float part = static_cast<float>(k) / kSteps;
      const float cells = std::max(radius_cells_ * part * part, static_cast<float>(k));  // denser near by
      const std::int32_t column = nearest_cell(static_cast<float>(walk.column) + cells * walk.x);
      const std::int32_t row = nearest_cell(static_cast<float>(walk.row) + cells * walk.y);
      if (!map_.holds(column, row) || map_.nearness(map_.index(column, row)) == 0) continue;
      const Vec3f to = map_.place(column, row) - place;
      const float squared = dot(to, to);
      const float away = squared / (radius * radius);
      if (away >= 1 || away < kNearest * kNearest) continue;
      // What is far away fades out instead of leaving suddenly.
      const float cosine = dot(to, viewer) / std::sqrt(squared);
      highest = std::max(highest, cosine - (cosine + 1) * away * away);
    }
    return highest;
  }

  /// Adds what a slice lets through, and what it would if nothing stood there.
  static void add_slice(const Horizons& horizons, const Vec3f& normal, const Vec3f& viewer, const Vec3f& along,
                        float& open, float& all) {
    const Vec3f side = along - dot(along, viewer) * viewer;
    const Vec3f axis = cross(side, viewer);
    const float axis_squared = dot(axis, axis);
    if (!(axis_squared > 0)) return;
    const Vec3f projected = normal - (dot(normal, axis) / axis_squared) * axis;
    const float length = std::sqrt(dot(projected, projected));
    if (!(length > 0)) return;
    const float cosine = std::clamp(dot(projected, viewer) / length, -1.0F, 1.0F);
    const float tilt = std::copysign(std::acos(cosine), dot(projected, side));
    const float sine = std::sin(tilt);
    const auto through = [&](float h) { return 0.25F * (2 * h * sine + cosine - std::cos(2 * h - tilt)); };
    const float above = std::min(std::acos(std::clamp(horizons.above, -1.0F, 1.0F)), tilt + kPi / 2);
    const float below = std::max(-std::acos(std::clamp(horizons.below, -1.0F, 1.0F)), tilt - kPi / 2);
    open += length * (through(above) + through(below));
    all += length * (cosine + tilt * sine);
  }

  const DepthMap& map_;
  const std::vector<Vec3f>& normals_;
  float radius_cells_;
  std::array<Direction, 16 * kSlices> directions_{};
};

}  // namespace

CellFloats openness_of(exec::Cpu& ex, const DepthMap& map, const std::vector<Vec3f>& normals, float radius_cells) {
  const Occlusion occlusion(map, normals, std::max(radius_cells, static_cast<float>(kSteps)));
  return smoothed(ex, map, for_cells(ex, map, [&](std::int32_t c, std::int32_t r) { return occlusion.at(c, r); }));
}

}  // namespace pointskin::render_detail
