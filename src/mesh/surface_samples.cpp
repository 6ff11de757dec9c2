// Sources: Osada et al., "Shape distributions", ACM TOG 21, 2002 (uniform points on a triangle through a square root);
// Roberts, "The unreasonable effectiveness of quasirandom sequences", 2018 (the R2 sequence);
// Steele, Lea & Flood, "Fast splittable pseudorandom number generators", OOPSLA 2014 (splitmix64).
#include "mesh/surface_samples.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "mesh/triangle_tree.hpp"

namespace pointskin::mesh_detail {
namespace {

/// A uniform number in [0, 1) that depends on `counter` alone.
double hashed(std::uint64_t counter) {
  std::uint64_t x = (counter + 1) * 0x9e3779b97f4a7c15ULL;
  x = (x ^ (x >> 30)) * 0xbf58476d1ce4e5b9ULL;
  x = (x ^ (x >> 27)) * 0x94d049bb133111ebULL;
  x ^= x >> 31;
  return static_cast<double>(x >> 11) * 0x1p-53;
}

/// Point i of the R2 sequence in the unit square.
std::pair<double, double> quasirandom(std::int64_t i) {
  const double k = static_cast<double>(i) + 1;
  const double u = k * 0.7548776662466927, v = k * 0.5698402909980532;
  return {u - std::floor(u), v - std::floor(v)};
}

}  // namespace

SurfaceSampler::SurfaceSampler(exec::Cpu& ex, const Mesh& mesh, const Vec3d& offset)
    : mesh_(mesh), offset_(offset), area_before_(ex.pool(), static_cast<std::int64_t>(mesh.triangles.size()) + 1) {
  const auto count = static_cast<std::int64_t>(mesh.triangles.size());
  double* const areas = area_before_.data();
  const auto sum_up = [&] {
    exec::exclusive_scan<double>(ex, "samples", area_before_.cview().part(0, count), area_before_.view());
  };
  exec::for_each(ex, "samples", count,
                 [&](std::int64_t t) { areas[t] = length(edged_triangle(mesh, offset, t).area_vector()); });
  sum_up();
  if (areas[count] > 0) return;
  exec::for_each(ex, "samples", count, [&](std::int64_t t) { areas[t] = 1; });
  sum_up();
}

SurfaceSample SurfaceSampler::sample(std::int64_t i, std::int64_t n) const {
  const double* const first = area_before_.data();
  const double* const last = first + area_before_.size() - 1;
  // Rounding must not carry the last sample past the last triangle that has an area.
  const double place = (static_cast<double>(i) + hashed(static_cast<std::uint64_t>(i))) / static_cast<double>(n);
  const double area = std::min(place * *last, std::nextafter(*last, 0.0));
  const auto id = std::upper_bound(first, last, area) - first - 1;

  const EdgedTriangle t = edged_triangle(mesh_, offset_, id);
  const auto [u, v] = quasirandom(i);
  const double root = std::sqrt(u);
  const Vec3d inside = root * (1 - v) * t.ab + root * v * t.ac;
  return {t.a + inside, normalized(t.area_vector())};
}

}  // namespace pointskin::mesh_detail
