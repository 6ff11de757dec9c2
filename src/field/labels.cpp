#include "field/attributes.hpp"

#include <utility>

#include "exec/this_space.hpp"
#include "field/attributes.hpp"
#include "octree/search.hpp"

namespace pointskin::field {
namespace {

struct HasLabel {
  ArrayView<const std::uint8_t> missing;
  PSK_HD bool operator()(std::int64_t i) const { return missing[i] == 0; }
};

struct CountLabel {
  HasLabel has_label;
  ArrayView<std::int32_t> counts;
  PSK_HD void operator()(std::int64_t i) const { counts[i] = has_label(i) ? 1 : 0; }
};

struct Differ {
  ArrayView<const std::uint8_t> a, b;
  PSK_HD std::int64_t operator()(std::int64_t i) const { return a[i] != b[i] ? 1 : 0; }
};

/// True if both labels miss the same samples, so that one search serves both.
template <exec::Space Exec>
bool miss_alike(Exec& ex, const exec::TypedBuffer& a, const exec::TypedBuffer& b) {
  if (a.missing.empty() || b.missing.empty()) return a.missing.empty() && b.missing.empty();
  return exec::reduce<std::int64_t>(ex, "labels.compare", a.size, Differ{a.missing.cview(), b.missing.cview()},
                                    exec::Plus{}) == 0;
}

/// The samples that have a label, for searches through the tree of all samples.
struct Labelled {
  exec::Buffer<Vec3f> positions;
  exec::Buffer<std::int32_t> indices, before;
};

template <exec::Space Exec>
Labelled select_labelled(Exec& ex, ArrayView<const Vec3f> positions, ArrayView<const std::uint8_t> missing) {
  Labelled some;
  some.before = exec::make_buffer<std::int32_t>(ex, missing.size + 1);
  {
    auto counts = exec::make_buffer<std::int32_t>(ex, missing.size);
    for_each(ex, "labels.select", missing.size, CountLabel{{missing}, counts.view()});
    exclusive_scan(ex, "labels.select", counts.cview(), some.before.view());
  }
  some.indices = select(ex, "labels.select", missing.size, HasLabel{missing});
  some.positions = exec::make_buffer<Vec3f>(ex, some.indices.size());
  exec::gather(ex, positions, some.indices.cview(), some.positions.view());
  return some;
}

/// From places among those that have the label to samples.
struct ToSample {
  ArrayView<const std::int32_t> indices;
  ArrayView<std::int32_t> places;
  PSK_HD void operator()(std::int64_t i) const {
    if (places[i] >= 0) places[i] = indices[places[i]];
  }
};

/// Index of the nearest sample that has the label, for every point; -1 if none has it.
template <exec::Space Exec>
exec::Buffer<std::int32_t> nearest(Exec& ex, const octree::OctreeView& tree, ArrayView<const Vec3f> positions,
                                   ArrayView<const std::uint8_t> missing, ArrayView<const Vec3f> points) {
  auto places = exec::make_buffer<std::int32_t>(ex, points.size);
  if (missing.empty()) {
    octree::find_nearest_place(ex, {tree, positions, {}}, points, places.view());
    return places;
  }
  const Labelled some = select_labelled(ex, positions, missing);
  octree::find_nearest_place(ex, {tree, some.positions.cview(), {}, some.before.cview()}, points, places.view());
  for_each(ex, "labels.select", points.size, ToSample{some.indices.cview(), places.view()});
  return places;
}

}  // namespace

template <exec::Space Exec>
void find_labels(Exec& ex, const octree::OctreeData& tree, const AttributeSamples& samples,
                 ArrayView<const Vec3f> points, const TakeValues& take) {
  const octree::OctreeView view = tree.view();
  std::vector<bool> done(samples.labels.size());
  for (std::size_t first = 0; first < samples.labels.size(); ++first) {
    if (done[first]) continue;
    const exec::TypedBuffer& searched = samples.labels[first].values;
    const exec::Buffer<std::int32_t> ids =
        nearest(ex, view, samples.positions.cview(), searched.missing.cview(), points);
    const auto found = searched.missing.empty() ? exec::Indices::all : exec::Indices::some;
    for (std::size_t other = first; other < samples.labels.size(); ++other) {
      const Label& label = samples.labels[other];
      if (done[other] || !miss_alike(ex, searched, label.values)) continue;
      done[other] = true;
      take(label.place, exec::gather_typed(ex, label.values.view(), ids.cview(), found));
    }
  }
}

PSK_INSTANTIATE(find_labels);

}  // namespace pointskin::field
