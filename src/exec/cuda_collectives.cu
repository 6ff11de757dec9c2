// What the primitives on the GPU leave to CUB: compiled here alone, because its headers are large.
#include <concepts>
#include <cstdint>
#include <functional>

#include <cub/device/device_radix_sort.cuh>
#include <cub/device/device_scan.cuh>
#include <cub/device/device_select.cuh>

#include "exec/counting_iterator.cuh"
#include "exec/cuda_primitives.cuh"
#include "exec/gpus/collectives.cuh"

namespace pointskin::exec {
namespace {

/// Runs a CUB algorithm: once to learn its scratch size, once for real.
template <class Algorithm>
void run_cub(Cuda& ex, const char* label, const Algorithm& algorithm) {
  std::size_t bytes = 0;
  cuda_check(algorithm(nullptr, bytes), label);
  Buffer<std::byte> scratch(ex.pool(), static_cast<std::int64_t>(bytes));
  cuda_check(algorithm(scratch.data(), bytes), label);
}

}  // namespace

Buffer<std::int32_t> select_flagged(Cuda& ex, const char* label, ArrayView<const std::uint8_t> flags,
                                    const std::function<void()>& work) {
  if (flags.empty() || gpus::shares_collective(ex, flags.size)) {
    work();
    return flags.empty() ? Buffer<std::int32_t>{} : gpus::select_flagged(ex, label, flags);
  }
  const std::int64_t n = flags.size;
  Buffer<std::int32_t> found(ex.pool(), n);
  Buffer<std::int32_t> count(ex.pool(), 1);
  run_cub(ex, label, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceSelect::Flagged(scratch, bytes, CountingIterator{}, flags.data, found.data(), count.data(), n,
                                      stream_of(ex));
  });
  std::int32_t kept_count = 0;
  copy_to_host_meanwhile(ex, count.cview(), &kept_count, work);
  Buffer<std::int32_t> kept(ex.pool(), kept_count);
  copy(ex, found.cview().part(0, kept_count), kept.view());
  return kept;
}

template <class T>
void exclusive_scan(Cuda& ex, const char* label, ArrayView<const T> in, ArrayView<T> out) {
  if constexpr (std::integral<T>)  // sums of others would depend on the number of GPUs
    if (gpus::shares_collective(ex, in.size)) return gpus::exclusive_scan(ex, label, in, out);
  if (out.size > in.size) {
    // The scan of n + 1 elements never adds the last one, but it reads it: scan inclusively, one place further.
    cuda_check(cudaMemsetAsync(out.data, 0, sizeof(T), stream_of(ex)), label);
    if (in.size == 0) return;
    run_cub(ex, label, [&](void* scratch, std::size_t& bytes) {
      return cub::DeviceScan::InclusiveSum(scratch, bytes, in.data, out.data + 1, in.size, stream_of(ex));
    });
    return;
  }
  if (in.size == 0) return;
  run_cub(ex, label, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceScan::ExclusiveSum(scratch, bytes, in.data, out.data, in.size, stream_of(ex));
  });
}

template <class Value>
void sort_pairs(Cuda& ex, const char* label, Buffer<std::uint64_t>& keys, Buffer<Value>& values, int bits,
                int first_bit) {
  if (keys.empty()) return;
  if (gpus::shares_collective(ex, keys.size())) return gpus::sort(ex, label, keys, &values, first_bit, bits);
  Buffer<std::uint64_t> other_keys(ex.pool(), keys.size());
  Buffer<Value> other_values(ex.pool(), values.size());
  cub::DoubleBuffer<std::uint64_t> key_buffers(keys.data(), other_keys.data());
  cub::DoubleBuffer<Value> value_buffers(values.data(), other_values.data());
  run_cub(ex, label, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortPairs(scratch, bytes, key_buffers, value_buffers, keys.size(), first_bit, bits,
                                           stream_of(ex));
  });
  if (key_buffers.Current() != keys.data()) keys.swap(other_keys);
  if (value_buffers.Current() != values.data()) values.swap(other_values);
}

void sort_keys(Cuda& ex, const char* label, Buffer<std::uint64_t>& keys, int bits) {
  if (keys.empty()) return;
  if (gpus::shares_collective(ex, keys.size())) return gpus::sort(ex, label, keys, nullptr, 0, bits);
  Buffer<std::uint64_t> other(ex.pool(), keys.size());
  cub::DoubleBuffer<std::uint64_t> buffers(keys.data(), other.data());
  run_cub(ex, label, [&](void* scratch, std::size_t& bytes) {
    return cub::DeviceRadixSort::SortKeys(scratch, bytes, buffers, keys.size(), 0, bits, stream_of(ex));
  });
  if (buffers.Current() != keys.data()) keys.swap(other);
}

template void exclusive_scan(Cuda&, const char*, ArrayView<const std::int32_t>, ArrayView<std::int32_t>);
template void exclusive_scan(Cuda&, const char*, ArrayView<const std::int64_t>, ArrayView<std::int64_t>);
template void exclusive_scan(Cuda&, const char*, ArrayView<const std::uint64_t>, ArrayView<std::uint64_t>);
template void exclusive_scan(Cuda&, const char*, ArrayView<const double>, ArrayView<double>);
template void sort_pairs(Cuda&, const char*, Buffer<std::uint64_t>&, Buffer<std::int32_t>&, int, int);

}  // namespace pointskin::exec
