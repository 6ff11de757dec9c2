#include "deform/prepare_deformation.hpp"

#include <algorithm>
#include <cmath>

namespace pointskin::deform {
namespace {

using Rows = std::array<double, 9>;

double determinant(const Rows& m) {
  return m[0] * (m[4] * m[8] - m[5] * m[7]) - m[1] * (m[3] * m[8] - m[5] * m[6]) + m[2] * (m[3] * m[7] - m[4] * m[6]);
}

/// Inverse, transposed.
Rows inverse_transposed(const Rows& m) {
  const double scale = 1 / determinant(m);
  return {
      (m[4] * m[8] - m[5] * m[7]) * scale, (m[5] * m[6] - m[3] * m[8]) * scale, (m[3] * m[7] - m[4] * m[6]) * scale,
      (m[2] * m[7] - m[1] * m[8]) * scale, (m[0] * m[8] - m[2] * m[6]) * scale, (m[1] * m[6] - m[0] * m[7]) * scale,
      (m[1] * m[5] - m[2] * m[4]) * scale, (m[2] * m[3] - m[0] * m[5]) * scale, (m[0] * m[4] - m[1] * m[3]) * scale};
}

/// Axis times angle of a rotation matrix, by way of its quaternion: exact near 0 and near half a turn.
Vec3d rotation_vector(const Rows& r) {
  // Four times the products of the quaternion's parts with its largest one. Shepperd, "Quaternion from rotation
  // matrix", J. Guidance and Control 1, 1978.
  const std::array<double, 4> squares = {1 + r[0] + r[4] + r[8], 1 + r[0] - r[4] - r[8], 1 - r[0] + r[4] - r[8],
                                         1 - r[0] - r[4] + r[8]};
  std::array<double, 4> q{};
  switch (std::max_element(squares.begin(), squares.end()) - squares.begin()) {
    case 0:
      q = {squares[0], r[7] - r[5], r[2] - r[6], r[3] - r[1]};
      break;
    case 1:
      q = {r[7] - r[5], squares[1], r[1] + r[3], r[2] + r[6]};
      break;
    case 2:
      q = {r[2] - r[6], r[1] + r[3], squares[2], r[5] + r[7]};
      break;
    default:
      q = {r[3] - r[1], r[2] + r[6], r[5] + r[7], squares[3]};
      break;
  }
  if (q[0] < 0)
    for (double& part : q) part = -part;
  const double length = std::hypot(q[1], q[2], q[3]);
  if (length == 0) return {};
  const double scale = 2 * std::atan2(length, q[0]) / length;
  return {q[1] * scale, q[2] * scale, q[3] * scale};
}

HandleData transform_data(const RigidMotion& motion, const Vec3d& origin) {
  HandleData data;
  const double length = std::hypot(motion.axis[0], motion.axis[1], motion.axis[2]);
  if (motion.angle != 0) data.rotation = motion.axis * (motion.angle / length);
  data.translation = motion.translation;
  data.pivot = motion.point - origin;
  data.pivot_weight = std::abs(motion.angle);
  return data;
}

HandleData transform_data(const AffineMap& map, const Vec3d& origin) {
  HandleData data;
  const auto& m = map.matrix;
  const PolarParts parts = polar_parts({m[0], m[1], m[2], m[4], m[5], m[6], m[8], m[9], m[10]});
  data.rotation = parts.rotation;
  data.stretch = parts.stretch;
  const Vec3d& c = map.pivot;
  const auto moved = [&](std::size_t row) {  // the pivot's image less the pivot, exact where the map is the identity
    const double* at = m.data() + 4 * row;
    Vec3d change{at[0], at[1], at[2]};
    change[row] -= 1;
    return change[0] * c[0] + change[1] * c[1] + change[2] * c[2] + at[3];
  };
  data.translation = {moved(0), moved(1), moved(2)};
  data.pivot = c - origin;
  const Symmetric3& e = data.stretch;
  data.pivot_weight =
      std::sqrt(dot(data.rotation, data.rotation)) +
      std::sqrt(e.xx * e.xx + e.yy * e.yy + e.zz * e.zz + 2 * (e.yz * e.yz + e.xz * e.xz + e.xy * e.xy));
  return data;
}

/// Fills in a region.
struct FillRegion {
  HandleData& data;
  Vec3d origin;
  std::vector<std::vector<std::int64_t>>& point_sets;

  void operator()(const HalfSpace& region) const {
    data.shape = RegionShape::half_space;
    data.a = region.point - origin;
    data.b = region.normal * (1 / std::hypot(region.normal[0], region.normal[1], region.normal[2]));
  }
  void operator()(const Ball& region) const {
    data.shape = RegionShape::ball;
    data.a = region.centre - origin;
    data.radius = region.radius;
  }
  void operator()(const AxisBox& region) const {
    data.shape = RegionShape::box;
    data.a = region.lower - origin;
    data.b = region.upper - origin;
  }
  void operator()(const Capsule& region) const {
    data.shape = RegionShape::capsule;
    data.a = region.from - origin;
    data.b = region.to - origin;
    data.radius = region.radius;
  }
  void operator()(const PointSet& region) const {
    data.shape = RegionShape::points;
    const auto known = std::find(point_sets.begin(), point_sets.end(), region.points);
    data.nearest_row = static_cast<std::int32_t>(known - point_sets.begin());
    if (known == point_sets.end()) point_sets.push_back(region.points);
  }
};

bool moves_nothing(const HandleData& data) {
  const Vec3d& t = data.translation;
  return data.pivot_weight == 0 && t.x == 0 && t.y == 0 && t.z == 0;
}

LatticeData lattice_data(const Lattice& lattice, const Vec3d& origin) {
  LatticeData data;
  data.origin = lattice.origin - origin;
  const std::array<Vec3d, 3>& axes = lattice.axes;
  const double scale = 1 / dot(axes[0], cross(axes[1], axes[2]));
  for (std::size_t a = 0; a < 3; ++a) {
    data.inverse[a] = cross(axes[(a + 1) % 3], axes[(a + 2) % 3]) * scale;
    data.spans[a] = lattice.spans[a];
  }
  data.stay_outside = lattice.outside == Lattice::Outside::stay ? 1 : 0;
  return data;
}

}  // namespace

PolarParts polar_parts(const std::array<double, 9>& matrix) {
  constexpr int kMostSteps = 100;
  Rows r = matrix;
  for (int step = 0; step < kMostSteps; ++step) {
    const Rows other = inverse_transposed(r);
    double change = 0;
    double size = 0;
    for (std::size_t i = 0; i < 9; ++i) {
      const double next = 0.5 * (r[i] + other[i]);
      change += std::abs(next - r[i]);
      size += std::abs(next);
      r[i] = next;
    }
    if (change <= 1e-15 * size) break;
  }
  PolarParts parts;
  parts.rotation = rotation_vector(r);
  const auto product = [&](std::size_t i, std::size_t j) {  // of the rotation's transpose and the matrix
    return r[i] * matrix[j] + r[3 + i] * matrix[3 + j] + r[6 + i] * matrix[6 + j];
  };
  const auto mean = [&](std::size_t i, std::size_t j) { return 0.5 * (product(i, j) + product(j, i)); };
  parts.stretch = {product(0, 0) - 1, product(1, 1) - 1, product(2, 2) - 1, mean(1, 2), mean(0, 2), mean(0, 1)};
  return parts;
}

PreparedDeformation prepare(const Deformation& deformation, const Vec3d& origin) {
  PreparedDeformation out;
  for (const Handle& handle : deformation.handles) {
    HandleData data = std::visit([&](const auto& t) { return transform_data(t, origin); }, handle.transform);
    std::visit(FillRegion{data, origin, out.point_sets}, handle.region);
    out.identity = out.identity && moves_nothing(data);
    out.handles.push_back(data);
  }
  for (const Lattice& lattice : deformation.lattices) {
    LatticeData data = lattice_data(lattice, origin);
    data.first_move = static_cast<std::int64_t>(out.moves.size());
    for (int i = 0; i <= lattice.spans[0]; ++i)
      for (int j = 0; j <= lattice.spans[1]; ++j)
        for (int k = 0; k <= lattice.spans[2]; ++k) {
          const Vec3d move = lattice.control[lattice.index(i, j, k)] - lattice.rest_point(i, j, k);
          out.identity = out.identity && move.x == 0 && move.y == 0 && move.z == 0;
          out.moves.push_back(move);
        }
    out.lattices.push_back(data);
  }
  if (out.identity) out = {};
  return out;
}

}  // namespace pointskin::deform
