#include "spacing.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

#include <pointskin/cloud.hpp>

namespace pointskin::scene {
namespace {

using Point = std::array<float, 3>;  // The longest axis first.

std::vector<Point> sorted_along_longest_axis(const std::vector<Vec3f>& positions) {
  const Bounds box = bounds_of(positions);
  const Point extent = {box.upper.x - box.lower.x, box.upper.y - box.lower.y, box.upper.z - box.lower.z};
  const auto longest = static_cast<std::size_t>(std::max_element(extent.begin(), extent.end()) - extent.begin());
  std::vector<Point> points;
  points.reserve(positions.size());
  for (const Vec3f& p : positions) {
    const Point xyz = {p.x, p.y, p.z};
    points.push_back({xyz[longest], xyz[(longest + 1) % 3], xyz[(longest + 2) % 3]});
  }
  std::sort(points.begin(), points.end());
  return points;
}

double squared_distance(const Point& a, const Point& b) {
  double sum = 0;
  for (std::size_t k = 0; k < 3; ++k) sum += std::pow(double{a[k]} - double{b[k]}, 2);
  return sum;
}

/// Walks from point i both ways until the first axis alone is farther than the nearest found.
double nearest_squared(const std::vector<Point>& points, std::size_t i) {
  double best = std::numeric_limits<double>::infinity();
  const auto too_far = [&](std::size_t j) { return std::pow(double{points[j][0]} - double{points[i][0]}, 2) >= best; };
  for (std::size_t j = i + 1; j < points.size() && !too_far(j); ++j) {
    best = std::min(best, squared_distance(points[i], points[j]));
  }
  for (std::size_t j = i; j-- > 0 && !too_far(j);) best = std::min(best, squared_distance(points[i], points[j]));
  return best;
}

}  // namespace

double median_spacing(const std::vector<Vec3f>& positions, int samples) {
  if (positions.size() < 2 || samples < 1) return 0;
  const std::vector<Point> points = sorted_along_longest_axis(positions);
  const std::size_t count = std::min(points.size(), static_cast<std::size_t>(samples));
  std::vector<double> squared;
  for (std::size_t s = 0; s < count; ++s) squared.push_back(nearest_squared(points, s * points.size() / count));
  const auto middle = squared.begin() + static_cast<std::ptrdiff_t>(count / 2);
  std::nth_element(squared.begin(), middle, squared.end());
  return std::sqrt(*middle);
}

}  // namespace pointskin::scene
