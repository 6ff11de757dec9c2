// Shadows by a second picture, which the light sees.
// Sources: Williams, "Casting curved shadows on curved surfaces", SIGGRAPH 1978; Reeves, Salesin & Cook, "Rendering
// antialiased shadows with depth maps", SIGGRAPH 1987 (shares of samples instead of yes and no).
// Differs: a sample is compared with the plane of the surface, not with one depth, so that slanting surfaces do not
// shade themselves.
#include "render/shadow.hpp"

#include <algorithm>
#include <array>
#include <cmath>

#include "core/vec3.hpp"
#include "render/band_lists.hpp"
#include "render/shading.hpp"

namespace pointskin::render_detail {
namespace {

constexpr std::int32_t kLightPixels = 704;
/// Radius of the light's disc, and by how much something must be nearer to the light to shade, in cells.
constexpr float kSoftness = 4.5F, kBias = 1.6F;
constexpr int kRays = 4;  // a cell

}  // namespace

RenderOptions light_options(const RenderOptions& options, const Camera& camera) {
  RenderOptions light;
  light.width = light.height = kLightPixels;
  light.projection = Projection::orthographic;
  light.fit = Fit::sphere;
  light.fit_world = options.fit_world;
  light.up = options.up;
  light.back_faces = options.back_faces;
  light.threads = options.threads;
  const ViewAngles angles = view_angles(options.up, camera.to_world(key_light_direction()));
  constexpr double kDegree = 3.14159265358979323846 / 180;
  light.azimuth_degrees = angles.azimuth / kDegree;
  light.elevation_degrees = angles.elevation / kDegree;
  return light;
}

ShadowMap::ShadowMap(exec::Cpu& ex, const Drawing& drawing, const Camera& light, const Camera& viewer,
                     const RenderOptions& options)
    : map_(ex, drawing, BandLists(ex, drawing, options.height, light.step_bits()), light,
           {options.width, options.height, std::int64_t{kLightPixels} * kLightPixels}),
      towards_(to_float(key_light_direction())),
      radius_(light.radius()) {
  // A linear map is known from where it takes four places.
  const auto on_light = [&](const Vec3d& place) {
    const Vec3d q = light.place(viewer.point_at(place));
    const double steps = 1 << light.step_bits();
    return Vec3d{(light.middle_x() + light.focal() * q[0]) / steps - 0.5,
                 (light.middle_y() - light.focal() * q[1]) / steps - 0.5, q[2] + 2};
  };
  const double eye = viewer.perspective() ? viewer.distance() : 0;
  const Vec3d zero = on_light({0, 0, eye});
  const Vec3d x = on_light({1, 0, eye}) - zero;
  const Vec3d y = on_light({0, 1, eye}) - zero;
  const Vec3d z = on_light({0, 0, eye + 1}) - zero;
  Row* const rows[3] = {&column_, &row_, &nearness_};
  for (std::size_t k = 0; k < 3; ++k) *rows[k] = {to_float({x[k], y[k], z[k]}), static_cast<float>(zero[k])};
}

float ShadowMap::reaches(const Vec3f& place, const Vec3f& normal, std::int32_t column, std::int32_t row) const {
  const float facing = dot(normal, towards_);
  if (facing < 0.02F) return 1;  // it has no light of the lamp to lose
  const float x = column_.of(place), y = row_.of(place), near = nearness_.of(place);
  // By how much the surface's plane comes nearer to the light from a cell to the next.
  const float cell = map_.slant(near);
  const Vec3f right = (1 / std::sqrt(dot(column_.along, column_.along))) * column_.along;
  const Vec3f down = (1 / std::sqrt(dot(row_.along, row_.along))) * row_.along;
  const float slope_x = std::clamp(-dot(normal, right) / facing, -4.0F, 4.0F) * cell;
  const float slope_y = std::clamp(-dot(normal, down) / facing, -4.0F, 4.0F) * cell;
  const std::uint32_t of_cell = static_cast<std::uint32_t>(column & 3) * 4 + static_cast<std::uint32_t>(row & 3);
  int through = 0;
  for (std::uint32_t k = 0; k < kRays; ++k) {
    const SunRay& ray = rays()[(of_cell * 7) % 16 + 16 * k];
    const auto c = static_cast<std::int32_t>(x + kSoftness * ray.x + 0.5F);
    const auto r = static_cast<std::int32_t>(y + kSoftness * ray.y + 0.5F);
    if (!map_.holds(c, r)) {
      ++through;
      continue;
    }
    const float expected = near + slope_x * (static_cast<float>(c) - x) + slope_y * (static_cast<float>(r) - y);
    through += map_.nearness(map_.index(c, r)) <= expected + kBias * cell + slack_ ? 1 : 0;
  }
  return static_cast<float>(through) / kRays;
}

/// Places in a unit disc, every sixteenth of which cover it evenly, too.
const std::array<ShadowMap::SunRay, 64>& ShadowMap::rays() {
  static const std::array<SunRay, 64> kPlaces = [] {
    std::array<SunRay, 64> places{};
    constexpr float kGoldenAngle = 2.39996323F;
    for (std::size_t i = 0; i < places.size(); ++i) {
      const float radius = std::sqrt((static_cast<float>(i) + 0.5F) / static_cast<float>(places.size()));
      const float angle = kGoldenAngle * static_cast<float>(i);
      places[i] = {radius * std::cos(angle), radius * std::sin(angle)};
    }
    return places;
  }();
  return kPlaces;
}

CellFloats key_light_of(exec::Cpu& ex, const DepthMap& map, const std::vector<Vec3f>& normals,
                        const ShadowMap& shadows) {
  return smoothed(ex, map, for_cells(ex, map, [&](std::int32_t c, std::int32_t r) {
                    const std::size_t cell = map.index(c, r);
                    return map.nearness(cell) == 0 ? 1.0F : shadows.reaches(map.place(c, r), normals[cell], c, r);
                  }));
}

}  // namespace pointskin::render_detail
