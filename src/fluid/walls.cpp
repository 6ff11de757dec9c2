#include "fluid/walls.hpp"

#include <pointskin/error.hpp>

#include <cstddef>
#include <limits>
#include <string>
#include <utility>

#include "exec/this_space.hpp"
#include "fluid/surface.hpp"

namespace pointskin::fluid {
namespace {

/// The faces of a box that particles within `reach` see themselves in.
struct Mirrors {
  Vec3f lower, upper;
  float reach;

  /// Calls visit(image, set) for every image of p; bit a of `set`: p is mirrored along axis a.
  template <class Visit>
  PSK_HD void for_each(const Vec3f& p, const Visit& visit) const {
    for (int x = -1; x <= 1; ++x)
      for (int y = -1; y <= 1; ++y)
        for (int z = -1; z <= 1; ++z) {
          if (x == 0 && y == 0 && z == 0) continue;
          if (!sees(p.x, lower.x, upper.x, x) || !sees(p.y, lower.y, upper.y, y) || !sees(p.z, lower.z, upper.z, z))
            continue;
          visit(
              Vec3f{image(p.x, lower.x, upper.x, x), image(p.y, lower.y, upper.y, y), image(p.z, lower.z, upper.z, z)},
              (x != 0 ? 1 : 0) | (y != 0 ? 2 : 0) | (z != 0 ? 4 : 0));
        }
  }

 private:
  [[nodiscard]] PSK_HD bool sees(float v, float low, float high, int side) const {
    return side == 0 || (side < 0 ? v - low < reach : high - v < reach);
  }
  [[nodiscard]] PSK_HD static float image(float v, float low, float high, int side) {
    return side == 0 ? v : side < 0 ? low - (v - low) : high + (high - v);
  }
};

struct Count {
  Mirrors mirrors;
  ArrayView<const Vec3f> positions;
  ArrayView<std::int32_t> counts;
  PSK_HD void operator()(std::int64_t i) const {
    std::int32_t count = 0;
    mirrors.for_each(positions[i], [&](const Vec3f&, int) { ++count; });
    counts[i] = count;
  }
};

struct PlaceAll {
  Mirrors mirrors;
  ArrayView<const Vec3f> positions;
  ArrayView<const std::int32_t> first;
  ArrayView<Vec3f> out;
  PSK_HD void operator()(std::int64_t i) const {
    out[i] = positions[i];
    std::int64_t at = positions.size + first[i];
    mirrors.for_each(positions[i], [&](const Vec3f& image, int) { out[at++] = image; });
  }
};

struct CopyValues {
  Mirrors mirrors;
  ArrayView<const Vec3f> positions;
  ArrayView<const std::int32_t> first;
  TypedView values;
  int turned_by;  // bit of the axis; 0: a scalar
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const {
    const float value = values.value<float>(i);
    out[i] = value;
    std::int64_t at = positions.size + first[i];
    mirrors.for_each(positions[i], [&](const Vec3f&, int set) { out[at++] = (set & turned_by) != 0 ? -value : value; });
  }
};

}  // namespace

template <exec::Space Exec>
MirroredParticles add_images(Exec& ex, const Particles& particles, float reach) {
  constexpr const char* kLabel = "particles.images";
  const std::int64_t n = particles.positions.size;
  const Mirrors mirrors{particles.walls->lower, particles.walls->upper, reach};
  auto counts = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, kLabel, n, Count{mirrors, particles.positions, counts.view()});
  const std::int64_t total = n + exec::sum_counts(ex, kLabel, counts.cview());
  if (total > std::numeric_limits<std::int32_t>::max())
    throw Error(ErrorCode::over_limit,
                "there are " + std::to_string(total) + " particles and images of them in walls, more than 2^31 - 1");
  auto first = exec::make_buffer<std::int32_t>(ex, n + 1);
  exclusive_scan(ex, kLabel, counts.cview(), first.view());
  MirroredParticles out;
  out.positions = exec::make_buffer<Vec3f>(ex, total);
  for_each(ex, kLabel, n, PlaceAll{mirrors, particles.positions, first.cview(), out.positions.view()});
  for (const ParticleValues& from : particles.values) {
    auto values = exec::make_buffer<float>(ex, total);
    for_each(ex, kLabel, n,
             CopyValues{mirrors, particles.positions, first.cview(), from.values, from.axis < 0 ? 0 : 1 << from.axis,
                        values.view()});
    out.values.push_back(std::move(values));
  }
  return out;
}

PSK_INSTANTIATE(add_images);

}  // namespace pointskin::fluid
