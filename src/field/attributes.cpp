#include "field/attributes.hpp"

#include <algorithm>
#include <span>
#include <type_traits>
#include <utility>
#include <vector>

#include "exec/this_space.hpp"
#include "field/in_blocks.hpp"
#include "octree/access.hpp"

namespace pointskin::field {
namespace {

/// Values of a few attributes at a corner, with the weight that they have there; or sums of weighted values.
template <int kCount>
struct alignas(kCount == 3   ? 16
               : kCount == 1 ? 8
                             : 4) Values {
  float weight = 0;
  float value[kCount] = {};

  PSK_HD Values& operator+=(const Values& other) {
    weight += other.weight;
    PSK_UNROLL
    for (int c = 0; c < kCount; ++c) value[c] += other.value[c];
    return *this;
  }
  PSK_HD Values operator*(float factor) const {
    Values result = *this;
    result.weight *= factor;
    PSK_UNROLL
    for (int c = 0; c < kCount; ++c) result.value[c] *= factor;
    return result;
  }
};

/// A sum of weighted values as their mean; zeros where nothing has weight.
template <int kCount>
PSK_HD Values<kCount> mean_of(Values<kCount> sum) {
  PSK_UNROLL
  for (int c = 0; c < kCount; ++c) sum.value[c] = sum.weight > 0 ? sum.value[c] / sum.weight : 0.0F;
  return sum;
}

/// Means as weighted values, for the level above. A corner counts for one sample at most: what is sampled more densely
/// does not outweigh the rest of the surface.
template <int kCount>
struct Capped {
  const Values<kCount>* means;
  PSK_HD Values<kCount> operator[](std::int64_t n) const {
    Values<kCount> v = means[n];
    v.weight = v.weight < 1 ? v.weight : 1.0F;
    PSK_UNROLL
    for (int c = 0; c < kCount; ++c) v.value[c] *= v.weight;
    return v;
  }
};

/// `below` weighted by the samples, `above` by kSamplesAbove.
template <int kCount>
PSK_HD Values<kCount> blended(Values<kCount> below, const Values<kCount>& above) {
  const float total = below.weight + kSamplesAbove;
  PSK_UNROLL
  for (int c = 0; c < kCount; ++c)
    below.value[c] = (below.weight * below.value[c] + kSamplesAbove * above.value[c]) / total;
  return below;
}

/// The attributes of a pass, sample by sample. All of them miss the same samples.
template <int kCount>
struct SamplesView {
  ArrayView<const Vec3f> positions;
  ArrayView<const float> weights;
  const float* values[kCount];

  /// Sample i with its weight; zeros if it does not count.
  PSK_HD Values<kCount> operator[](std::int64_t i) const {
    Values<kCount> sample;
    const float first = values[0][i];
    if (!(first == first)) return sample;
    sample.weight = weights.empty() ? 1.0F : weights[i];
    PSK_UNROLL
    for (int c = 0; c < kCount; ++c) sample.value[c] = values[c][i];
    return sample;
  }
};

/// Adds a sample with `factor` times its weight.
template <int kCount>
PSK_HD void add_weighted(const Values<kCount>& sample, float factor, Values<kCount>& sum) {
  const float weight = factor * sample.weight;
  sum.weight += weight;
  PSK_UNROLL
  for (int c = 0; c < kCount; ++c) sum.value[c] += weight * sample.value[c];
}

/// Means at the corners of the finest level: every corner gathers the samples of the 8 cells around it, cell by cell
/// downwards (x first).
template <int kCount>
struct SplatToCorner {
  octree::LevelView level;
  SamplesView<kCount> samples;
  ArrayView<Values<kCount>> means;

  PSK_HD void operator()(std::int64_t n) const {
    Values<kCount> sum;
    for (int s = 0; s < 8; ++s) {
      const std::int32_t cell =
          level.neighbour(static_cast<std::int32_t>(n), -octree::slot_x(s), -octree::slot_y(s), -octree::slot_z(s));
      if (!level.is_cell(cell)) continue;
      const std::int32_t first = level.point_begin[cell];
      const std::int32_t last = level.point_begin[cell + 1];
      if (first == last) continue;
      const octree::Coordinates at = octree::decode(level.node_key(cell));
      PSK_UNROLL_BY_4 for (std::int32_t i = first; i < last; ++i) {
        const Vec3f local = octree::local_in_cell(samples.positions[i], at, level.depth);
        add_weighted(samples[i], octree::corner_weight(s, local), sum);
      }
    }
    means[n] = mean_of(sum);
  }
};

/// The same for the 8 corners of a brick at once, in the same order for each: fewer look-ups, and a sample is read once
/// for all its corners there.
template <int kCount>
struct SplatToBrick {
  octree::LevelView level;
  SamplesView<kCount> samples;
  ArrayView<Values<kCount>> means;

  PSK_HD void operator()(std::int64_t brick) const {
    Values<kCount> sums[8];
    const auto own = static_cast<std::int32_t>(8 * brick);
    for (int x = 1; x >= -1; --x)
      for (int y = 1; y >= -1; --y)
        for (int z = 1; z >= -1; --z) add_cell(level.neighbour(own, x, y, z), x, y, z, sums);
    for (int s = 0; s < 8; ++s) means[own + s] = mean_of(sums[s]);
  }

  /// Adds the samples of the cell at (x, y, z) from the brick's first to those of its corners that are in the brick.
  PSK_HD void add_cell(std::int32_t cell, int x, int y, int z, Values<kCount>* sums) const {
    if (!level.is_cell(cell)) return;
    const std::int32_t first = level.point_begin[cell];
    const std::int32_t last = level.point_begin[cell + 1];
    if (first == last) return;
    const octree::Coordinates at = octree::decode(level.node_key(cell));
    for (std::int32_t i = first; i < last; ++i) {
      const Vec3f local = octree::local_in_cell(samples.positions[i], at, level.depth);
      const Values<kCount> sample = samples[i];
      for (int cx = x < 0 ? 0 : x; cx <= x + 1 && cx < 2; ++cx)
        for (int cy = y < 0 ? 0 : y; cy <= y + 1 && cy < 2; ++cy)
          for (int cz = z < 0 ? 0 : z; cz <= z + 1 && cz < 2; ++cz)
            add_weighted(sample, octree::corner_weight(octree::slot_of(cx - x, cy - y, cz - z), local),
                         sums[octree::slot_of(cx, cy, cz)]);
    }
  }
};

template <int kCount>
struct Pull {
  octree::LevelView level, below;
  const Values<kCount>* below_means;
  ArrayView<Values<kCount>> means;
  PSK_HD void operator()(std::int64_t n) const {
    means[n] = mean_of(octree::restricted(level, below, Capped<kCount>{below_means}, static_cast<std::int32_t>(n)));
  }
};

/// Level 0 leans on the mean of its 8 corners. One index, as each of them reads all.
template <int kCount>
struct PushRoot {
  ArrayView<Values<kCount>> values;  // (8)
  PSK_HD void operator()(std::int64_t /*zero*/) const {
    const Capped<kCount> capped{values.data};
    Values<kCount> all;
    for (int n = 0; n < 8; ++n) all += capped[n];
    all = mean_of(all);
    for (int n = 0; n < 8; ++n) values[n] = blended(values[n], all);
  }
};

template <int kCount>
struct Push {
  octree::LevelView level, above;
  const Values<kCount>* above_values;
  ArrayView<Values<kCount>> values;  // of the level: means before, values after
  PSK_HD void operator()(std::int64_t n) const {
    values[n] =
        blended(values[n], octree::prolonged(above, above_values, level.parent[n >> 3], static_cast<int>(n & 7)));
  }
};

template <int kCount>
struct EvaluateChannels {
  octree::OctreeView tree;
  const Values<kCount>* values;
  ArrayView<const Vec3f> points;
  FromShares scales[kCount];
  PSK_HD void operator()(std::int64_t i) const {
    const Values<kCount> at = octree::value_at(tree, values, points[i], tree.depth);
    PSK_UNROLL
    for (int c = 0; c < kCount; ++c) scales[c].store(i, at.value[c]);
  }
};

/// False for infinities and NaN.
PSK_HD bool is_finite(double v) { return 0 * v == 0; }

struct RangeOf {
  TypedView values;
  ArrayView<const std::int32_t> used;
  PSK_HD ValueRange operator()(std::int64_t i) const {
    const double v = values[used.empty() ? i : used[i]] + 0.0;  // -0 becomes 0: which of the two comes first is chance
    return is_finite(v) ? ValueRange{v, v, 1} : ValueRange{};
  }
};
struct UniteRanges {
  PSK_HD ValueRange operator()(const ValueRange& a, const ValueRange& b) const { return a.united(b); }
};

struct ToShares {
  TypedView values;
  ArrayView<const std::int32_t> order;
  ToShare to_share;
  ArrayView<float> shares;
  PSK_HD void operator()(std::int64_t i) const { shares[i] = to_share(values[order[i]]); }
};

/// Samples that count for one of two channels only.
struct CountedDifferently {
  ArrayView<const float> a, b;
  PSK_HD std::int64_t operator()(std::int64_t i) const { return (a[i] == a[i]) != (b[i] == b[i]) ? 1 : 0; }
};

/// True if both channels miss the same samples, so that one weight a corner serves both.
template <exec::Space Exec>
bool count_alike(Exec& ex, const Channel& a, const Channel& b) {
  if (a.range.counted != b.range.counted) return false;
  if (a.range.counted == a.shares.size()) return true;
  return exec::reduce<std::int64_t>(ex, "attributes.compare", a.shares.size(),
                                    CountedDifferently{a.shares.cview(), b.shares.cview()}, exec::Plus{}) == 0;
}

/// Channels that share a pass, and their samples.
template <int kCount>
SamplesView<kCount> view_of(const ChannelSamples& samples) {
  SamplesView<kCount> view{samples.positions, samples.weights, {}};
  for (int c = 0; c < kCount; ++c) view.values[c] = samples.channels[static_cast<std::size_t>(c)].shares.data();
  return view;
}

/// Steps of a pass over the corners of all levels.
template <int kCount, exec::Space Exec>
class CornerPass {
 public:
  /// @param values  shape (nodes of all levels), level-major
  CornerPass(Exec& ex, const octree::OctreeView& tree, ArrayView<Values<kCount>> values)
      : ex_(ex), tree_(tree), values_(values) {}

  /// Means at the corners of the finest level.
  void splat(const SamplesView<kCount>& samples) {
    const octree::LevelView& finest = tree_.finest();
    if constexpr (Exec::kManyThreads)
      for_each(ex_, "attributes.splat", finest.nodes(), SplatToCorner<kCount>{finest, samples, of_level(tree_.depth)});
    else
      for_each(ex_, "attributes.splat", finest.bricks, SplatToBrick<kCount>{finest, samples, of_level(tree_.depth)});
  }
  /// Means of the levels above `level`, up to `last`.
  void pull(int level, int last) {
    for (int d = level - 1; d >= last; --d)
      for_each(ex_, "attributes.pull", tree_.levels[d].nodes(),
               Pull<kCount>{tree_.levels[d], tree_.levels[d + 1], of_level(d + 1).data, of_level(d)});
  }
  void push_root() { for_each(ex_, "attributes.push", 1, PushRoot<kCount>{of_level(0)}); }
  /// Values of the levels below `level`, whose values are there.
  void push(int level) {
    for (int d = level + 1; d <= tree_.depth; ++d)
      for_each(ex_, "attributes.push", tree_.levels[d].nodes(),
               Push<kCount>{tree_.levels[d], tree_.levels[d - 1], of_level(d - 1).data, of_level(d)});
  }

 private:
  [[nodiscard]] ArrayView<Values<kCount>> of_level(int d) const {
    return values_.part(tree_.levels[d].first_node, tree_.levels[d].nodes());
  }
  Exec& ex_;
  const octree::OctreeView& tree_;
  ArrayView<Values<kCount>> values_;
};

/// Evaluates values at the corners of all levels at `points`.
template <int kCount, exec::Space Exec>
void evaluate_channels(Exec& ex, const octree::OctreeView& tree, exec::Buffer<Values<kCount>> values,
                       std::span<const Channel> channels, ArrayView<const Vec3f> points, const TakeValues& take) {
  exec::TypedBuffer out[kCount];
  EvaluateChannels<kCount> evaluate{tree, values.data(), points, {}};
  for (std::size_t c = 0; c < kCount; ++c) {
    out[c] = exec::make_typed_buffer(ex, channels[c].type, points.size);
    evaluate.scales[c] = {channels[c].range.lowest, channels[c].range.highest, out[c].output()};
  }
  for_each(ex, "attributes.evaluate", points.size, evaluate);
  values.reset();
  for (std::size_t c = 0; c < kCount; ++c) take(channels[c].place, std::move(out[c]));
}

/// Calls work with the number of channels of a pass as a constant.
template <class Work>
void with_count(std::size_t count, const Work& work) {
  if (count == 1) work(std::integral_constant<int, 1>{});
  if (count == 2) work(std::integral_constant<int, 2>{});
  if (count == 3) work(std::integral_constant<int, 3>{});
}

/// Values of corners as floats: the weight, and then the channels.
template <int kCount>
ArrayView<Values<kCount>> as_values(ArrayView<float> floats) {
  static_assert(sizeof(Values<kCount>) == (1 + kCount) * sizeof(float));
  return {reinterpret_cast<Values<kCount>*>(floats.data), floats.size / (1 + kCount)};
}

}  // namespace

template <exec::Space Exec>
ValueRange find_range(Exec& ex, const TypedView& values, ArrayView<const std::int32_t> used) {
  const std::int64_t n = used.empty() ? values.size : used.size;
  return exec::reduce<ValueRange>(ex, "attributes.range", n, RangeOf{values, used}, UniteRanges{});
}

template <exec::Space Exec>
Channel make_channel(Exec& ex, std::size_t place, const TypedView& values, const ValueRange& range,
                     ArrayView<const std::int32_t> order) {
  Channel channel{place, values.type, exec::make_buffer<float>(ex, order.size), range};
  for_each(ex, "attributes.shares", order.size, ToShares{values, order, ToShare(range), channel.shares.view()});
  return channel;
}

template <exec::Space Exec>
void interpolate(Exec& ex, const octree::OctreeData& tree, const AttributeSamples& samples,
                 ArrayView<const Vec3f> points, const TakeValues& take) {
  const std::vector<Channel>& channels = samples.channels;
  const octree::OctreeView view = tree.view();
  for (std::size_t first = 0; first < channels.size();) {
    const std::size_t most = std::min(kAttributesAtOnce, channels.size() - first);
    std::size_t count = 1;
    while (count < most && count_alike(ex, channels[first], channels[first + count])) ++count;
    const ChannelSamples some{samples.positions.cview(), samples.weights.cview(),
                              std::span(channels).subspan(first, count)};
    with_count(count, [&](auto constant) {
      constexpr int kCount = decltype(constant)::value;
      auto values = exec::make_buffer<Values<kCount>>(ex, view.nodes);
      CornerPass<kCount, Exec> pass(ex, view, values.view());
      pass.splat(view_of<kCount>(some));
      pass.pull(view.depth, 0);
      pass.push_root();
      pass.push(0);
      evaluate_channels<kCount>(ex, view, std::move(values), some.channels, points, take);
    });
    first += count;
  }
}

template <exec::Space Exec>
exec::Buffer<float> channel_means_below(Exec& ex, const octree::OctreeData& tree, const ChannelSamples& samples,
                                        int level) {
  const octree::OctreeView view = tree.view();
  auto means = exec::make_buffer<float>(ex, view.nodes * static_cast<std::int64_t>(1 + samples.channels.size()));
  with_count(samples.channels.size(), [&](auto constant) {
    constexpr int kCount = decltype(constant)::value;
    CornerPass<kCount, Exec> pass(ex, view, as_values<kCount>(means.view()));
    pass.splat(view_of<kCount>(samples));
    pass.pull(view.depth, level);
  });
  return means;
}

template <exec::Space Exec>
void finish_coarse_channels(Exec& ex, const octree::OctreeData& tree, std::size_t channels, ArrayView<float> values) {
  const octree::OctreeView view = tree.view();
  with_count(channels, [&](auto constant) {
    constexpr int kCount = decltype(constant)::value;
    CornerPass<kCount, Exec> pass(ex, view, as_values<kCount>(values));
    pass.pull(view.depth, 0);
    pass.push_root();
    pass.push(0);
  });
}

template <exec::Space Exec>
void interpolate_below(Exec& ex, const octree::OctreeData& tree, const ChannelSamples& samples, int level,
                       ArrayView<const float> given, ArrayView<const Vec3f> points, const TakeValues& take) {
  const octree::OctreeView view = tree.view();
  with_count(samples.channels.size(), [&](auto constant) {
    constexpr int kCount = decltype(constant)::value;
    auto values = exec::make_buffer<Values<kCount>>(ex, view.nodes);
    CornerPass<kCount, Exec> pass(ex, view, values.view());
    pass.splat(view_of<kCount>(samples));
    pass.pull(view.depth, level + 1);
    copy(ex, given, ArrayView<float>{reinterpret_cast<float*>(values.data()), given.size});
    pass.push(level);
    evaluate_channels<kCount>(ex, view, std::move(values), samples.channels, points, take);
  });
}

PSK_INSTANTIATE(find_range);
PSK_INSTANTIATE(make_channel);
PSK_INSTANTIATE(interpolate);
PSK_INSTANTIATE(channel_means_below);
PSK_INSTANTIATE(finish_coarse_channels);
PSK_INSTANTIATE(interpolate_below);

}  // namespace pointskin::field
