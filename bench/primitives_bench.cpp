// Bandwidth of the data-parallel primitives on the CPU. Bytes are those that the algorithm must move, per element:
//   for_each        4 read + 4 written, for the functor used here
//   select          4 read + 4 written per kept index
//   exclusive_scan  4 read twice + 4 written
//   sort_pairs      per pass of 8 bits: 8 (count) + 12 read + 12 written
#include <benchmark/benchmark.h>

#include <cstdint>

#include "core/array_view.hpp"
#include "exec/cpu.hpp"
#include "exec/cpu_primitives.hpp"

namespace pointskin::exec {
namespace {

/// Scrambles an index (the finaliser of SplitMix64), so that keys are distinct and in no order.
std::uint64_t scrambled(std::int64_t i) {
  auto z = static_cast<std::uint64_t>(i) + 0x9e3779b97f4a7c15U;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9U;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebU;
  return z ^ (z >> 31);
}

struct ScaleAndShift {
  ArrayView<const float> in;
  ArrayView<float> out;
  void operator()(std::int64_t i) const { out[i] = 2 * in[i] + 1; }
};

struct FillScrambled {
  ArrayView<std::int32_t> out;
  void operator()(std::int64_t i) const { out[i] = static_cast<std::int32_t>(scrambled(i) & 0xff); }
};

struct FillPairs {
  ArrayView<std::uint64_t> keys;
  ArrayView<std::int32_t> values;
  void operator()(std::int64_t i) const {
    keys[i] = scrambled(i);
    values[i] = static_cast<std::int32_t>(i);
  }
};

struct IsBelow {
  ArrayView<const std::int32_t> in;
  std::int32_t limit;
  bool operator()(std::int64_t i) const { return in[i] < limit; }
};

Buffer<std::int32_t> scrambled_bytes(Cpu& ex, std::int64_t n) {
  Buffer<std::int32_t> values(ex.pool(), n);
  for_each(ex, "fill", n, FillScrambled{values.view()});
  return values;
}

void bench_for_each(benchmark::State& state) {
  Cpu ex;
  const std::int64_t n = state.range(0);
  Buffer<float> in(ex.pool(), n), out(ex.pool(), n);
  for_each(ex, "fill", n, [view = in.view()](std::int64_t i) { view[i] = static_cast<float>(i); });
  for (auto _ : state) {
    for_each(ex, "for_each", n, ScaleAndShift{in.cview(), out.view()});
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * n * 8);
}

void bench_select(benchmark::State& state) {
  Cpu ex;
  const std::int64_t n = state.range(0);
  const Buffer<std::int32_t> in = scrambled_bytes(ex, n);
  std::int64_t kept = 0;
  for (auto _ : state) kept = select(ex, "select", n, IsBelow{in.cview(), 64}).size();  // keeps a quarter
  state.SetBytesProcessed(state.iterations() * (n * 4 + kept * 4));
}

void bench_exclusive_scan(benchmark::State& state) {
  Cpu ex;
  const std::int64_t n = state.range(0);
  const Buffer<std::int32_t> in = scrambled_bytes(ex, n);
  Buffer<std::int32_t> out(ex.pool(), n + 1);
  for (auto _ : state) {
    exclusive_scan<std::int32_t>(ex, "exclusive_scan", in.cview(), out.view());
    benchmark::ClobberMemory();
  }
  state.SetBytesProcessed(state.iterations() * n * 12);
}

void bench_sort_pairs(benchmark::State& state) {
  Cpu ex;
  const std::int64_t n = state.range(0);
  const int bits = static_cast<int>(state.range(1));
  Buffer<std::uint64_t> keys(ex.pool(), n);
  Buffer<std::int32_t> values(ex.pool(), n);
  for (auto _ : state) {
    state.PauseTiming();
    for_each(ex, "fill", n, FillPairs{keys.view(), values.view()});
    state.ResumeTiming();
    sort_pairs(ex, "sort_pairs", keys, values, bits);
  }
  state.SetBytesProcessed(state.iterations() * n * 32 * ((bits + 7) / 8));
}

BENCHMARK(bench_for_each)->Arg(1 << 20)->Arg(1 << 24)->UseRealTime();
BENCHMARK(bench_select)->Arg(1 << 20)->Arg(1 << 24)->UseRealTime();
BENCHMARK(bench_exclusive_scan)->Arg(1 << 20)->Arg(1 << 24)->UseRealTime();
// 24, 30 and 60 bits are the keys of depths 8, 10 and 20.
BENCHMARK(bench_sort_pairs)->ArgsProduct({{1 << 20, 1 << 23}, {24, 30, 60}})->UseRealTime();

}  // namespace
}  // namespace pointskin::exec
