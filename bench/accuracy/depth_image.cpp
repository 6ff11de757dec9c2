// Normals are those of the tangents of P(x, y) = o + t(x, y) d(x, y), with the slopes of t from a least-squares fit:
// finite differences over a window of pixels (Haralick & Watson, "A facet model for image data", CGIP 15, 1981).
#include "depth_image.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

#include "core/vec3.hpp"

namespace pointskin::bench {
namespace {

/// Sums of a least-squares fit t = a x + b y + c.
struct PlaneFit {
  double n = 0, x = 0, y = 0, t = 0, xx = 0, xy = 0, yy = 0, xt = 0, yt = 0;

  void add(double px, double py, double pt) {
    n += 1, x += px, y += py, t += pt;
    xx += px * px, xy += px * py, yy += py * py;
    xt += px * pt, yt += py * pt;
  }

  /// a and b, or nothing if the points lie on a line.
  [[nodiscard]] std::optional<std::array<double, 2>> slopes() const {
    const double cxx = xx - x * x / n, cxy = xy - x * y / n, cyy = yy - y * y / n;
    const double cxt = xt - x * t / n, cyt = yt - y * t / n;
    const double det = cxx * cyy - cxy * cxy;
    if (!(det > 0.1)) return std::nullopt;  // x and y are whole pixels: three corners of a pixel have 1/3
    return std::array{(cyy * cxt - cxy * cyt) / det, (cxx * cyt - cxy * cxt) / det};
  }
};

}  // namespace

Vec3d Camera::direction(int row, int column) const {
  const double x = pixel() * (column + 0.5) - half_width, y = pixel() * (row + 0.5) - half_width;
  return normalized(forward + (x * right + y * up));
}

std::array<Vec3d, 2> Camera::direction_derivatives(int row, int column) const {
  const Vec3d d = direction(row, column);
  const double scale = dot(d, forward);  // 1 / |forward + x right + y up|
  return {scale * (right - dot(d, right) * d), scale * (up - dot(d, up) * d)};
}

DepthImage::DepthImage(const Camera& camera) : camera_(camera) {
  const auto pixels = static_cast<std::size_t>(camera.resolution) * static_cast<std::size_t>(camera.resolution);
  ranges_.resize(pixels, std::numeric_limits<double>::infinity());
  normals_.resize(pixels);
}

void DepthImage::take_row(const Scene& scene, int row, const std::function<double(int)>& noise) {
  for (int column = 0; column < camera_.resolution; ++column) {
    const auto hit = scene.first_hit({camera_.position, camera_.direction(row, column)});
    if (!hit) continue;
    ranges_[at(row, column)] = hit->range + noise(column);
    normals_[at(row, column)] = hit->normal;
  }
}

bool DepthImage::has(int row, int column) const {
  return row >= 0 && row < camera_.resolution && column >= 0 && column < camera_.resolution &&
         std::isfinite(range(row, column));
}

Vec3d DepthImage::point(int row, int column) const {
  return camera_.position + range(row, column) * camera_.direction(row, column);
}

std::optional<Vec3d> DepthImage::fitted_normal(int row, int column, int window, const Jump& jump) const {
  const double here = range(row, column);
  const double footprint = here * camera_.pixel();
  PlaneFit fit;
  for (int dy = -window; dy <= window; ++dy) {
    for (int dx = -window; dx <= window; ++dx) {
      if (!has(row + dy, column + dx)) continue;
      const double there = range(row + dy, column + dx);
      const double reach = footprint * std::sqrt(static_cast<double>(dx * dx + dy * dy));
      if (std::abs(there - here) <= jump.slope * reach + jump.noise) fit.add(dx, dy, there - here);
    }
  }
  const double pixels = (2 * window + 1) * (2 * window + 1);
  if (fit.n < pixels / 2) return std::nullopt;
  const auto slopes = fit.slopes();
  if (!slopes) return std::nullopt;
  const Vec3d d = camera_.direction(row, column);
  const auto [d_x, d_y] = camera_.direction_derivatives(row, column);
  const double pixel = camera_.pixel();
  const Vec3d p_x = (*slopes)[0] / pixel * d + here * d_x;
  const Vec3d p_y = (*slopes)[1] / pixel * d + here * d_y;
  return cross(p_x, p_y);
}

}  // namespace pointskin::bench
