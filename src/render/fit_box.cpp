// A point (x, y, z) of the view space lies within a frustum of half width t at unit depth and a viewer at (e, ., d) if
// |x - e| <= t (d - z). The nearest viewer follows from the largest x + t z and the largest -x + t z: their sum is
// 2 t d, their difference 2 e. The side that does not limit the distance has room left, and is centred by a search.
#include "render/fit_box.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

namespace pointskin::render_detail {
namespace {

constexpr double kInfinity = std::numeric_limits<double>::infinity();

/// How far points reach along one axis of the picture and its opposite.
struct Reach {
  double plus = -kInfinity, minus = -kInfinity;

  void include(double above, double below) {
    plus = std::max(plus, above);
    minus = std::max(minus, below);
  }
  void include(const Reach& other) { include(other.plus, other.minus); }
};

struct Reaches {
  Reach x, y;
  double nearest = -kInfinity;  // to the viewer

  void include(const Reaches& other) {
    x.include(other.x);
    y.include(other.y);
    nearest = std::max(nearest, other.nearest);
  }
};

Vec3d in_view(const ViewSpace& space, const Vec3d& p) {
  const Vec3d q = 1 / space.radius * (p - space.centre);
  return {dot(space.axes.right, q), dot(space.axes.up, q), dot(space.axes.back, q)};
}

/// The largest values of the four forms above.
Reaches reaches(exec::Cpu& ex, const FitPoints& points, const ViewSpace& space, const HalfExtent& slope) {
  const auto add = [&](Reaches& sum, const Vec3d& p) {
    const Vec3d q = in_view(space, p);
    sum.x.include(q[0] + slope.x * q[2], -q[0] + slope.x * q[2]);
    sum.y.include(q[1] + slope.y * q[2], -q[1] + slope.y * q[2]);
    sum.nearest = std::max(sum.nearest, q[2]);
  };
  return points.reduce(ex, Reaches(), add, [](Reaches& sum, const Reaches& part) { sum.include(part); });
}

/// How far points reach on the plane at unit depth before the viewer.
Reaches reaches_seen(exec::Cpu& ex, const FitPoints& points, const ViewSpace& space, const FittedView& viewer) {
  const auto add = [&](Reaches& sum, const Vec3d& p) {
    const Vec3d q = in_view(space, p);
    const double nearness = 1 / (viewer.distance - q[2]);
    const double x = (q[0] - viewer.x) * nearness;
    const double y = (q[1] - viewer.y) * nearness;
    sum.x.include(x, -x);
    sum.y.include(y, -y);
    sum.nearest = std::max(sum.nearest, nearness);
  };
  return points.reduce(ex, Reaches(), add, [](Reaches& sum, const Reaches& part) { sum.include(part); });
}

/// A search for the place at which a falling function is zero, between two places where it is not.
class FallingRoot {
 public:
  /// What is known of the function: it is `value` at `at`. @returns where to look next
  double next(double at, double value, double largest_slope) {
    (value > 0 ? low_ : high_) = Known{at, value};
    if (!low_ || !high_) return at + value / largest_slope;  // never too far where slopes are smaller
    return low_->at + (high_->at - low_->at) * low_->value / (low_->value - high_->value);
  }

 private:
  struct Known {
    double at, value;
  };
  std::optional<Known> low_, high_;
};

/// Moves the viewer until there is as much room on both sides of the picture.
void centre(exec::Cpu& ex, const FitPoints& points, const ViewSpace& space, FittedView& viewer) {
  constexpr int kMostRounds = 12;
  constexpr double kEnough = 1e-5;  // of the picture's half width: far below a pixel
  FallingRoot x, y;
  for (int round = 0; round < kMostRounds; ++round) {
    const Reaches seen = reaches_seen(ex, points, space, viewer);
    const double off_x = seen.x.plus - seen.x.minus;
    const double off_y = seen.y.plus - seen.y.minus;
    const double size = std::max(seen.x.plus + seen.x.minus, seen.y.plus + seen.y.minus);
    if (std::max(std::abs(off_x), std::abs(off_y)) <= kEnough * size) return;
    viewer.x = x.next(viewer.x, off_x, 2 * seen.nearest);
    viewer.y = y.next(viewer.y, off_y, 2 * seen.nearest);
  }
}

/// Half the room that is needed, or, about a fixed middle, the larger side of it.
double half_of(const Reach& reach, bool centred) {
  return centred ? (reach.plus + reach.minus) / 2 : std::max(reach.plus, reach.minus);
}

double middle_of(const Reach& reach, bool centred) { return centred ? (reach.plus - reach.minus) / 2 : 0; }

}  // namespace

FittedView fit_perspective(exec::Cpu& ex, const FitPoints& points, const ViewSpace& space, const HalfExtent& half,
                           bool centred) {
  const Reaches reach = reaches(ex, points, space, half);
  FittedView view;
  view.distance = 1;
  if (!(reach.nearest > -kInfinity)) return view;  // no points
  view.distance = std::max(
      {half_of(reach.x, centred) / half.x, half_of(reach.y, centred) / half.y, reach.nearest + kLeastDistance});
  view.x = middle_of(reach.x, centred);
  view.y = middle_of(reach.y, centred);
  if (centred) centre(ex, points, space, view);
  return view;
}

FittedView fit_orthographic(exec::Cpu& ex, const FitPoints& points, const ViewSpace& space, const HalfExtent& half,
                            bool centred) {
  const Reaches reach = reaches(ex, points, space, {0, 0});
  FittedView view;
  view.per_radius = std::min(half.x, half.y);
  if (!(reach.nearest > -kInfinity)) return view;
  const double x = half_of(reach.x, centred);
  const double y = half_of(reach.y, centred);
  if (x > 0 || y > 0) view.per_radius = std::min(half.x / std::max(x, 1e-12), half.y / std::max(y, 1e-12));
  view.x = middle_of(reach.x, centred);
  view.y = middle_of(reach.y, centred);
  return view;
}

}  // namespace pointskin::render_detail
