#include "deform/resample.hpp"

#include <pointskin/error.hpp>

#include <cmath>
#include <limits>

#include "exec/this_space.hpp"

namespace pointskin::deform {
namespace {

constexpr std::int64_t kOne = std::int64_t{1} << 16;  // a sample in fixed point

/// Writes each sample's area stretch |cof(J) n| / |n|, in fixed point.
struct Stretch {
  MapView map;
  RestSamples samples;
  ArrayView<std::int64_t> out;

  PSK_HD static std::int64_t fixed(double stretch) {
    if (!(stretch > 0)) return 0;
    if (stretch >= 1 / kTolerated && stretch <= kTolerated) return kOne;
    return static_cast<std::int64_t>((stretch < kMostCopies ? stretch : kMostCopies) * kOne + 0.5);
  }
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3d n = to_double(samples.normals[i]);
    const double squared = dot(n, n);
    const Vec3d area = cofactor_times(map(to_double(samples.positions[i]), i).jacobian, n);
    out[i] = squared > 0 ? fixed(std::sqrt(dot(area, area) / squared)) : kOne;
  }
};

/// Where each sample's copies are among all.
struct Copies {
  ArrayView<const std::int64_t> sums;  ///< (n + 1) of what Stretch has written
  PSK_HD std::int64_t before(std::int64_t i) const { return (sums[i] + kOne / 2) / kOne; }
};

struct IsThinned {
  Copies copies;
  PSK_HD std::int64_t operator()(std::int64_t i) const { return copies.before(i) == copies.before(i + 1) ? 1 : 0; }
};
struct Sum {
  PSK_HD std::int64_t operator()(std::int64_t a, std::int64_t b) const { return a + b; }
};

/// Field values and gradients around the rest surface.
struct Projector {
  RestSurface surface;

  PSK_HD float value(const Vec3f& p) const {
    return octree::value_at(surface.field.tree, surface.field.values, p, surface.field.tree.depth);
  }
  /// By central differences over a finest cell, per unit.
  PSK_HD Vec3f gradient(const Vec3f& p) const {
    const float half = 0.5F / static_cast<float>(1 << surface.field.tree.depth);
    const float scale = 0.5F / half;
    return {(value({p.x + half, p.y, p.z}) - value({p.x - half, p.y, p.z})) * scale,
            (value({p.x, p.y + half, p.z}) - value({p.x, p.y - half, p.z})) * scale,
            (value({p.x, p.y, p.z + half}) - value({p.x, p.y, p.z - half})) * scale};
  }
  /// Two Newton steps along the gradient. @returns false, `p` unspecified, if one is longer than `reach`
  PSK_HD bool project(Vec3f& p, float reach, Vec3f& gradient_there) const {
    for (int step = 0; step < 2; ++step) {
      const Vec3f g = gradient(p);
      const float squared = squared_length(g);
      const float off = surface.field.isovalue - value(p);
      if (!(off * off <= reach * reach * squared) || !(squared > 0)) return false;
      const float t = off / squared;
      p = {p.x + g.x * t, p.y + g.y * t, p.z + g.z * t};
      gradient_there = g;
    }
    return true;
  }
};

/// An orthonormal basis of a tangent plane. Source: Duff et al., "Building an orthonormal basis, revisited", JCGT 2017.
struct TangentPlane {
  Vec3d u, v;
  PSK_HD explicit TangentPlane(const Vec3d& n) {
    const double sign = n.z >= 0 ? 1 : -1;
    const double a = -1 / (sign + n.z);
    const double b = n.x * n.y * a;
    u = {1 + sign * n.x * n.x * a, sign * b, -sign * n.x};
    v = {b, sign + n.y * n.y * a, -n.y};
  }
  /// Turns the basis so that `jacobian` stretches u most and v least.
  PSK_HD void turn_to_principal(const Matrix3& jacobian) {
    const Vec3d a = jacobian * u;
    const Vec3d b = jacobian * v;
    const double half = (dot(a, a) - dot(b, b)) / 2;
    const double mixed = dot(a, b);
    const double root = std::sqrt(half * half + mixed * mixed);
    const double c = half >= 0 ? root + half : mixed;
    const double s = half >= 0 ? mixed : root - half;
    const double length = std::sqrt(c * c + s * s);
    if (!(length > 0)) return;
    const Vec3d first = u * (c / length) + v * (s / length);
    v = v * (c / length) - u * (s / length);
    u = first;
  }
};

/// Writes the copies of each sample.
struct Place {
  MapView map;
  RestSamples samples;
  Projector projector;
  Copies copies;
  ArrayView<Vec3f> positions, normals;
  ArrayView<std::int32_t> parents;

  PSK_HD void operator()(std::int64_t i) const {
    const std::int64_t first = copies.before(i);
    const auto count = static_cast<int>(copies.before(i + 1) - first);
    if (count == 0) return;
    if (count == 1) return write(first, i, samples.positions[i], samples.normals[i]);
    const Vec3d x = to_double(samples.positions[i]);
    const Vec3d n = to_double(samples.normals[i]);
    TangentPlane plane(n * (1 / std::sqrt(dot(n, n))));
    plane.turn_to_principal(map(x, i).jacobian);
    const auto side = static_cast<double>(samples.spacings[i]);
    for (int j = 0; j < count; ++j) {
      // The golden ratio spreads any number evenly across; symmetric about the sample, whichever way the axes point.
      const double steps = j - 0.5 * (count - 1);
      const double turns = steps * 0.6180339887498949 + 64.5;
      const double across = turns - static_cast<double>(static_cast<std::int64_t>(turns)) - 0.5;
      const Vec3d offset = plane.u * (steps / count * side) + plane.v * (across * side);
      Vec3f position = to_float(x + offset);
      Vec3f normal = samples.normals[i];
      if (steps != 0) settle(position, normal, side);
      write(first + j, i, position, normal);
    }
  }

 private:
  PSK_HD void write(std::int64_t to, std::int64_t parent, const Vec3f& position, const Vec3f& normal) const {
    positions[to] = position;
    normals[to] = normal;
    parents[to] = static_cast<std::int32_t>(parent);
  }

  /// Moves a point of the tangent plane onto the surface, if it is near and faces about the same way.
  PSK_HD void settle(Vec3f& position, Vec3f& normal, double side) const {
    const octree::Frame& frame = projector.surface.frame;
    Vec3f unit = frame.to_unit(position);
    Vec3f gradient;
    if (!projector.project(unit, static_cast<float>(0.5 * side / frame.size), gradient)) return;
    const Vec3d outward = to_double(gradient) * -1;
    const Vec3d n = to_double(normal);
    const double lengths = std::sqrt(dot(n, n) * dot(outward, outward));
    if (!(dot(n, outward) > 0.5 * lengths)) return;
    position = frame.to_world(unit);
    normal = to_float(outward * (dot(n, n) / lengths));
  }
};

struct MapSample {
  MapView map;
  ArrayView<Vec3f> positions, normals;

  PSK_HD void operator()(std::int64_t i) const {
    const Mapped mapped = map(to_double(positions[i]), i);
    const Vec3d n = to_double(normals[i]);
    Vec3d area = cofactor_times(mapped.jacobian, n);
    if (dot(mapped.jacobian.x, cross(mapped.jacobian.y, mapped.jacobian.z)) < 0) area = area * -1;
    const double squared = dot(area, area);
    positions[i] = to_float(mapped.position);
    normals[i] = squared > 0 ? to_float(area * std::sqrt(dot(n, n) / squared)) : Vec3f{};
  }
};

}  // namespace

template <exec::Space Exec>
Resampled resample(Exec& ex, const MapView& map, const RestSamples& samples, const RestSurface& surface) {
  const std::int64_t n = samples.positions.size;
  auto stretches = exec::make_buffer<std::int64_t>(ex, n);
  for_each(ex, "deform.stretch", n, Stretch{map, samples, stretches.view()});
  auto sums = exec::make_buffer<std::int64_t>(ex, n + 1);
  exclusive_scan(ex, "deform.stretch", stretches.cview(), sums.view());
  stretches.reset();
  const Copies copies{sums.cview()};
  Resampled out;
  out.thinned = exec::reduce<std::int64_t>(ex, "deform.stretch", n, IsThinned{copies}, Sum{});
  const std::int64_t total = (exec::read_element(ex, sums.cview(), n) + kOne / 2) / kOne;
  if (total > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit, "the deformed cloud would have more than 2^31 - 1 points; stretch it less");
  if (total == 0)
    throw Error(ErrorCode::empty_result, "the deformation leaves no points; it squeezes the surface to nothing");
  out.inserted = total - (n - out.thinned);
  out.positions = exec::make_buffer<Vec3f>(ex, total);
  out.normals = exec::make_buffer<Vec3f>(ex, total);
  out.parents = exec::make_buffer<std::int32_t>(ex, total);
  for_each(ex, "deform.place", n,
           Place{map, samples, {surface}, copies, out.positions.view(), out.normals.view(), out.parents.view()});
  return out;
}

template <exec::Space Exec>
void map_samples(Exec& ex, const MapView& map, ArrayView<Vec3f> positions, ArrayView<Vec3f> normals) {
  for_each(ex, "deform.map", positions.size, MapSample{map, positions, normals});
}

PSK_INSTANTIATE(resample);
PSK_INSTANTIATE(map_samples);

}  // namespace pointskin::deform
