// The plain data of include/pointskin/deform.hpp: checked and scaled.
#include <pointskin/deform.hpp>
#include <pointskin/error.hpp>

#include <algorithm>
#include <array>
#include <cmath>

#include "core/format.hpp"
#include "deform/prepare_deformation.hpp"

namespace pointskin {
namespace {

/// Complains about one part of a deformation.
class Checker {
 public:
  explicit Checker(std::string part) : part_(std::move(part)) {}

  void require(bool holds, const char* what) const {
    if (!holds) throw Error(ErrorCode::usage, part_ + ": " + what);
  }
  /// Numbers that leave room to compute with.
  template <class Numbers>
  void finite(const Numbers& numbers, const char* name) const {
    constexpr double kLargest = 1e12;
    const bool good =
        std::all_of(numbers.begin(), numbers.end(), [](double v) { return v >= -kLargest && v <= kLargest; });
    if (!good) throw Error(ErrorCode::usage, fmt::format("{}: {} must be finite, at most 1e12", part_, name));
  }
  void finite(const Vec3d& v, const char* name) const { finite(std::array{v.x, v.y, v.z}, name); }

 private:
  std::string part_;
};

double length_of(const Vec3d& v) { return std::hypot(v[0], v[1], v[2]); }

/// Determinant of three vectors over the product of their lengths.
double independence(const Vec3d& a, const Vec3d& b, const Vec3d& c) {
  const double volume = dot(a, cross(b, c));
  const double lengths = length_of(a) * length_of(b) * length_of(c);
  return lengths > 0 ? volume / lengths : 0;
}
constexpr double kLeastIndependence = 1e-9;

struct CheckRegion {
  const Checker& check;
  std::int64_t points;

  void operator()(const HalfSpace& region) const {
    check.finite(region.point, "the point");
    check.finite(region.normal, "the normal");
    check.require(length_of(region.normal) > 0, "the normal must not be zero");
  }
  void operator()(const Ball& region) const {
    check.finite(region.centre, "the centre");
    radius(region.radius);
  }
  void operator()(const AxisBox& region) const {
    check.finite(region.lower, "the lower corner");
    check.finite(region.upper, "the upper corner");
    for (std::size_t a = 0; a < 3; ++a)
      check.require(region.lower[a] <= region.upper[a], "the lower corner must not be above the upper one");
  }
  void operator()(const Capsule& region) const {
    check.finite(region.from, "the first end");
    check.finite(region.to, "the second end");
    radius(region.radius);
  }
  void operator()(const PointSet& region) const {
    check.require(!region.points.empty(), "the list of points must not be empty");
    for (const std::int64_t point : region.points)
      check.require(point >= 0 && point < points, "a point of the list is not in the cloud");
  }

 private:
  void radius(double value) const {
    check.finite(std::array<double, 1>{value}, "the radius");
    check.require(value >= 0, "the radius must not be negative");
  }
};

struct CheckTransform {
  const Checker& check;

  void operator()(const RigidMotion& motion) const {
    check.finite(motion.axis, "the axis");
    check.finite(motion.point, "the point");
    check.finite(motion.translation, "the translation");
    check.require(std::abs(motion.angle) <= 1000, "the angle must be at most 1000 radians");
    check.require(motion.angle == 0 || length_of(motion.axis) > 0, "the axis must not be zero");
  }
  void operator()(const AffineMap& map) const {
    check.finite(map.matrix, "the matrix");
    check.finite(map.pivot, "the pivot");
    const auto& m = map.matrix;
    check.require(independence({m[0], m[1], m[2]}, {m[4], m[5], m[6]}, {m[8], m[9], m[10]}) > kLeastIndependence,
                  "the matrix must not mirror or flatten: its determinant must be positive");
  }
};

void check_lattice(const Lattice& lattice, const Checker& check) {
  check.finite(lattice.origin, "the origin");
  for (const Vec3d& axis : lattice.axes) check.finite(axis, "the axes");
  check.require(std::abs(independence(lattice.axes[0], lattice.axes[1], lattice.axes[2])) > kLeastIndependence,
                "the axes must not lie in a plane");
  std::size_t count = 1;
  for (const int span : lattice.spans) {
    check.require(span >= 1 && span <= deform::kMostSpans, "spans must be in 1..15");
    count *= static_cast<std::size_t>(span) + 1;
  }
  check.require(lattice.control.size() == count, "there must be (l+1)(m+1)(n+1) control points");
  for (const Vec3d& point : lattice.control) check.finite(point, "the control points");
}

/// The transform of a share of the way.
struct ScaleTransform {
  double share;

  HandleTransform operator()(RigidMotion motion) const {
    motion.angle *= share;
    motion.translation = motion.translation * share;
    return motion;
  }
  HandleTransform operator()(AffineMap map) const {
    Handle handle{{}, map};
    const deform::PreparedDeformation parts = deform::prepare({{handle}, {}}, map.pivot);
    if (parts.identity) return map;
    const deform::HandleData& data = parts.handles.front();
    const deform::Rotation rotation(data.rotation * share);
    const auto image = [&](const Vec3d& axis) { return rotation * (axis + data.stretch * axis * share); };
    const Matrix3 linear{image({1, 0, 0}), image({0, 1, 0}), image({0, 0, 1})};
    const Vec3d& pivot = map.pivot;
    const Vec3d shift = data.translation * share + pivot - linear * pivot;
    map.matrix = {linear.x.x, linear.y.x, linear.z.x, shift.x,    linear.x.y, linear.y.y,
                  linear.z.y, shift.y,    linear.x.z, linear.y.z, linear.z.z, shift.z};
    return map;
  }
};

}  // namespace

Vec3d Lattice::rest_point(int i, int j, int k) const {
  const double s = static_cast<double>(i) / spans[0];
  const double t = static_cast<double>(j) / spans[1];
  const double u = static_cast<double>(k) / spans[2];
  Vec3d point = origin;
  for (std::size_t a = 0; a < 3; ++a) point[a] += s * axes[0][a] + t * axes[1][a] + u * axes[2][a];
  return point;
}

std::size_t Lattice::index(int i, int j, int k) const {
  return static_cast<std::size_t>((i * (spans[1] + 1) + j) * (spans[2] + 1) + k);
}

void Lattice::reset() {
  control.clear();
  for (int i = 0; i <= spans[0]; ++i)
    for (int j = 0; j <= spans[1]; ++j)
      for (int k = 0; k <= spans[2]; ++k) control.push_back(rest_point(i, j, k));
}

void validate(const Deformation& deformation, std::int64_t points) {
  if (deformation.handles.size() > static_cast<std::size_t>(deform::kMostHandles))
    throw Error(ErrorCode::usage, fmt::format("a deformation has at most {} handles", deform::kMostHandles));
  if (deformation.lattices.size() > static_cast<std::size_t>(deform::kMostLattices))
    throw Error(ErrorCode::usage, fmt::format("a deformation has at most {} lattices", deform::kMostLattices));
  for (std::size_t i = 0; i < deformation.handles.size(); ++i) {
    const Checker check(fmt::format("handles[{}]", i));
    std::visit(CheckRegion{check, points}, deformation.handles[i].region);
    std::visit(CheckTransform{check}, deformation.handles[i].transform);
  }
  for (std::size_t i = 0; i < deformation.lattices.size(); ++i)
    check_lattice(deformation.lattices[i], Checker(fmt::format("lattices[{}]", i)));
}

Deformation scaled(const Deformation& deformation, double share) {
  if (!std::isfinite(share)) throw Error(ErrorCode::usage, "the share of a deformation must be finite");
  Deformation out = deformation;
  if (share == 1) return out;
  for (std::size_t i = 0; i < out.handles.size(); ++i) {
    HandleTransform& transform = out.handles[i].transform;
    const Checker check(fmt::format("handles[{}]", i));
    std::visit(CheckTransform{check}, transform);
    transform = std::visit(ScaleTransform{share}, transform);
  }
  for (std::size_t l = 0; l < out.lattices.size(); ++l) {
    Lattice& lattice = out.lattices[l];
    check_lattice(lattice, Checker(fmt::format("lattices[{}]", l)));
    for (int i = 0; i <= lattice.spans[0]; ++i)
      for (int j = 0; j <= lattice.spans[1]; ++j)
        for (int k = 0; k <= lattice.spans[2]; ++k) {
          const Vec3d rest = lattice.rest_point(i, j, k);
          Vec3d& point = lattice.control[lattice.index(i, j, k)];
          for (std::size_t a = 0; a < 3; ++a) point[a] = rest[a] + share * (point[a] - rest[a]);
        }
  }
  return out;
}

}  // namespace pointskin
