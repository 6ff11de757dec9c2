#include "exec/gpus/collectives.cuh"

#include <cub/device/device_merge.cuh>
#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_reduce.cuh>
#include <cub/device/device_scan.cuh>
#include <cub/device/device_select.cuh>

#include <cstddef>
#include <utility>
#include <vector>

#include "exec/counting_iterator.cuh"
#include "exec/cuda_primitives.cuh"
#include "exec/gpus/layout.hpp"
#include "exec/gpus/merge_cuts.hpp"
#include "exec/gpus/shares.hpp"

namespace pointskin::exec::gpus {
namespace {

/// Runs a CUB algorithm on GPU `g`, the current one: once to learn its scratch size, once for real.
template <class Algorithm>
void run_cub(Group& group, int g, const char* label, const Algorithm& algorithm) {
  std::size_t bytes = 0;
  cuda_check(algorithm(nullptr, bytes), label);
  const Buffer<std::byte> scratch = group.own_scratch(g, bytes);
  cuda_check(algorithm(scratch.data(), bytes), label);
}

// --- choosing

/// Puts what all found together.
Buffer<std::int32_t> join_found(Cuda& ex, const Shares& shares, const Buffer<std::int32_t>& found,
                                const std::vector<std::int32_t>& counts) {
  std::vector<std::int64_t> before{0};
  for (const std::int32_t count : counts) before.push_back(before.back() + count);
  Buffer<std::int32_t> kept(ex.pool(), before.back());
  ex.group()->spread([&](int g, void* stream) {
    const auto at = static_cast<std::size_t>(g);
    if (counts[at] == 0) return;
    cuda_check(cudaMemcpyAsync(kept.data() + before[at], found.data() + shares.begin(g),
                               static_cast<std::size_t>(counts[at]) * sizeof(std::int32_t), cudaMemcpyDeviceToDevice,
                               static_cast<cudaStream_t>(stream)),
               "copying on the GPU");
  });
  return kept;
}

}  // namespace

Buffer<std::int32_t> select_flagged(Cuda& ex, const char* label, ArrayView<const std::uint8_t> flags) {
  throw_if_cancelled();
  Group& group = *ex.group();
  const Shares shares{flags.size, group.count()};
  Buffer<std::int32_t> found(ex.pool(), flags.size);
  Buffer<std::int32_t> counted = Buffer<std::int32_t>(ex.pool(), group.count());
  group.spread([&](int g, void* stream) {
    run_cub(group, g, label, [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceSelect::Flagged(scratch, bytes, CountingIterator{shares.begin(g)}, flags.data + shares.begin(g),
                                        found.data() + shares.begin(g), counted.data() + g, shares.size(g),
                                        static_cast<cudaStream_t>(stream));
    });
  });
  std::vector<std::int32_t> counts(static_cast<std::size_t>(group.count()));
  copy_to_host(ex, counted.cview(), counts.data());
  return join_found(ex, shares, found, counts);
}

// --- scanning

namespace {

/// sums[k] becomes the sum of those before; `total`, if there is one, that of all.
template <class T>
__global__ void scan_sums(T* sums, int count, T* total) {
  T sum = 0;
  for (int k = 0; k < count; ++k) sum += std::exchange(sums[k], sum);
  if (total != nullptr) *total = sum;
}

/// run(g, k, interval, stream) for every interval k that is GPU g's.
template <class Run>
void for_owned(Group& group, const std::vector<Owned>& owned, const Run& run) {
  group.spread([&](int g, void* stream) {
    for (std::size_t k = 0; k < owned.size(); ++k)
      if (owned[k].gpu == g) run(g, k, owned[k].interval, static_cast<cudaStream_t>(stream));
  });
}

}  // namespace

template <class T>
void exclusive_scan(Cuda& ex, const char* label, ArrayView<const T> in, ArrayView<T> out) {
  throw_if_cancelled();
  Group& group = *ex.group();
  const std::vector<Owned> owned = owners_of(group.layout(), group.count(), in.size);
  Buffer<T> sums = Buffer<T>(ex.pool(), static_cast<std::int64_t>(owned.size()));
  for_owned(group, owned, [&](int g, std::size_t k, const Layout::Interval& own, cudaStream_t stream) {
    run_cub(group, g, label, [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceReduce::Sum(scratch, bytes, in.data + own.begin, sums.data() + k, own.size(), stream);
    });
  });
  scan_sums<<<1, 1, 0, stream_of(ex)>>>(sums.data(), static_cast<int>(owned.size()),
                                        out.size > in.size ? out.data + in.size : nullptr);
  cuda_check(cudaGetLastError(), label);
  for_owned(group, owned, [&](int g, std::size_t k, const Layout::Interval& own, cudaStream_t stream) {
    run_cub(group, g, label, [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceScan::ExclusiveScan(scratch, bytes, in.data + own.begin, out.data + own.begin,
                                            cuda::std::plus<>{}, cub::FutureValue<T>(sums.data() + k), own.size(),
                                            stream);
    });
  });
}

template void exclusive_scan(Cuda&, const char*, ArrayView<const std::int32_t>, ArrayView<std::int32_t>);
template void exclusive_scan(Cuda&, const char*, ArrayView<const std::int64_t>, ArrayView<std::int64_t>);
template void exclusive_scan(Cuda&, const char*, ArrayView<const std::uint64_t>, ArrayView<std::uint64_t>);

// --- sorting

namespace {

/// Keys, and values if there are any.
struct Pairs {
  std::uint64_t* keys;
  std::int32_t* values;

  [[nodiscard]] Pairs from(std::int64_t at) const { return {keys + at, values == nullptr ? nullptr : values + at}; }
};

struct Less {
  KeyBits bits;
  __host__ __device__ bool operator()(std::uint64_t a, std::uint64_t b) const { return bits(a) < bits(b); }
};

/// Elements [begin, end) of an array that lies in order.
struct Segment {
  std::int64_t begin, end;
  [[nodiscard]] std::int64_t size() const { return end - begin; }
};

/// A block of one warp finds one cut: cuts[part * runs + run] elements of a run belong to the parts before `part`.
__global__ void __launch_bounds__(kWarp) find_cuts_kernel(SortedRuns runs, ArrayView<std::int64_t> cuts) {
  const int count = runs.shares.count;
  const int part = static_cast<int>(blockIdx.x) / count;
  const int run = static_cast<int>(blockIdx.x) % count;
  const int lane = static_cast<int>(threadIdx.x);
  CutSearch search{runs, run, runs.shares.begin(part), 0, runs.shares.size(run)};
  while (!search.is_done()) {
    const bool belongs = search.belongs(search.place(lane, kWarp));
    search.narrow(__popc(__ballot_sync(~0U, belongs)), kWarp);
  }
  if (lane == 0) cuts[blockIdx.x] = search.low;
}

/// Copies what a GPU has in the one array to the other.
void copy_pairs(const Pairs& from, const Pairs& to, std::int64_t size, cudaStream_t stream) {
  const auto count = static_cast<std::size_t>(size);
  cuda_check(cudaMemcpyAsync(to.keys, from.keys, count * sizeof(std::uint64_t), cudaMemcpyDeviceToDevice, stream),
             "copying on the GPU");
  if (from.values != nullptr)
    cuda_check(cudaMemcpyAsync(to.values, from.values, count * sizeof(std::int32_t), cudaMemcpyDeviceToDevice, stream),
               "copying on the GPU");
}

/// Sorts each GPU's share. @returns true if the results are in `other`
bool sort_shares(Group& group, const char* label, const Shares& shares, const Pairs& pairs, const Pairs& other,
                 const KeyBits& bits) {
  bool in_other = false;
  group.spread([&](int g, void* stream) {
    const auto to = static_cast<cudaStream_t>(stream);
    const Pairs own = pairs.from(shares.begin(g));
    const Pairs own_other = other.from(shares.begin(g));
    cub::DoubleBuffer<std::uint64_t> keys(own.keys, own_other.keys);
    cub::DoubleBuffer<std::int32_t> values(own.values, own_other.values);
    run_cub(group, g, label, [&](void* scratch, std::size_t& bytes) {
      if (own.values == nullptr)
        return cub::DeviceRadixSort::SortKeys(scratch, bytes, keys, shares.size(g), bits.first, bits.end, to);
      return cub::DeviceRadixSort::SortPairs(scratch, bytes, keys, values, shares.size(g), bits.first, bits.end, to);
    });
    const bool is_in_other = keys.Current() != own.keys;
    if (g == 0) in_other = is_in_other;
    // Shares differ by one element at most; CUB may still choose another number of passes for one of them.
    if (is_in_other != in_other)
      copy_pairs(is_in_other ? own_other : own, is_in_other ? own : own_other, shares.size(g), to);
  });
  return in_other;
}

std::vector<std::int64_t> find_cuts(Cuda& ex, const SortedRuns& runs) {
  const int count = runs.shares.count;
  Buffer<std::int64_t> cuts = Buffer<std::int64_t>(ex.pool(), std::int64_t{count} * count);
  find_cuts_kernel<<<static_cast<unsigned>(count * count), kWarp, 0, stream_of(ex)>>>(runs, cuts.view());
  cuda_check(cudaGetLastError(), "cutting sorted runs");
  std::vector<std::int64_t> found(static_cast<std::size_t>(cuts.size()));
  copy_to_host(ex, cuts.cview(), found.data());
  for (int run = 0; run < count; ++run) found.push_back(runs.shares.size(run));  // of the part behind the last
  return found;
}

/// Merges two segments of `from` to `to`, of equal keys those of the first before those of the second.
void merge(Group& group, int g, const char* label, const Pairs& from, const Segment& a, const Segment& b,
           const Pairs& to, const Less& less, cudaStream_t stream) {
  const Pairs first = from.from(a.begin);
  const Pairs second = from.from(b.begin);
  run_cub(group, g, label, [&](void* scratch, std::size_t& bytes) {
    if (from.values == nullptr)
      return cub::DeviceMerge::MergeKeys(scratch, bytes, first.keys, a.size(), second.keys, b.size(), to.keys, less,
                                         stream);
    return cub::DeviceMerge::MergePairs(scratch, bytes, first.keys, first.values, a.size(), second.keys, second.values,
                                        b.size(), to.keys, to.values, less, stream);
  });
}

/// Merges neighbours of a GPU's segments, two and two, to `to` from place `at` on. @returns what is left to merge
std::vector<Segment> merge_neighbours(Group& group, int g, const char* label, const Pairs& from,
                                      const std::vector<Segment>& segments, std::int64_t at, const Pairs& to,
                                      const Less& less, cudaStream_t stream) {
  std::vector<Segment> merged;
  for (std::size_t i = 0; i < segments.size(); i += 2) {
    const Segment a = segments[i];
    const Segment b = i + 1 < segments.size() ? segments[i + 1] : Segment{a.end, a.end};
    const Segment result{at, at + a.size() + b.size()};
    if (result.size() > 0) merge(group, g, label, from, a, b, to.from(at), less, stream);
    merged.push_back(result);
    at = result.end;
  }
  return merged;
}

}  // namespace

void sort(Cuda& ex, const char* label, Buffer<std::uint64_t>& keys, Buffer<std::int32_t>* values, int first_bit,
          int end_bit) {
  throw_if_cancelled();
  Group& group = *ex.group();
  const Shares shares{keys.size(), group.count()};
  Buffer<std::uint64_t> other_keys(ex.pool(), keys.size());
  Buffer<std::int32_t> other_values(ex.pool(), values == nullptr ? 0 : keys.size());
  Pairs from{keys.data(), values == nullptr ? nullptr : values->data()};
  Pairs to{other_keys.data(), values == nullptr ? nullptr : other_values.data()};
  const KeyBits bits{first_bit, end_bit};
  bool in_other = sort_shares(group, label, shares, from, to, bits);
  if (in_other) std::swap(from, to);

  const std::vector<std::int64_t> cuts = find_cuts(ex, {from.keys, shares, bits});
  const auto count = static_cast<std::size_t>(group.count());
  std::vector<std::vector<Segment>> left(count);  // what each GPU has to merge
  for (std::size_t part = 0; part < count; ++part)
    for (std::size_t run = 0; run < count; ++run) {
      const std::int64_t begin = shares.begin(static_cast<int>(run));
      left[part].push_back({begin + cuts[part * count + run], begin + cuts[(part + 1) * count + run]});
    }
  while (left.front().size() > 1) {
    group.spread([&](int g, void* stream) {
      std::vector<Segment>& own = left[static_cast<std::size_t>(g)];
      own =
          merge_neighbours(group, g, label, from, own, shares.begin(g), to, {bits}, static_cast<cudaStream_t>(stream));
    });
    std::swap(from, to);
    in_other = !in_other;
  }
  if (!in_other) return;
  keys.swap(other_keys);
  if (values != nullptr) values->swap(other_values);
}

}  // namespace pointskin::exec::gpus
