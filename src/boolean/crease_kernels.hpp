// Parts of the search for the curve in which two surfaces cross.
#pragma once

#include <cmath>
#include <pointskin/boolean.hpp>
#include <vector>

#include "boolean/set_operation.hpp"
#include "core/array_view.hpp"
#include "field/surface_distance.hpp"

namespace pointskin::boolean {

using field::SurfaceDistance;

/// A point counts as on a surface within this distance, in leaves.
inline constexpr float kOnSurface = 0.02F;

PSK_HD inline Vec3f plus(const Vec3f& a, float t, const Vec3f& b) {
  return {a.x + t * b.x, a.y + t * b.y, a.z + t * b.z};
}

PSK_HD inline float size_of(float v) { return v < 0 ? -v : v; }

PSK_HD inline float in_unit(float v) { return v < 0 ? 0.0F : v > 1 ? 1.0F : v; }

/// True if the surfaces are as good as parallel.
PSK_HD inline bool run_alike(const SurfaceDistance& a, const SurfaceDistance& b) {
  return !(size_of(dot(a.normal, b.normal)) < kCoincidentCosine) || dot(a.normal, a.normal) == 0 ||
         dot(b.normal, b.normal) == 0;
}

/// A cube with the point of the curve that was found from its middle.
struct Found {
  ArrayView<const Vec3f> points, middles;
  ArrayView<const float> widths;
  ArrayView<const SurfaceDistance> to_a, to_b;
  float cell_unit;

  [[nodiscard]] PSK_HD bool on_curve(std::int64_t i) const {
    const float limit = 2 * kOnSurface * widths[i];
    return !run_alike(to_a[i], to_b[i]) && size_of(to_a[i].cells) <= limit && size_of(to_b[i].cells) <= limit;
  }
  [[nodiscard]] PSK_HD static bool within(float v, float middle, float half) {
    return v >= middle - half && v < middle + half;
  }
  [[nodiscard]] PSK_HD bool operator()(std::int64_t i) const {
    const float half = 0.5F * widths[i] * cell_unit;
    const Vec3f p = points[i];
    const Vec3f m = middles[i];
    return within(p.x, m.x, half) && within(p.y, m.y, half) && within(p.z, m.z, half) && on_curve(i);
  }
};

/// Length of the curve's tangent in its cube, in finest cells.
struct TangentLength {
  Found found;
  PSK_HD double operator()(std::int64_t i) const {
    if (!found.on_curve(i)) return 0;
    const Vec3f u = found.to_a[i].normal;
    const Vec3f v = found.to_b[i].normal;
    const Vec3f t{u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
    const float length = std::sqrt(dot(t, t));
    const Vec3f p = found.points[i];
    const Vec3f m = found.middles[i];
    const float half = 0.5F * found.widths[i];
    float first = -4 * half;
    float last = 4 * half;
    clip((p.x - m.x) / found.cell_unit, t.x / length, half, first, last);
    clip((p.y - m.y) / found.cell_unit, t.y / length, half, first, last);
    clip((p.z - m.z) / found.cell_unit, t.z / length, half, first, last);
    return last > first ? static_cast<double>(last - first) : 0;
  }
  /// Narrows [first, last] to where from + s along is within half of 0.
  PSK_HD static void clip(float from, float along, float half, float& first, float& last) {
    if (along == 0) {
      if (size_of(from) > half) last = first;
      return;
    }
    const float s = (-half - from) / along;
    const float e = (half - from) / along;
    first = first > (s < e ? s : e) ? first : (s < e ? s : e);
    last = last < (s < e ? e : s) ? last : (s < e ? e : s);
  }
};

/// One of the four parts that two crossing surfaces have at their curve.
struct Sheet {
  bool of_first;
  bool outside;  // of the other solid
  bool flipped;  // its normals, by the operation
};

inline std::vector<Sheet> kept_sheets(BooleanOp op) {
  std::vector<Sheet> sheets;
  for (const bool of_first : {true, false})
    for (const bool outside : {true, false}) {
      const Fate fate = fate_of(op, of_first, outside ? Place::outside : Place::inside);
      if (fate != Fate::dropped) sheets.push_back({of_first, outside, fate == Fate::flipped});
    }
  return sheets;
}

}  // namespace pointskin::boolean
