#include "scale/block_labels.hpp"

#include <algorithm>
#include <cstddef>
#include <limits>
#include <utility>
#include <vector>

#include "exec/this_space.hpp"
#include "exec/typed_buffer.hpp"
#include "octree/search.hpp"
#include "octree/walk.hpp"
#include "scale/attributes_of_samples.hpp"
#include "scale/far_points.hpp"
#include "scale/staging.hpp"

namespace pointskin::scale {
namespace {

constexpr const char* kLabel = "scale.labels";

/// Squared distances to what was found; infinite where nothing was.
struct MeasureFound {
  ArrayView<const Vec3f> positions, points;
  ArrayView<const std::int32_t> places;
  ArrayView<float> squared;
  PSK_HD void operator()(std::int64_t i) const {
    squared[i] = places[i] < 0 ? std::numeric_limits<float>::infinity()
                               : octree::squared_distance(points[i], positions[places[i]]);
  }
};

/// Forgets what is no nearer than what was found before.
struct KeepNearer {
  ArrayView<const float> squared;
  ArrayView<float> best;
  ArrayView<std::int32_t> places;
  PSK_HD void operator()(std::int64_t i) const {
    if (squared[i] < best[i])
      best[i] = squared[i];
    else
      places[i] = -1;
  }
};

/// Values of places that are not forgotten.
struct CopyFound {
  ArrayView<const std::int32_t> places, targets;
  TypedView from;
  TypedOutput to;
  PSK_HD void operator()(std::int64_t i) const {
    if (places[i] < 0) return;
    visit_type(from.type, [&](auto tag) {
      using T = decltype(tag);
      static_cast<T*>(to.data)[targets[i]] = from.value<T>(places[i]);
    });
  }
};

template <exec::Space Exec>
class LabelsOfBlock {
 public:
  LabelsOfBlock(Exec& ex, const SharedOfBlocks& shared, const BlockRange& own) : ex_(ex), shared_(shared), own_(own) {}

  void find(const LabelledSamples& samples, ArrayView<const Vec3f> points, ArrayView<const std::uint64_t> keys,
            const field::TakeValues& take) {
    std::vector<exec::TypedBuffer> values;
    std::vector<std::int32_t> far;
    {
      auto places = exec::make_buffer<std::int32_t>(ex_, points.size);
      const exec::Buffer<float> squared = find_nearest(samples.tree, samples.positions, points, places.view());
      for (const field::Label& label : samples.labels)
        values.push_back(exec::gather_typed(ex_, label.values.view(), places.cview()));
      far = find_far_points(shared_.host, shared_.plan, own_, fetched(points).view(), fetched(keys).view(),
                            fetched(squared.cview()).view());
    }
    for (std::size_t first = 0; first < far.size(); first += kAtOnce)
      find_far(points, std::span(far).subspan(first, std::min(kAtOnce, far.size() - first)), values);
    for (std::size_t i = 0; i < values.size(); ++i) take(samples.labels[i].place, std::move(values[i]));
  }

 private:
  static constexpr std::size_t kAtOnce = 4096;

  template <class T>
  Fetched<T> fetched(ArrayView<const T> values) {
    return Fetched<T>(ex_, shared_.host, values);
  }

  exec::Buffer<float> find_nearest(const octree::OctreeData& tree, ArrayView<const Vec3f> positions,
                                   ArrayView<const Vec3f> points, ArrayView<std::int32_t> places) {
    octree::find_nearest_place(ex_, {tree.view(), positions, {}}, points, places);
    auto squared = exec::make_buffer<float>(ex_, points.size);
    for_each(ex_, kLabel, points.size, MeasureFound{positions, points, places, squared.view()});
    return squared;
  }

  /// Of some points, by their places, from all samples.
  void find_far(ArrayView<const Vec3f> points, std::span<const std::int32_t> far,
                std::vector<exec::TypedBuffer>& values) {
    auto targets = exec::make_buffer<std::int32_t>(ex_, std::ssize(far));
    copy_to_device(ex_, far.data(), targets.view());
    auto there = exec::make_buffer<Vec3f>(ex_, std::ssize(far));
    exec::gather<Vec3f>(ex_, points, targets.cview(), there.view());
    auto best = exec::make_buffer<float>(ex_, std::ssize(far));
    exec::fill(ex_, best.view(), std::numeric_limits<float>::infinity());
    const std::vector<SampleRun> runs = samples_around(shared_.host, shared_.plan, fetched(there.cview()).view());
    for (const std::vector<SampleRun>& part : cut_into_parts(runs, shared_.options.part_samples)) {
      const Part samples = read(part);
      auto places = exec::make_buffer<std::int32_t>(ex_, std::ssize(far));
      const exec::Buffer<float> squared =
          find_nearest(samples.tree, samples.positions.cview(), there.cview(), places.view());
      for_each(ex_, kLabel, places.size(), KeepNearer{squared.cview(), best.view(), places.view()});
      for (std::size_t i = 0; i < values.size(); ++i)
        for_each(ex_, kLabel, places.size(),
                 CopyFound{places.cview(), targets.cview(), samples.labels[i].values.view(), values[i].output()});
    }
  }

  struct Part {
    octree::OctreeData tree;
    exec::Buffer<Vec3f> positions;
    std::vector<field::Label> labels;
  };

  Part read(const std::vector<SampleRun>& runs) {
    std::int64_t count = 0;
    for (const SampleRun& run : runs) count += run.end - run.begin;
    Sent<std::uint64_t> keys(shared_.host, count);
    Sent<Vec3f> positions(shared_.host, count);
    AttributesOfSamples attributes(shared_.host, shared_.cloud.attributes(), count, AttributesOfSamples::Which::labels);
    std::int64_t at = 0;
    for (const SampleRun& run : runs) {
      const AttributesOfSamples::Places to = attributes.from(at);
      shared_.cloud.read(shared_.host, run.begin, run.end - run.begin,
                         {positions.data() + at, nullptr, keys.data() + at, {}, to.raw});
      at += run.end - run.begin;
    }
    Part part;
    std::vector<field::Channel> none;
    attributes.to(ex_, none, part.labels);
    part.positions = positions.to(ex_);
    const exec::Buffer<std::uint64_t> there = keys.to(ex_);
    constexpr int kFiner = 2;  // a cell of level K may hold thousands; finest cells take memory
    part.tree = octree::build_octree(ex_, there.cview(), shared_.plan.level() + kFiner);
    return part;
  }

  Exec& ex_;
  const SharedOfBlocks& shared_;
  const BlockRange& own_;
};

}  // namespace

template <exec::Space Exec>
void find_labels_of_block(Exec& ex, const SharedOfBlocks& shared, const BlockRange& own, const LabelledSamples& samples,
                          ArrayView<const Vec3f> points, ArrayView<const std::uint64_t> keys,
                          const field::TakeValues& take) {
  LabelsOfBlock<Exec>(ex, shared, own).find(samples, points, keys, take);
}

PSK_INSTANTIATE(find_labels_of_block);

}  // namespace pointskin::scale
