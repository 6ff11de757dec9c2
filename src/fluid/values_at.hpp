// Values of the particles at the vertices of their surface: means of continuous ones, labels of the nearest particle.
#pragma once

#include <cstdint>
#include <utility>
#include <vector>

#include "exec/algorithms.hpp"
#include "exec/typed_buffer.hpp"
#include "field/attributes.hpp"
#include "fluid/surface.hpp"
#include "fluid/vertex_values.hpp"

namespace pointskin::fluid {

/// Particles and what they have.
struct ValueSources {
  ParticlesView particles;
  ArrayView<const std::int32_t> order;        ///< the caller's index of each particle of the view
  const std::vector<ParticleValues>& values;  ///< in the caller's order
};

namespace values_at_detail {

struct GatherFloat {
  TypedView from;
  ArrayView<const std::int32_t> index;
  ArrayView<float> to;
  PSK_HD void operator()(std::int64_t i) const { to[i] = from.as_float(index[i]); }
};

/// Means of numbers that float holds, rounded where they are integers.
struct StoreMean {
  ArrayView<const float> means;
  TypedOutput out;
  PSK_HD void operator()(std::int64_t v) const { out.store(v, static_cast<double>(means[v])); }
};

struct StoreShare {
  ArrayView<const float> means;
  field::FromShares scale;
  PSK_HD void operator()(std::int64_t v) const { scale.store(v, means[v]); }
};

/// Averages up to kValuesAtOnce values in one pass.
template <exec::Space Exec>
class Averages {
 public:
  Averages(Exec& ex, const ValueSources& sources, ArrayView<const Vec3f> vertices)
      : ex_(ex), sources_(sources), vertices_(vertices) {}

  /// `to` is written when finish() returns, or before.
  /// @param values  of the particles of the view
  void add(exec::Buffer<float> values, float* to) {
    means_.values[means_.count] = values.data();
    means_.out[means_.count] = to;
    gathered_.push_back(std::move(values));
    if (++means_.count == kValuesAtOnce) finish();
  }

  void finish() {
    if (means_.count > 0) average_at(ex_, sources_.particles, vertices_, means_);
    means_ = {};
    gathered_.clear();
  }

 private:
  Exec& ex_;
  const ValueSources& sources_;
  ArrayView<const Vec3f> vertices_;
  VertexMeans means_;
  std::vector<exec::Buffer<float>> gathered_;
};

/// The values in the order of the view: as they are, or, of float64, as shares of their range.
template <exec::Space Exec>
exec::Buffer<float> to_average(Exec& ex, const ValueSources& sources, const TypedView& values,
                               const field::ValueRange& range) {
  if (values.type == AttributeType::float64) return field::make_channel(ex, 0, values, range, sources.order).shares;
  auto floats = exec::make_buffer<float>(ex, sources.order.size);
  for_each(ex, "fluid.attributes", floats.size(), GatherFloat{values, sources.order, floats.view()});
  return floats;
}

/// Means that are no floats yet, and what becomes of them.
struct Unfinished {
  std::size_t place;
  exec::Buffer<float> means;
  field::ValueRange range;
};

template <exec::Space Exec>
void finish(Exec& ex, const Unfinished& from, const exec::TypedBuffer& to) {
  if (to.type == AttributeType::float64)
    for_each(ex, "fluid.attributes", to.size,
             StoreShare{from.means.cview(), {from.range.lowest, from.range.highest, to.output()}});
  else
    for_each(ex, "fluid.attributes", to.size, StoreMean{from.means.cview(), to.output()});
}

/// Labels of the nearest particles; one search for all labels that no particle lacks.
template <exec::Space Exec>
class Labels {
 public:
  Labels(Exec& ex, const ValueSources& sources, ArrayView<const Vec3f> vertices)
      : ex_(ex), sources_(sources), vertices_(vertices) {}

  exec::TypedBuffer at_vertices(const TypedView& values) {
    if (values.missing == nullptr) {
      if (nearest_.empty()) nearest_ = nearest_at(ex_, sources_.particles, sources_.order, {}, vertices_);
      return exec::gather_typed(ex_, values, nearest_.cview(), exec::Indices::some);
    }
    const exec::Buffer<std::int32_t> nearest =
        nearest_at(ex_, sources_.particles, sources_.order, {values.missing, values.size}, vertices_);
    return exec::gather_typed(ex_, values, nearest.cview(), exec::Indices::some);
  }

 private:
  Exec& ex_;
  const ValueSources& sources_;
  ArrayView<const Vec3f> vertices_;
  exec::Buffer<std::int32_t> nearest_;
};

}  // namespace values_at_detail

/// All values, and the crowding where it is asked for, at the vertices: in the order and of the types of the sources.
/// @param weights  receives the crowding, or null
template <exec::Space Exec>
std::vector<exec::TypedBuffer> values_at(Exec& ex, const ValueSources& sources, ArrayView<const Vec3f> vertices,
                                         exec::Buffer<float>* weights) {
  namespace parts = values_at_detail;
  parts::Averages<Exec> averages(ex, sources, vertices);
  parts::Labels<Exec> labels(ex, sources, vertices);
  if (weights != nullptr) {
    *weights = exec::make_buffer<float>(ex, vertices.size);
    averages.add(crowding(ex, sources.particles), weights->data());
  }
  std::vector<exec::TypedBuffer> out(sources.values.size());
  std::vector<parts::Unfinished> unfinished;
  for (std::size_t a = 0; a < out.size(); ++a) {
    const TypedView& from = sources.values[a].values;
    if (is_label(sources.values[a].name, from.type)) {
      out[a] = labels.at_vertices(from);
      continue;
    }
    out[a] = exec::make_typed_buffer(ex, from.type, vertices.size);
    const field::ValueRange range =
        from.type == AttributeType::float64 ? field::find_range(ex, from, {}) : field::ValueRange{};
    float* means = out[a].template as<float>().data;
    if (from.type != AttributeType::float32) {
      unfinished.push_back({a, exec::make_buffer<float>(ex, vertices.size), range});
      means = unfinished.back().means.data();
    }
    averages.add(parts::to_average(ex, sources, from, range), means);
  }
  averages.finish();
  for (const parts::Unfinished& from : unfinished) parts::finish(ex, from, out[from.place]);
  return out;
}

}  // namespace pointskin::fluid
