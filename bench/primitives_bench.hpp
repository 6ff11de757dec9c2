// Bandwidth of the data-parallel primitives. Bytes are those that the algorithm must move, per element:
//   for_each        4 read + 4 written, for the functor used here
//   gather          4 index + 4 read + 4 written
//   reduce          4 read
//   select          4 read twice + 4 written per kept index
//   exclusive_scan  4 read twice + 4 written
//   sort_pairs      per pass of 8 bits: 8 (count) + 12 read + 12 written
//   sort_keys       per pass of 8 bits: 8 (count) + 8 read + 8 written
//   sort_unique     sort_keys, 8 read to find the runs, and 4 + 8 read + 8 written per run
//   copy            4 read + 4 written, inside of the space
#pragma once

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/algorithms.hpp"
#include "on_spaces.hpp"

namespace pointskin::bench {

/// Scrambles an index (the finaliser of SplitMix64), so that keys are distinct and in no order.
PSK_HD inline std::uint64_t scrambled(std::int64_t i) {
  auto z = static_cast<std::uint64_t>(i) + 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

struct ScaleAndShift {
  ArrayView<const float> in;
  ArrayView<float> out;
  PSK_HD void operator()(std::int64_t i) const { out[i] = 2 * in[i] + 1; }
};

struct FillScrambled {
  ArrayView<std::int32_t> out;
  std::int64_t below;
  PSK_HD void operator()(std::int64_t i) const {
    out[i] = static_cast<std::int32_t>(scrambled(i) % static_cast<std::uint64_t>(below));
  }
};

struct FillKeys {
  ArrayView<std::uint64_t> keys;
  PSK_HD void operator()(std::int64_t i) const { keys[i] = scrambled(i); }
};

struct IsBelow {
  ArrayView<const std::int32_t> in;
  std::int32_t limit;
  PSK_HD bool operator()(std::int64_t i) const { return in[i] < limit; }
};

/// Whole numbers in [0, below), in no order.
template <exec::Space Exec>
exec::Buffer<std::int32_t> scrambled_numbers(Exec& ex, std::int64_t n, std::int64_t below) {
  auto values = exec::make_buffer<std::int32_t>(ex, n);
  for_each(ex, "fill", n, FillScrambled{values.view(), below});
  return values;
}

template <exec::Space Exec>
void bench_for_each(Exec& ex, benchmark::State& state) {
  const std::int64_t n = state.range(0);
  auto in = exec::make_buffer<float>(ex, n), out = exec::make_buffer<float>(ex, n);
  exec::fill(ex, in.view(), 1.0F);
  time_on(ex, state, [&] { for_each(ex, "for_each", n, ScaleAndShift{in.cview(), out.view()}); });
  state.SetBytesProcessed(state.iterations() * n * 8);
}

template <exec::Space Exec>
void bench_gather(Exec& ex, benchmark::State& state) {
  const std::int64_t n = state.range(0);
  const auto index = scrambled_numbers(ex, n, n);
  auto in = exec::make_buffer<float>(ex, n), out = exec::make_buffer<float>(ex, n);
  exec::fill(ex, in.view(), 1.0F);
  time_on(ex, state, [&] { exec::gather(ex, in.cview(), index.cview(), out.view()); });
  state.SetBytesProcessed(state.iterations() * n * 12);
}

template <exec::Space Exec>
void bench_reduce(Exec& ex, benchmark::State& state) {
  const std::int64_t n = state.range(0);
  const auto in = scrambled_numbers(ex, n, 256);
  time_on(ex, state, [&] { benchmark::DoNotOptimize(exec::sum_counts(ex, "reduce", in.cview())); });
  state.SetBytesProcessed(state.iterations() * n * 4);
}

template <exec::Space Exec>
void bench_select(Exec& ex, benchmark::State& state) {
  const std::int64_t n = state.range(0);
  const auto in = scrambled_numbers(ex, n, 256);
  std::int64_t kept = 0;
  time_on(ex, state, [&] { kept = select(ex, "select", n, IsBelow{in.cview(), 64}).size(); });  // keeps a quarter
  state.SetBytesProcessed(state.iterations() * (n * 8 + kept * 4));
}

template <exec::Space Exec>
void bench_exclusive_scan(Exec& ex, benchmark::State& state) {
  const std::int64_t n = state.range(0);
  const auto in = scrambled_numbers(ex, n, 64);
  auto out = exec::make_buffer<std::int32_t>(ex, n + 1);
  time_on(ex, state, [&] { exclusive_scan<std::int32_t>(ex, "exclusive_scan", in.cview(), out.view()); });
  state.SetBytesProcessed(state.iterations() * n * 12);
}

template <exec::Space Exec>
void bench_copy(Exec& ex, benchmark::State& state) {
  const std::int64_t n = state.range(0);
  const auto in = scrambled_numbers(ex, n, 256);
  auto out = exec::make_buffer<std::int32_t>(ex, n);
  time_on(ex, state, [&] { copy(ex, in.cview(), out.view()); });
  state.SetBytesProcessed(state.iterations() * n * 8);
}

/// Sorts keys that are put back into disorder before every round, outside of the time. `sort` takes the keys.
template <exec::Space Exec, class Sort>
void time_sort(Exec& ex, benchmark::State& state, const Sort& sort) {
  const std::int64_t n = state.range(0);
  for (auto _ : state) {
    state.PauseTiming();
    auto keys = exec::make_buffer<std::uint64_t>(ex, n);
    for_each(ex, "fill", n, FillKeys{keys.view()});
    ex.synchronize();
    state.ResumeTiming();
    sort(keys);
    ex.synchronize();
  }
}

template <exec::Space Exec>
void bench_sort_pairs(Exec& ex, benchmark::State& state) {
  const int bits = static_cast<int>(state.range(1));
  auto values = exec::iota(ex, state.range(0));
  time_sort(ex, state, [&](auto& keys) { sort_pairs(ex, "sort_pairs", keys, values, bits); });
  state.SetBytesProcessed(state.iterations() * state.range(0) * 32 * ((bits + 7) / 8));
}

template <exec::Space Exec>
void bench_sort_keys(Exec& ex, benchmark::State& state) {
  const int bits = static_cast<int>(state.range(1));
  time_sort(ex, state, [&](auto& keys) { sort_keys(ex, "sort_keys", keys, bits); });
  state.SetBytesProcessed(state.iterations() * state.range(0) * 24 * ((bits + 7) / 8));
}

template <exec::Space Exec>
void bench_sort_unique(Exec& ex, benchmark::State& state) {
  const int bits = static_cast<int>(state.range(1));
  std::int64_t runs = 0;
  time_sort(ex, state, [&](auto& keys) { runs = exec::sort_unique(ex, "sort_unique", std::move(keys), bits).size(); });
  state.SetBytesProcessed(state.iterations() * (state.range(0) * (24 * ((bits + 7) / 8) + 8) + runs * 20));
}

/// Registers all primitives for a space.
template <exec::Space Exec>
bool add_primitives() {
  using benchmark::internal::Benchmark;
  const auto sizes = [](Benchmark* added) { added->Arg(1 << 20)->Arg(1 << 24); };
  // 24, 30 and 60 bits are the keys of depths 8, 10 and 20.
  const auto sizes_and_bits = [](Benchmark* added) { added->ArgsProduct({{1 << 20, 1 << 23}, {24, 30, 60}}); };
  add_benchmark<Exec>("for_each", bench_for_each<Exec>, sizes);
  add_benchmark<Exec>("gather", bench_gather<Exec>, sizes);
  add_benchmark<Exec>("reduce", bench_reduce<Exec>, sizes);
  add_benchmark<Exec>("select", bench_select<Exec>, sizes);
  add_benchmark<Exec>("exclusive_scan", bench_exclusive_scan<Exec>, sizes);
  add_benchmark<Exec>("copy", bench_copy<Exec>, sizes);
  add_benchmark<Exec>("sort_pairs", bench_sort_pairs<Exec>, sizes_and_bits);
  add_benchmark<Exec>("sort_keys", bench_sort_keys<Exec>, sizes_and_bits);
  add_benchmark<Exec>("sort_unique", bench_sort_unique<Exec>, sizes_and_bits);
  return true;
}

}  // namespace pointskin::bench
