// Where a deformation moves a point, and its Jacobian there.
// Sources: Pauly, Keiser, Kobbelt & Gross, "Shape modeling with point-sampled geometry", SIGGRAPH 2003, section 5
// (fall-off between a zero-region and a one-region); Alexa, "Linear combination of transformations", SIGGRAPH 2002 (the
// mean of rotation vectors); Sederberg & Parry, "Free-form deformation of solid geometric models", SIGGRAPH 1986.
// Differs: any number of handles; outside of a lattice's block the Bernstein polynomials go on along their tangents.
#pragma once

#include <cmath>
#include <cstdint>

#include "core/array_view.hpp"
#include "core/matrix3.hpp"
#include "deform/rotation.hpp"

namespace pointskin::deform {

inline constexpr int kMostHandles = 16;
inline constexpr int kMostLattices = 8;
inline constexpr int kMostSpans = 15;

enum class RegionShape : std::int32_t { half_space, ball, box, capsule, points };

/// A handle as kernels read it. Places are relative to the cloud's origin.
struct HandleData {
  RegionShape shape = RegionShape::half_space;
  std::int32_t nearest_row = -1;  ///< of MapView::nearest, for points
  Vec3d a;                        ///< point of the plane, centre, lower corner, an end
  Vec3d b;                        ///< unit normal into the half-space, upper corner, the other end
  double radius = 0;
  Vec3d rotation;      ///< axis times angle
  Symmetric3 stretch;  ///< S - I
  Vec3d translation, pivot;
  double pivot_weight = 0;  ///< how much its pivot matters: angle and size of the stretch
};

/// A lattice as kernels read it.
struct LatticeData {
  Vec3d origin;
  Vec3d inverse[3];  ///< rows: s_a = inverse[a] . (x - origin)
  std::int32_t spans[3] = {1, 1, 1};
  std::int32_t stay_outside = 0;
  std::int64_t first_move = 0;  ///< of its control points in MapView::moves
};

/// Distance to a region and where it grows.
struct RegionDistance {
  double distance = 0;  ///< >= 0
  Vec3d gradient;       ///< unit length; 0 inside
};

PSK_HD inline double clamp(double v, double lower, double upper) { return v < lower ? lower : v > upper ? upper : v; }

PSK_HD inline RegionDistance distance_beyond(const Vec3d& x, const Vec3d& core, double radius) {
  const Vec3d away = x - core;
  const double length = std::sqrt(dot(away, away));
  if (!(length > radius)) return {};
  return {length - radius, away * (1 / length)};
}

/// @param nearest  for points: the nearest of them
PSK_HD inline RegionDistance distance_to(const HandleData& handle, const Vec3d& x, const Vec3d& nearest) {
  switch (handle.shape) {
    case RegionShape::half_space: {
      const double inside = dot(x - handle.a, handle.b);
      if (inside >= 0) return {};
      return {-inside, handle.b * -1};
    }
    case RegionShape::ball:
      return distance_beyond(x, handle.a, handle.radius);
    case RegionShape::box:
      return distance_beyond(
          x,
          {clamp(x.x, handle.a.x, handle.b.x), clamp(x.y, handle.a.y, handle.b.y), clamp(x.z, handle.a.z, handle.b.z)},
          0);
    case RegionShape::capsule: {
      const Vec3d along = handle.b - handle.a;
      const double squared = dot(along, along);
      const double t = squared > 0 ? clamp(dot(x - handle.a, along) / squared, 0, 1) : 0;
      return distance_beyond(x, handle.a + along * t, handle.radius);
    }
    case RegionShape::points:
      return distance_beyond(x, nearest, 0);
  }
  return {};
}

/// A point's image and the derivative there.
struct Mapped {
  Vec3d position;
  Matrix3 jacobian;
};

/// Weights of the handles at a point, with their gradients.
struct HandleWeights {
  double weight[kMostHandles];
  Vec3d gradient[kMostHandles];
};

/// t^2 (3 - 2 t) and its slope.
PSK_HD inline double blend(double t) { return t * t * (3 - 2 * t); }
PSK_HD inline double blend_slope(double t) { return 6 * t * (1 - t); }

/// Fills the weights from distances d_k and gradients g_k: t_k = (1/d_k) / sum (1/d_j), w_k = b(t_k) / sum b(t_j).
/// grad t_k = t_k (sum_j t_j g_j / d_j - g_k / d_k). In a region all slopes are 0.
/// @returns false if the point is in a region: the weights do not change there
PSK_HD inline bool weigh_handles(int count, const RegionDistance* distances, HandleWeights& out) {
  double nearest = distances[0].distance;
  for (int k = 1; k < count; ++k) nearest = distances[k].distance < nearest ? distances[k].distance : nearest;
  if (nearest == 0) {
    int inside = 0;
    for (int k = 0; k < count; ++k) inside += distances[k].distance == 0 ? 1 : 0;
    for (int k = 0; k < count; ++k) {
      out.weight[k] = distances[k].distance == 0 ? 1.0 / inside : 0.0;
      out.gradient[k] = {};
    }
    return false;
  }
  double shares = 0;
  for (int k = 0; k < count; ++k) shares += nearest / distances[k].distance;
  double blends = 0;
  Vec3d mean;
  for (int k = 0; k < count; ++k) {
    const double t = nearest / distances[k].distance / shares;
    out.weight[k] = t;
    mean = mean + distances[k].gradient * (t / distances[k].distance);
    blends += blend(t);
  }
  Vec3d slopes;
  for (int k = 0; k < count; ++k) {
    const double t = out.weight[k];
    out.gradient[k] = (mean - distances[k].gradient * (1 / distances[k].distance)) * (t * blend_slope(t));
    slopes = slopes + out.gradient[k];
  }
  for (int k = 0; k < count; ++k) {
    out.weight[k] = blend(out.weight[k]) / blends;
    out.gradient[k] = (out.gradient[k] - slopes * out.weight[k]) * (1 / blends);
  }
  return true;
}

/// The mean transform of weighted handles: x = c + v goes to x + (R (I + E) - I) v + d.
struct MeanTransform {
  Vec3d rotation, translation, pivot;
  Symmetric3 stretch;
  double pivots = 0;  ///< sum of weights times pivot weights
};
PSK_HD inline MeanTransform mean_transform(ArrayView<const HandleData> handles, const HandleWeights& weights) {
  MeanTransform mean;
  for (std::int64_t k = 0; k < handles.size; ++k) {
    const HandleData& handle = handles[k];
    const double w = weights.weight[k];
    mean.rotation = mean.rotation + handle.rotation * w;
    mean.translation = mean.translation + handle.translation * w;
    mean.stretch = mean.stretch + handle.stretch * w;
    mean.pivot = mean.pivot + handle.pivot * (w * handle.pivot_weight);
    mean.pivots += w * handle.pivot_weight;
  }
  if (mean.pivots > 0) mean.pivot = mean.pivot * (1 / mean.pivots);
  return mean;
}

/// Bernstein polynomials of one degree at a parameter and their slopes; beyond [0, 1] their tangents at the ends.
struct Bernstein {
  double value[kMostSpans + 1];
  double slope[kMostSpans + 1];

  PSK_HD Bernstein(int degree, double parameter) {
    const double s = clamp(parameter, 0, 1);
    value[0] = 1;
    for (int d = 1; d < degree; ++d) raise(d, s);  // of one degree less
    for (int i = 0; i <= degree; ++i)
      slope[i] = degree * ((i > 0 ? value[i - 1] : 0.0) - (i < degree ? value[i] : 0.0));
    raise(degree, s);
    const double beyond = parameter - s;
    for (int i = 0; i <= degree; ++i) value[i] += slope[i] * beyond;
  }

 private:
  PSK_HD void raise(int degree, double s) {
    double below = 0;
    for (int i = 0; i < degree; ++i) {
      const double here = value[i];
      value[i] = (1 - s) * here + s * below;
      below = here;
    }
    value[degree] = s * below;
  }
};

/// A deformation as kernels read it.
struct MapView {
  ArrayView<const HandleData> handles;
  ArrayView<const LatticeData> lattices;
  ArrayView<const Vec3d> moves;     ///< of all control points from where they rest
  ArrayView<const Vec3f> nearest;   ///< (rows, points) nearest chosen point, for regions that are point sets
  std::int64_t nearest_stride = 0;  ///< points a row

  /// @param point  index of x in the rows of `nearest`
  PSK_HD Mapped operator()(const Vec3d& x, std::int64_t point) const {
    Mapped mapped{x, {}};
    if (!handles.empty()) by_handles(point, mapped);
    for (std::int64_t l = 0; l < lattices.size; ++l) by_lattice(lattices[l], mapped);
    return mapped;
  }

 private:
  PSK_HD void by_handles(std::int64_t point, Mapped& mapped) const {
    const Vec3d x = mapped.position;
    RegionDistance distances[kMostHandles];
    const auto count = static_cast<int>(handles.size);
    for (int k = 0; k < count; ++k) {
      const std::int32_t row = handles[k].nearest_row;
      distances[k] = distance_to(handles[k], x, row < 0 ? Vec3d{} : to_double(nearest[row * nearest_stride + point]));
    }
    HandleWeights weights;
    const bool weights_change = weigh_handles(count, distances, weights);

    const MeanTransform mean = mean_transform(handles, weights);
    const Rotation rotation(mean.rotation);
    const Vec3d v = x - mean.pivot;
    const Vec3d stretching = mean.stretch * v;
    const Vec3d stretched = v + stretching;
    const Vec3d turning = rotation.moved_by(stretched);
    mapped.position = x + (stretching + turning + mean.translation);

    const auto image_of = [&](const Vec3d& axis) { return rotation * (axis + mean.stretch * axis); };
    Matrix3& jacobian = mapped.jacobian;
    jacobian = {image_of({1, 0, 0}), image_of({0, 1, 0}), image_of({0, 0, 1})};
    if (!weights_change) return;
    const Vec3d rotated = stretched + turning;
    const Matrix3 linear = jacobian;
    for (int k = 0; k < count; ++k) {  // the weights change from place to place
      const HandleData& handle = handles[k];
      Vec3d change =
          handle.translation + rotation * (handle.stretch * v) + rotation.derivative(handle.rotation, rotated);
      if (mean.pivots > 0 && handle.pivot_weight > 0) {
        const Vec3d pivot = (handle.pivot - mean.pivot) * (handle.pivot_weight / mean.pivots);
        change = change + pivot - linear * pivot;
      }
      add_outer(jacobian, change, weights.gradient[k]);
    }
  }

  PSK_HD void by_lattice(const LatticeData& lattice, Mapped& mapped) const {
    const Vec3d from = mapped.position - lattice.origin;
    const double s[3] = {dot(lattice.inverse[0], from), dot(lattice.inverse[1], from), dot(lattice.inverse[2], from)};
    if (lattice.stay_outside != 0)
      for (int a = 0; a < 3; ++a)
        if (!(s[a] >= 0 && s[a] <= 1)) return;
    const Bernstein first(lattice.spans[0], s[0]);
    const Bernstein second(lattice.spans[1], s[1]);
    const Bernstein third(lattice.spans[2], s[2]);
    Vec3d move;
    Vec3d along[3];
    const Vec3d* control = moves.data + lattice.first_move;
    for (int i = 0; i <= lattice.spans[0]; ++i) {
      for (int j = 0; j <= lattice.spans[1]; ++j) {
        Vec3d value;
        Vec3d slope;
        for (int k = 0; k <= lattice.spans[2]; ++k, ++control) {
          value = value + *control * third.value[k];
          slope = slope + *control * third.slope[k];
        }
        move = move + value * (first.value[i] * second.value[j]);
        along[0] = along[0] + value * (first.slope[i] * second.value[j]);
        along[1] = along[1] + value * (first.value[i] * second.slope[j]);
        along[2] = along[2] + slope * (first.value[i] * second.value[j]);
      }
    }
    mapped.position = mapped.position + move;
    Matrix3 jacobian;
    for (int a = 0; a < 3; ++a) add_outer(jacobian, along[a], lattice.inverse[a]);
    mapped.jacobian = jacobian * mapped.jacobian;
  }
};

}  // namespace pointskin::deform
