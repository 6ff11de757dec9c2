// The data-parallel primitives on the GPU. See exec/space.hpp for the contract.
#pragma once

#include <cooperative_groups.h>
#include <cuda_runtime.h>

#include <cstdint>
#include <cstring>
#include <functional>

#include "core/array_view.hpp"
#include "exec/cancel.hpp"
#include "exec/cuda.hpp"
#include "exec/cuda_check.cuh"
#include "exec/lanes.hpp"
#include "exec/memory.hpp"
#include "exec/reduce_order.hpp"
#include "exec/sweep.hpp"

namespace pointskin::exec {

inline constexpr int kThreadsPerBlock = 128;
inline constexpr int kWarp = 32;

/// Where the next launch or copy goes that one GPU does. All of them ask for it, so it asks the flag of the thread's CancelScope.
inline cudaStream_t stream_of(const Cuda& ex) {
  throw_if_cancelled();
  ex.join();
  return static_cast<cudaStream_t>(ex.stream());
}

/// Calls launch(stream, first, blocks) for blocks of `threads` threads, for every GPU that takes a share of them: together [0, blocks).
/// A kernel that is launched so counts its blocks from `first`, and no block waits for another.
template <class Launch>
void in_shares(Cuda& ex, const char* label, std::int64_t blocks, int threads, const Launch& launch) {
  gpus::Group* const group = ex.group();
  if (group == nullptr || blocks * threads < group->worth().threads) {
    launch(stream_of(ex), std::int64_t{0}, static_cast<unsigned>(blocks));
    return cuda_check(cudaGetLastError(), label);
  }
  throw_if_cancelled();
  group->spread([&](int g, void* stream) {
    for (const gpus::Layout::Interval& own : group->layout().of_gpu(g, group->count(), blocks)) {
      launch(static_cast<cudaStream_t>(stream), own.begin, static_cast<unsigned>(own.size()));
      cuda_check(cudaGetLastError(), label);
    }
  });
}

/// Number of this block among those of all GPUs.
__device__ inline std::int64_t block_from(std::int64_t first) { return first + blockIdx.x; }

template <class F>
__global__ void __launch_bounds__(kThreadsPerBlock) for_each_kernel(std::int64_t first, std::int64_t n, const F f) {
  const std::int64_t i = block_from(first) * kThreadsPerBlock + threadIdx.x;
  if (i < n) f(i);
}

/// Calls f(i) for every i in [0, n), one thread each. Asynchronous.
template <class F>
void for_each(Cuda& ex, const char* label, std::int64_t n, const F& f) {
  if (n <= 0) return;
  const std::int64_t blocks = (n + kThreadsPerBlock - 1) / kThreadsPerBlock;
  in_shares(ex, label, blocks, kThreadsPerBlock, [&](cudaStream_t stream, std::int64_t first, unsigned share) {
    for_each_kernel<<<share, kThreadsPerBlock, 0, stream>>>(first, n, f);
  });
}

/// Only every `lanes`-th thread has an index.
template <class F>
struct OneOfLanes {
  F f;
  unsigned lanes;  // a power of two
  PSK_HD void operator()(std::int64_t i) const {
    if ((i & (lanes - 1)) == 0) f(i / lanes);
  }
};

/// Threads for each of n indices that take other paths, which wait for each other in a warp: as many as the GPU has room for.
inline int lanes_apart(const Cuda& ex, std::int64_t n) {
  constexpr std::int64_t kRoom = 1024;  // threads a multiprocessor
  int lanes = kWarp;
  while (lanes > 1 && n * lanes > kRoom * ex.multiprocessors()) lanes /= 2;
  return lanes;
}

/// for_each for work that takes another path at every index.
template <class F>
void for_each_apart(Cuda& ex, const char* label, std::int64_t n, const F& f) {
  const auto lanes = static_cast<unsigned>(lanes_apart(ex, n));
  for_each(ex, label, n * lanes, OneOfLanes<F>{f, lanes});
}

template <class F>
__global__ void __launch_bounds__(kWarp) for_each_long_kernel(std::int64_t first, std::int64_t n, const F f) {
  const std::int64_t i = block_from(first) * kWarp + threadIdx.x;
  if (i < n) f(i);
}

/// for_each for few indices that take long: in blocks of one warp, with no more of them in a warp than it takes to give
/// every multiprocessor some.
template <class F>
void for_each_long(Cuda& ex, const char* label, std::int64_t n, const F& f) {
  constexpr std::int64_t kRoom = 4 * kWarp;  // threads a multiprocessor
  if (n <= 0) return;
  unsigned lanes = kWarp;
  while (lanes > 1 && n * lanes > kRoom * ex.multiprocessors()) lanes /= 2;
  const std::int64_t blocks = (n * lanes + kWarp - 1) / kWarp;
  in_shares(ex, label, blocks, kWarp, [&](cudaStream_t stream, std::int64_t first, unsigned share) {
    for_each_long_kernel<<<share, kWarp, 0, stream>>>(first, n * lanes, OneOfLanes<F>{f, lanes});
  });
}

/// `value` of the lane whose number differs in the bits of `mask`.
template <class T>
__device__ T shuffled(const T& value, int mask) {
  static_assert(sizeof(T) % 4 == 0);
  std::uint32_t words[sizeof(T) / 4];
  memcpy(words, &value, sizeof(T));
  for (std::uint32_t& word : words) word = __shfl_xor_sync(~0U, word, mask);
  T other;
  memcpy(&other, words, sizeof(T));
  return other;
}

template <class F>
__global__ void __launch_bounds__(kThreadsPerBlock)
    for_each_by_lanes_kernel(std::int64_t first, std::int64_t n, const F f) {
  const std::int64_t thread = block_from(first) * kThreadsPerBlock + threadIdx.x;
  const std::int64_t i = thread / F::kLanes;
  const int lane = static_cast<int>(thread % F::kLanes);
  typename F::Sum sum{};
  if (i < n) sum = f.part(i, lane);
  for (int step = 1; step < F::kLanes; step *= 2) sum = sum + shuffled(sum, step);
  if (i < n && lane == 0) f.finish(i, sum);
}

/// Calls f.finish(i, sum of its parts) for every i in [0, n), a thread for every part; see exec/lanes.hpp.
/// Asynchronous.
template <class F>
void for_each_by_lanes(Cuda& ex, const char* label, std::int64_t n, const F& f) {
  static_assert((F::kLanes & (F::kLanes - 1)) == 0 && F::kLanes <= kWarp);
  if (n <= 0) return;
  const std::int64_t blocks = (n * F::kLanes + kThreadsPerBlock - 1) / kThreadsPerBlock;
  in_shares(ex, label, blocks, kThreadsPerBlock, [&](cudaStream_t stream, std::int64_t first, unsigned share) {
    for_each_by_lanes_kernel<<<share, kThreadsPerBlock, 0, stream>>>(first, n, f);
  });
}

inline constexpr int kWarpsPerBlock = kThreadsPerBlock / kWarp;

template <class F>
__global__ void __launch_bounds__(kThreadsPerBlock)
    for_each_warp_kernel(std::int64_t first, std::int64_t n, const F f) {
  using Shared = typename F::Shared;
  __shared__ alignas(16) unsigned char memory[sizeof(Shared) * kWarpsPerBlock];
  const int warp = static_cast<int>(threadIdx.x) / kWarp;
  const std::int64_t i = block_from(first) * kWarpsPerBlock + warp;
  if (i < n) f(i, static_cast<int>(threadIdx.x) % kWarp, reinterpret_cast<Shared*>(memory)[warp]);
}

/// Calls f(i, lane, shared) for every i in [0, n) from all 32 lanes of one warp, with an F::Shared of their own in
/// shared memory, not initialised. Asynchronous.
template <class F>
void for_each_warp(Cuda& ex, const char* label, std::int64_t n, const F& f) {
  if (n <= 0) return;
  const std::int64_t blocks = (n + kWarpsPerBlock - 1) / kWarpsPerBlock;
  in_shares(ex, label, blocks, kThreadsPerBlock, [&](cudaStream_t stream, std::int64_t first, unsigned share) {
    for_each_warp_kernel<<<share, kThreadsPerBlock, 0, stream>>>(first, n, f);
  });
}

inline constexpr int kSweepThreads = 512;  // enough for the nodes of a complete level of 32^3 cells

template <class F>
__global__ void __launch_bounds__(kSweepThreads) sweep_kernel(int rounds, int n, const F f) {
  // Indices next to each other lie in different blocks: where a round has few of them, all multiprocessors share them.
  const auto thread = static_cast<int>(threadIdx.x);
  const int i = (thread / kWarp * static_cast<int>(gridDim.x) + static_cast<int>(blockIdx.x)) * kWarp + thread % kWarp;
  const bool takes_part = i < n && f.takes_part(i);
  const auto prepared = f.prepare(takes_part ? i : 0);
  for (int round = 0; round < rounds; ++round) {
    if (round > 0) cooperative_groups::this_grid().sync();
    if (takes_part) f(round, i, prepared);
  }
}

/// The same where rounds have indices of their own. Those that one block has threads for are done by the first block alone: it
/// waits for its own threads in a fraction of the time that all blocks take to wait for each other.
template <HasRoundsOfItsOwn F>
__global__ void __launch_bounds__(kSweepThreads) sweep_rounds_kernel(int rounds, const F f) {
  const auto thread = static_cast<int>(threadIdx.x);
  const auto block = static_cast<int>(blockIdx.x);
  const int spread = (thread / kWarp * static_cast<int>(gridDim.x) + block) * kWarp + thread % kWarp;
  const auto all = static_cast<int>(gridDim.x * blockDim.x);
  bool was_alone = false;
  for (int round = 0; round < rounds; ++round) {
    const int n = f.indices(round);
    const bool is_alone = n <= static_cast<int>(blockDim.x);
    if (round > 0) {
      if (is_alone && was_alone)
        __syncthreads();
      else
        cooperative_groups::this_grid().sync();
    }
    was_alone = is_alone;
    if (is_alone && block > 0) continue;
    const int step = is_alone ? static_cast<int>(blockDim.x) : all;
    for (int i = is_alone ? thread : spread; i < n; i += step)
      if (f.takes_part(i)) f(round, i, f.prepare(i));
  }
}

/// Threads of a block, so that every multiprocessor has at most one.
inline std::int64_t sweep_threads(const Cuda& ex, std::int64_t n) {
  const std::int64_t warps = (n + kWarp - 1) / kWarp;
  return kWarp * ((warps + ex.multiprocessors() - 1) / ex.multiprocessors());
}

/// Threads of a block that does small rounds alone: enough for three complete levels, and few enough that the others are spread.
inline constexpr std::int64_t kFewestAlone = 256;

/// True if a sweep over n items takes one launch.
inline bool is_one_launch(const Cuda& ex, std::int64_t n) {
  return n <= std::int64_t{ex.multiprocessors()} * kSweepThreads;
}

/// Calls f(round, i, f.prepare(i)) for every i in [0, n), or [0, f.indices(round)), with f.takes_part(i) and every round in
/// [0, rounds), rounds one after another. Asynchronous. What fits onto the GPU at one block a multiprocessor takes one cooperative
/// launch, with a barrier between rounds and, unless rounds have indices of their own, one call of prepare, whose result stays in
/// registers.
template <class F>
void sweep(Cuda& ex, const char* label, int rounds, std::int64_t n, const F& f) {
  if (n <= 0 || rounds <= 0) return;
  std::int64_t threads = sweep_threads(ex, n);
  if constexpr (HasRoundsOfItsOwn<F>) threads = threads < kFewestAlone ? kFewestAlone : threads;
  const std::int64_t blocks = (n + threads - 1) / threads;
  if (!is_one_launch(ex, n)) {
    for (int round = 0; round < rounds; ++round)
      for_each(ex, label, indices_of_round(f, round, static_cast<int>(n)), SweepRound<F>{f, round});
    return;
  }
  cudaLaunchAttribute cooperative{};
  cooperative.id = cudaLaunchAttributeCooperative;
  cooperative.val.cooperative = 1;
  cudaLaunchConfig_t config{};
  config.gridDim = {static_cast<unsigned>(blocks), 1, 1};
  config.blockDim = {static_cast<unsigned>(threads), 1, 1};
  config.stream = stream_of(ex);
  config.attrs = &cooperative;
  config.numAttrs = 1;
  if constexpr (HasRoundsOfItsOwn<F>)
    cuda_check(cudaLaunchKernelEx(&config, sweep_rounds_kernel<F>, rounds, f), label);
  else
    cuda_check(cudaLaunchKernelEx(&config, sweep_kernel<F>, rounds, static_cast<int>(n), f), label);
}

inline constexpr int kTailThreads = 128;

/// One block combines up to kReduceTail values as exec::reduce documents: 64 a lane, until one is left.
template <class T, class Combine>
__global__ void __launch_bounds__(kTailThreads)
    reduce_tail_kernel(ArrayView<const T> values, ArrayView<T> out, const Combine combine) {
  static_assert(kReduceTail / kReduceLane <= kTailThreads);
  constexpr bool kFits = sizeof(T) * kReduceTail <= 32768;
  __shared__ alignas(16) unsigned char memory[sizeof(T) * (kFits ? kReduceTail : kTailThreads)];
  T* const sums = reinterpret_cast<T*>(memory);
  const int lane = static_cast<int>(threadIdx.x);
  auto lanes = static_cast<int>(kFits ? values.size : reduce_lanes(values.size));
  if constexpr (kFits) {
    for (int i = lane; i < lanes; i += kTailThreads) sums[i] = values[i];
  } else if (lane < lanes) {
    sums[lane] = combine_lane(LoadValue<T>{values}, combine, values.size, lanes, lane);
  }
  __syncthreads();
  while (lanes > 1) {
    const auto fewer = static_cast<int>(reduce_lanes(lanes));
    T sum;
    if (lane < fewer) sum = combine_lane(LoadValue<T>{{sums, lanes}}, combine, lanes, fewer, lane);
    __syncthreads();
    if (lane < fewer) sums[lane] = sum;
    __syncthreads();
    lanes = fewer;
  }
  if (lane == 0) out[0] = sums[0];
}

/// out[0] = the combination of at most kReduceTail values, in the order of exec::reduce. Asynchronous.
template <class T, class Combine>
void reduce_tail(Cuda& ex, const char* label, ArrayView<const T> values, ArrayView<T> out, const Combine& combine) {
  reduce_tail_kernel<<<1, kTailThreads, 0, stream_of(ex)>>>(values, out, combine);
  cuda_check(cudaGetLastError(), label);
}

inline constexpr int kReducePerThread = 8;

/// A block combines kThreadsPerBlock * kReducePerThread values.
template <class T, class F, class Combine>
__global__ void __launch_bounds__(kThreadsPerBlock)
    reduce_blocks_kernel(std::int64_t first_block, std::int64_t n, const F f, const Combine combine, ArrayView<T> out) {
  __shared__ alignas(16) unsigned char memory[sizeof(T) * kThreadsPerBlock];
  T* const sums = reinterpret_cast<T*>(memory);
  const int thread = static_cast<int>(threadIdx.x);
  const std::int64_t first = block_from(first_block) * (kThreadsPerBlock * kReducePerThread) + thread;
  if (first < n) {
    T values[kReducePerThread];  // all are fetched before any is used
    PSK_UNROLL
    for (int k = 0; k < kReducePerThread; ++k) {
      const std::int64_t i = first + k * kThreadsPerBlock;
      values[k] = f(i < n ? i : n - 1);
    }
    PSK_UNROLL
    for (int k = 1; k < kReducePerThread; ++k)
      if (first + k * kThreadsPerBlock < n) values[0] = combine(values[0], values[k]);
    sums[thread] = values[0];
  }
  const auto left = static_cast<int>(n - (first - thread) < kThreadsPerBlock ? n - (first - thread) : kThreadsPerBlock);
  for (int step = kThreadsPerBlock / 2; step > 0; step /= 2) {
    __syncthreads();
    if (thread < step && thread + step < left) sums[thread] = combine(sums[thread], sums[thread + step]);
  }
  if (thread == 0) out[block_from(first_block)] = sums[0];
}

/// The combination of f(0), ..., f(n-1), n > 0, in any order. Asynchronous; one or two launches up to a million values.
template <class T, class F, AnyOrder Combine>
Buffer<T> reduce_any_order(Cuda& ex, const char* label, std::int64_t n, const F& f, const Combine& combine) {
  constexpr std::int64_t kPerBlock = std::int64_t{kThreadsPerBlock} * kReducePerThread;
  const std::int64_t blocks = (n + kPerBlock - 1) / kPerBlock;
  Buffer<T> sums = make_buffer<T>(ex, blocks);
  in_shares(ex, label, blocks, kThreadsPerBlock, [&](cudaStream_t stream, std::int64_t first, unsigned share) {
    reduce_blocks_kernel<T><<<share, kThreadsPerBlock, 0, stream>>>(first, n, f, combine, sums.view());
  });
  if (blocks == 1) return sums;
  return reduce_any_order<T>(ex, label, blocks, LoadValue<T>{sums.cview()}, combine);
}

/// By all GPUs of a group, each its share: one alone reads and writes the memory of others slower than they do.
inline void copy_bytes(Cuda& ex, const void* from, void* to, std::size_t bytes) {
  const auto copy_part = [&](cudaStream_t stream, std::size_t begin, std::size_t end) {
    cuda_check(cudaMemcpyAsync(static_cast<char*>(to) + begin, static_cast<const char*>(from) + begin, end - begin,
                               cudaMemcpyDeviceToDevice, stream),
               "copying on the GPU");
  };
  gpus::Group* const group = ex.group();
  if (group == nullptr || bytes < group->worth().bytes) return copy_part(stream_of(ex), 0, bytes);
  throw_if_cancelled();
  group->spread([&](int g, void* stream) {
    for (const gpus::Layout::Interval& own :
         group->layout().of_gpu(g, group->count(), static_cast<std::int64_t>(bytes)))
      copy_part(static_cast<cudaStream_t>(stream), static_cast<std::size_t>(own.begin),
                static_cast<std::size_t>(own.end));
  });
}

template <class T>
void copy(Cuda& ex, ArrayView<const T> from, ArrayView<T> to) {
  if (from.size > 0) copy_bytes(ex, from.data, to.data, static_cast<std::size_t>(from.size) * sizeof(T));
}

/// One warp. The ticket is written last.
template <class T>
__global__ void copy_kernel(const T* from, T* to, int n, volatile std::uint32_t* arrived, std::uint32_t ticket) {
  for (int i = static_cast<int>(threadIdx.x); i < n; i += kWarp) to[i] = from[i];
  __threadfence_system();
  __syncwarp();
  if (threadIdx.x == 0) *arrived = ticket;
}

/// Lets a kernel write a little into page-locked memory: the copy engine would take longer to start. Returns what to wait for.
template <class T>
std::uint32_t send_to_host(Cuda& ex, ArrayView<const T> from, void* staging) {
  const std::uint32_t ticket = ex.next_ticket();
  copy_kernel<<<1, kWarp, 0, stream_of(ex)>>>(from.data, static_cast<T*>(staging), static_cast<int>(from.size),
                                              ex.arrived(), ticket);
  cuda_check(cudaGetLastError(), "copying to the host");
  return ticket;
}

/// Waits until the data is there.
template <class T>
void copy_to_host(Cuda& ex, ArrayView<const T> from, T* to) {
  if (from.size == 0) return;
  const std::size_t bytes = static_cast<std::size_t>(from.size) * sizeof(T);
  if (bytes >= Cuda::kManyBytes) return ex.fetch(from.data, to, bytes);
  if (bytes <= static_cast<std::size_t>(Cuda::kStagingBytes)) {
    ex.wait_for(send_to_host(ex, from, ex.staging()));
    std::memcpy(to, ex.staging(), bytes);
    return;
  }
  cuda_check(cudaMemcpyAsync(to, from.data, bytes, cudaMemcpyDeviceToHost, stream_of(ex)), "copying to the host");
  ex.synchronize();
}

/// The same for few bytes while work() launches what need not wait for them. Work may read from the GPU as well, but not so.
template <class T, class Work>
void copy_to_host_meanwhile(Cuda& ex, ArrayView<const T> from, T* to, const Work& work) {
  const std::size_t bytes = static_cast<std::size_t>(from.size) * sizeof(T);
  if (bytes == 0 || bytes > static_cast<std::size_t>(Cuda::kStagingBytes)) {
    copy_to_host(ex, from, to);
    return work();
  }
  const std::uint32_t ticket = send_to_host(ex, from, ex.late_staging());
  work();
  ex.wait_for(ticket);
  std::memcpy(to, ex.late_staging(), bytes);
}

/// Returns when `from` may be reused.
template <class T>
void copy_to_device(Cuda& ex, const T* from, ArrayView<T> to) {
  if (to.size == 0) return;
  const std::size_t bytes = static_cast<std::size_t>(to.size) * sizeof(T);
  if (bytes >= Cuda::kManyBytes) return ex.send(from, to.data, bytes);
  cuda_check(cudaMemcpyAsync(to.data, from, bytes, cudaMemcpyHostToDevice, stream_of(ex)), "copying to the GPU");
  ex.synchronize();
}

/// Copies what never changes while the program runs. Asynchronous.
template <class T>
void copy_constant_to_device(Cuda& ex, const T* from, ArrayView<T> to) {
  cuda_check(cudaMemcpyAsync(to.data, from, static_cast<std::size_t>(to.size) * sizeof(T), cudaMemcpyHostToDevice,
                             stream_of(ex)),
             "copying to the GPU");
}

template <class Keep>
struct FlagKept {
  Keep keep;
  std::uint8_t* flags;
  PSK_HD void operator()(std::int64_t i) const { flags[i] = keep(i) ? 1 : 0; }
};

// What CUB does, compiled once (exec/cuda_collectives.cu).

/// The indices i in [0, n) with flags[i] != 0, ascending. Waits for the count, while work() launches what need not wait.
Buffer<std::int32_t> select_flagged(Cuda& ex, const char* label, ArrayView<const std::uint8_t> flags,
                                    const std::function<void()>& work);

/// The indices i in [0, n) with keep(i), ascending. Waits for the count. keep runs in a kernel of its own: CUB calls it
/// for many indices on few threads, one after another.
template <class Keep, class Work>
Buffer<std::int32_t> select_meanwhile(Cuda& ex, const char* label, std::int64_t n, const Keep& keep, const Work& work) {
  Buffer<std::uint8_t> flags(ex.pool(), n);
  for_each(ex, label, n, FlagKept<Keep>{keep, flags.data()});
  return select_flagged(ex, label, flags.cview(), work);
}
template <class Keep>
Buffer<std::int32_t> select(Cuda& ex, const char* label, std::int64_t n, const Keep& keep) {
  if (n == 0) return {};
  return select_meanwhile(ex, label, n, keep, [] {});
}

/// out[i] = in[0] + ... + in[i-1]; out.size is in.size (in place allowed) or in.size + 1 (the last is the total).
/// For int32, int64, uint64 and double.
template <class T>
void exclusive_scan(Cuda& ex, const char* label, ArrayView<const T> in, ArrayView<T> out);

/// Stable ascending radix sort of (key, value) pairs by bits [first_bit, bits) of the keys. For values of int32.
template <class Value>
void sort_pairs(Cuda& ex, const char* label, Buffer<std::uint64_t>& keys, Buffer<Value>& values, int bits,
                int first_bit = 0);

/// Sorts keys alone, by their lowest `bits` bits.
void sort_keys(Cuda& ex, const char* label, Buffer<std::uint64_t>& keys, int bits);

}  // namespace pointskin::exec
