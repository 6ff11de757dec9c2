#include "fluid/vertex_values.hpp"

#include <limits>

#include "exec/this_space.hpp"

namespace pointskin::fluid {
namespace {

constexpr float kNan = std::numeric_limits<float>::quiet_NaN();

/// The particle nearest to x within `reach` of those that count(j), or -1; of several as near the first.
template <class Count>
PSK_HD std::int32_t nearest_within(const ParticlesView& particles, const Vec3f& x, float reach, const Count& count) {
  float nearest = reach * reach;
  std::int32_t found = -1;
  for_each_range_near(particles.tree, x, x, reach, [&](std::int32_t first, std::int32_t last) {
    for (std::int32_t j = first; j < last; ++j) {
      if (!count(j)) continue;
      const Vec3f p = particles.positions[j];
      const float dx = p.x - x.x;
      const float dy = p.y - x.y;
      const float dz = p.z - x.z;
      const float squared = dx * dx + dy * dy + dz * dz;
      if (!(squared < nearest || (squared == nearest && j < found))) continue;
      nearest = squared;
      found = j;
    }
  });
  return found;
}

/// The particle nearest to x, however far: vertices between the corners of large cubes are farther than the radius.
PSK_HD std::int32_t nearest_of_all(const ParticlesView& particles, const Vec3f& x) {
  for (float reach = particles.radius; reach < 4 * particles.tree.cube.size; reach *= 2) {
    const std::int32_t found = nearest_within(particles, x, reach, [](std::int32_t) { return true; });
    if (found >= 0) return found;
  }
  return -1;
}

struct AverageAtVertex {
  ParticlesView particles;
  ArrayView<const Vec3f> vertices;
  VertexMeans means;
  PSK_HD void operator()(std::int64_t v) const {
    const Vec3f x = vertices[v];
    const float inverse = 1 / particles.radius;
    float sum[kValuesAtOnce] = {};
    double wide[kValuesAtOnce] = {};  // the same, which holds several of the largest floats
    float weight[kValuesAtOnce] = {};
    bool alone = true;
    for_each_range_near(particles.tree, x, x, particles.radius, [&](std::int32_t first, std::int32_t last) {
      for (std::int32_t j = first; j < last; ++j) {
        const Vec3f p = particles.positions[j];
        const float dx = (p.x - x.x) * inverse;
        const float dy = (p.y - x.y) * inverse;
        const float dz = (p.z - x.z) * inverse;
        const float q = 1 - (dx * dx + dy * dy + dz * dz);
        if (!(q > 0)) continue;
        alone = false;
        const float k = q * q * q;
        for (int i = 0; i < means.count; ++i) {
          const float value = means.values[i][j];
          if (!(value - value == 0)) continue;
          sum[i] += k * value;
          wide[i] += static_cast<double>(k) * value;
          weight[i] += k;
        }
      }
    });
    const std::int32_t nearest = alone ? nearest_of_all(particles, x) : -1;
    for (int i = 0; i < means.count; ++i) {
      if (nearest >= 0) {
        means.out[i][v] = means.values[i][nearest];
        continue;
      }
      const bool fits = sum[i] - sum[i] == 0;
      const float mean = fits ? sum[i] / weight[i] : static_cast<float>(wide[i] / weight[i]);
      means.out[i][v] = weight[i] > 0 ? mean : kNan;
    }
  }
};

struct NearestAtVertex {
  ParticlesView particles;
  ArrayView<const std::int32_t> order;
  ArrayView<const std::uint8_t> missing;
  ArrayView<const Vec3f> vertices;
  ArrayView<std::int32_t> out;
  PSK_HD void operator()(std::int64_t v) const {
    const Vec3f x = vertices[v];
    const auto has = [&](std::int32_t j) { return missing.empty() || missing[order[j]] == 0; };
    std::int32_t found = nearest_within(particles, x, particles.radius, has);
    if (found < 0) found = nearest_within(particles, x, 2 * particles.radius, has);
    if (found < 0) found = nearest_of_all(particles, x);
    out[v] = found >= 0 && has(found) ? order[found] : -1;
  }
};

struct CrowdingOf {
  ParticlesView particles;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const {
    const Vec3f x = particles.positions[i];
    const float inverse = 1 / particles.radius;
    float sum = 0;
    for_each_neighbour(particles.tree, particles.tree.cell[i], [&](std::int32_t j) {
      const Vec3f p = particles.positions[j];
      const float dx = (p.x - x.x) * inverse;
      const float dy = (p.y - x.y) * inverse;
      const float dz = (p.z - x.z) * inverse;
      const float q = 1 - (dx * dx + dy * dy + dz * dz);
      if (q > 0 && j != i) sum += q;
    });
    out[i] = sum;
  }
};

struct ToWeight {
  float inverse_bulk;
  ArrayView<float> values;
  PSK_HD void operator()(std::int64_t v) const {
    const float share = values[v] * inverse_bulk;
    const float s = share < 1 ? share : 1.0F;
    values[v] = s > 0 ? s * s * s * (s * (6 * s - 15) + 10) : 0.0F;
  }
};

}  // namespace

template <exec::Space Exec>
void average_at(Exec& ex, const ParticlesView& particles, ArrayView<const Vec3f> vertices, const VertexMeans& means) {
  for_each(ex, "fluid.attributes", vertices.size, AverageAtVertex{particles, vertices, means});
}

template <exec::Space Exec>
exec::Buffer<std::int32_t> nearest_at(Exec& ex, const ParticlesView& particles, ArrayView<const std::int32_t> order,
                                      ArrayView<const std::uint8_t> missing, ArrayView<const Vec3f> vertices) {
  auto out = exec::make_buffer<std::int32_t>(ex, vertices.size);
  for_each(ex, "fluid.labels", vertices.size, NearestAtVertex{particles, order, missing, vertices, out.view()});
  return out;
}

template <exec::Space Exec>
exec::Buffer<float> crowding(Exec& ex, const ParticlesView& particles) {
  auto out = exec::make_buffer<float>(ex, particles.positions.size);
  for_each(ex, "fluid.crowding", out.size(), CrowdingOf{particles, out.view()});
  return out;
}

template <exec::Space Exec>
void to_smoothing_weights(Exec& ex, float bulk, ArrayView<float> values) {
  for_each(ex, "fluid.weights", values.size, ToWeight{1 / bulk, values});
}

PSK_INSTANTIATE(average_at);
PSK_INSTANTIATE(nearest_at);
PSK_INSTANTIATE(crowding);
PSK_INSTANTIATE(to_smoothing_weights);

}  // namespace pointskin::fluid
